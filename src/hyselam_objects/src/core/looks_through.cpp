#include "looks_through.hpp"

#include <algorithm>
#include <cmath>

namespace hyselam_objects {

bool looksThrough(const OrganisedCloud& cloud, const PinholeCamera& camera, const ObjectPose& pose,
                  const MapperParams& params) {
  constexpr double kInner = 0.35;  // of the size: corners of a box around a turned thing are empty
  constexpr int kRays = 24, kLeast = 20;
  constexpr double kFree = 0.8, kInFrame = 0.6, kNearest = 0.5, kFarthest = 3.8;
  const Eigen::Vector3d middle(pose.position.x, pose.position.y, pose.position.z);
  const Eigen::Vector3d half(kInner * pose.size[0], kInner * pose.size[1], kInner * pose.size[2]);
  const Eigen::Isometry3d map_in_camera = camera.in_map.inverse();
  double low_u = 1e9, high_u = -1e9, low_v = 1e9, high_v = -1e9;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d sign((corner & 1) != 0 ? 1.0 : -1.0, (corner & 2) != 0 ? 1.0 : -1.0,
                               (corner & 4) != 0 ? 1.0 : -1.0);
    const Eigen::Vector3d p = map_in_camera * (middle + half.cwiseProduct(sign)).eval();
    if (p.z() < kNearest || p.z() > kFarthest) return false;
    const double u = camera.focal_length * p.x() / p.z() + camera.cx;
    const double v = camera.focal_length * p.y() / p.z() + camera.cy;
    low_u = std::min(low_u, u), high_u = std::max(high_u, u);
    low_v = std::min(low_v, v), high_v = std::max(high_v, v);
  }
  const double mx = params.visible_margin * cloud.width, my = params.visible_margin * cloud.height;
  const Eigen::Vector3d eye = camera.in_map.translation() - middle;
  int rays = 0, in_frame = 0, through = 0;
  for (int row = 0; row < kRays; ++row) {
    for (int column = 0; column < kRays; ++column) {
      const double u = low_u + (column + 0.5) / kRays * (high_u - low_u);
      const double v = low_v + (row + 0.5) / kRays * (high_v - low_v);
      const Eigen::Vector3d way =
          camera.in_map.linear() * Eigen::Vector3d((u - camera.cx) / camera.focal_length,
                                                   (v - camera.cy) / camera.focal_length, 1.0);
      double enter = 0.0, leave = 1e9;  // depths
      for (int k = 0; k < 3; ++k) {
        const double step = std::abs(way[k]) > 1e-9 ? way[k] : 1e-9;
        const double one = (-half[k] - eye[k]) / step, two = (half[k] - eye[k]) / step;
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
      through += measured.allFinite() && measured.z() > leave + params.depth_margin;
    }
  }
  return rays >= kLeast && in_frame > kInFrame * rays && through > kFree * in_frame;
}

}  // namespace hyselam_objects
