#include "free_space_evidence.hpp"

#include <algorithm>
#include <cmath>

namespace hyselam_objects {

PlaceEvidence evidenceOf(const OrganizedCloud& cloud, const PinholeCamera& camera,
                         const ObjectPose& pose, const MapperParams& params) {
  // Half of the inner part over the size: corners of a box around a turned object are empty.
  constexpr double kInner = 0.35;
  constexpr int kRays = 24, kMinRays = 20;             // per axis; that hit the inner part
  constexpr double kMinFree = 0.8, kMinInFrame = 0.6;  // shares of those rays
  constexpr double kMinDepth = 0.5, kMaxDepth = 3.8;   // of the object [m]
  constexpr double kMinOnIt = 0.8, kMaxDepthToSee = 3.0;
  const Eigen::Vector3d center(pose.position.x, pose.position.y, pose.position.z);
  const Eigen::Vector3d half(kInner * pose.size[0], kInner * pose.size[1], kInner * pose.size[2]);
  const Eigen::Matrix3d box_in_map =
      Eigen::AngleAxisd(pose.yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const Eigen::Isometry3d map_in_camera = camera.in_map.inverse();
  double low_u = 1e9, high_u = -1e9, low_v = 1e9, high_v = -1e9;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d sign((corner & 1) != 0 ? 1.0 : -1.0, (corner & 2) != 0 ? 1.0 : -1.0,
                               (corner & 4) != 0 ? 1.0 : -1.0);
    const Eigen::Vector3d p =
        map_in_camera * (center + box_in_map * half.cwiseProduct(sign)).eval();
    if (p.z() < kMinDepth || p.z() > kMaxDepth) return PlaceEvidence::kNone;
    const double u = camera.focal_length * p.x() / p.z() + camera.cx;
    const double v = camera.focal_length * p.y() / p.z() + camera.cy;
    low_u = std::min(low_u, u), high_u = std::max(high_u, u);
    low_v = std::min(low_v, v), high_v = std::max(high_v, v);
  }
  const double mx = params.image_border_margin * cloud.width,
               my = params.image_border_margin * cloud.height;
  const Eigen::Matrix3d camera_in_box = box_in_map.transpose() * camera.in_map.linear();
  const Eigen::Vector3d eye = box_in_map.transpose() * (camera.in_map.translation() - center);
  int rays = 0, in_frame = 0, through = 0, on_it = 0;
  for (int row = 0; row < kRays; ++row) {
    for (int column = 0; column < kRays; ++column) {
      const double u = low_u + (column + 0.5) / kRays * (high_u - low_u);
      const double v = low_v + (row + 0.5) / kRays * (high_v - low_v);
      const Eigen::Vector3d direction =
          camera_in_box * Eigen::Vector3d((u - camera.cx) / camera.focal_length,
                                          (v - camera.cy) / camera.focal_length, 1.0);
      double enter = 0.0, leave = 1e9;  // depths
      for (int k = 0; k < 3; ++k) {
        const double rate = std::abs(direction[k]) > 1e-9 ? direction[k] : 1e-9;
        const double one = (-half[k] - eye[k]) / rate, two = (half[k] - eye[k]) / rate;
        enter = std::max(enter, std::min(one, two));
        leave = std::min(leave, std::max(one, two));
      }
      if (enter >= leave) continue;
      ++rays;
      if (u < mx || v < my || u >= cloud.width - mx || v >= cloud.height - my) continue;
      ++in_frame;
      const Point& measured =
          cloud.points[static_cast<std::size_t>(v) * static_cast<std::size_t>(cloud.width) +
                       static_cast<std::size_t>(u)];
      if (!measured.allFinite()) continue;
      // The box ends outside of the part that is looked at.
      const double outside = (leave - enter) * (0.5 / kInner - 1.0) + params.depth_margin;
      through += measured.z() > leave + params.depth_margin;
      on_it += measured.z() > enter - outside && measured.z() < leave + outside;
    }
  }
  if (rays < kMinRays || in_frame <= kMinInFrame * rays) return PlaceEvidence::kNone;
  if (through > kMinFree * in_frame) return PlaceEvidence::kFree;
  const bool near = (map_in_camera * center).z() < kMaxDepthToSee;
  return near && on_it > kMinOnIt * in_frame ? PlaceEvidence::kOverlooked : PlaceEvidence::kNone;
}

}  // namespace hyselam_objects
