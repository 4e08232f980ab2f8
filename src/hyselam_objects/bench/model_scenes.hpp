// Real scenes into which a model is put where it was not: it stands on the table, hidden by what is
// nearer.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <optional>

#include "hyselam_common/rng.hpp"
#include "hyselam_objects/segmentation/segment_cloud.hpp"

namespace hyselam_objects {

struct ModelScene {
  OrganizedCloud cloud;
  Eigen::Isometry3d model_in_scene = Eigen::Isometry3d::Identity();
  double visible = 0.0;  ///< share of the model's pixels that nothing hides
};

/// `model`: points of one view, of which `model_up` is up. `scene`: organized, 640x480, of a Kinect
/// (focal length 525). Nothing if no place was found in 200 tries.
inline std::optional<ModelScene> putIntoScene(const OrganizedCloud& model,
                                              const Eigen::Vector3f& model_up,
                                              const OrganizedCloud& scene, hyselam::Rng& rng) {
  constexpr float kFocal = 525.0f, kLeastVisible = 0.4f;
  const CloudSegmentation table = segmentCloud(scene);
  if (!table.support || scene.width != 640 || scene.height != 480) return std::nullopt;
  const Eigen::Vector3f up = table.support->normal;
  // A camera that looks along -z has y up: half a turn about x.
  const Eigen::Quaternionf half(Eigen::AngleAxisf(3.14159265f, Eigen::Vector3f::UnitX()));
  Point middle = Point::Zero();
  for (const Point& p : model.points) middle += p / static_cast<float>(model.points.size());
  for (int attempt = 0; attempt < 200; ++attempt) {
    const auto at = rng.below(static_cast<std::uint32_t>(scene.size()));
    if (table.labels[at] != 1 || std::abs(table.support->heightOf(scene.points[at])) > 0.01f) {
      continue;
    }
    const auto yaw = static_cast<float>(rng.uniform(-0.4, 0.4));
    const Eigen::Quaternionf level = Eigen::Quaternionf::FromTwoVectors(half * model_up, up);
    Eigen::Isometry3f pose = Eigen::Isometry3f::Identity();
    pose.linear() = (Eigen::AngleAxisf(yaw, up) * level * half).toRotationMatrix();
    float lowest = std::numeric_limits<float>::infinity();
    for (const Point& p : model.points) lowest = std::min(lowest, up.dot(pose * (p - middle)));
    pose.translation() = scene.points[at] - lowest * up - pose.linear() * middle;
    ModelScene out;
    out.cloud = scene;
    int visible = 0, all = 0;
    for (const Point& p : model.points) {
      const Point q = pose * p;
      if (!(q.z() > 0.4f)) continue;
      for (const auto& [du, dv] : {std::pair<int, int>{0, 0}, {1, 0}, {0, 1}, {1, 1}}) {
        const int u = static_cast<int>(std::floor(kFocal * q.x() / q.z() + 319.5f)) + du;
        const int v = static_cast<int>(std::floor(kFocal * q.y() / q.z() + 239.5f)) + dv;
        if (u < 0 || v < 0 || u >= 640 || v >= 480) continue;
        const auto i = static_cast<std::size_t>(v) * 640 + static_cast<std::size_t>(u);
        ++all;
        const float there = scene.points[i].z();
        if (there < q.z() - 0.005f) continue;
        ++visible;
        Point& now = out.cloud.points[i];
        if (std::isnan(now.z()) || q.z() < now.z()) {
          now = Point((static_cast<float>(u) - 319.5f) * q.z() / kFocal,
                      (static_cast<float>(v) - 239.5f) * q.z() / kFocal, q.z());
        }
      }
    }
    const auto splats = static_cast<float>(4 * model.points.size());
    if (static_cast<float>(visible) < kLeastVisible * splats) continue;
    out.visible = static_cast<double>(visible) / static_cast<double>(splats);
    out.model_in_scene = pose.cast<double>();
    return out;
  }
  return std::nullopt;
}

}  // namespace hyselam_objects
