#include "hyselam_objects/recognition/demonstrated_object.hpp"

#include <cmath>

#include "hyselam_objects/recognition/object_descriptor.hpp"

namespace hyselam_objects {
namespace {

/// The object nearest to the center of the image; nullptr: nothing is near to it.
const DetectedObject* nearestToCenter(const std::vector<DetectedObject>& detections,
                                      const PinholeCamera& camera) {
  const Eigen::Isometry3d map_in_camera = camera.in_map.inverse();
  const DetectedObject* best = nullptr;
  double nearest = 0.35;  // tangent of the angle from the optical axis
  for (const DetectedObject& each : detections) {
    if (each.furniture || each.partial) continue;
    const Point3 c = each.center();
    const Eigen::Vector3d p = map_in_camera * Eigen::Vector3d(c.x, c.y, c.z);
    const double angle = p.z() > 0.0 ? std::hypot(p.x(), p.y()) / p.z() : 1e9;
    if (angle < nearest) {
      nearest = angle;
      best = &each;
    }
  }
  return best;
}

}  // namespace

void DemonstratedObject::start(const std::string& kind) {
  kind_ = kind;
  views_.clear();
  sizes_.clear();
}

std::optional<GenericObject> DemonstratedObject::addView(
    const std::vector<DetectedObject>& detections, const PinholeCamera& camera) {
  if (kind_.empty()) return std::nullopt;
  const DetectedObject* shown = nearestToCenter(detections, camera);
  if (shown == nullptr) return std::nullopt;
  views_.push_back(shown->descriptor);
  sizes_.push_back(shown->size());
  if (views_.size() < views_to_learn_) return std::nullopt;
  GenericObject learned = learnObject(kind_, views_, sizes_);
  kind_.clear();
  return learned;
}

}  // namespace hyselam_objects
