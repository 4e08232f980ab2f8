#include "hyselam_objects/shown_thing.hpp"

#include <cmath>

#include "hyselam_objects/object_descriptor.hpp"

namespace hyselam_objects {
namespace {

/// What stands nearest to the middle of the picture; nullptr: nothing is near to it.
const DetectedObject* inTheMiddle(const std::vector<DetectedObject>& seen,
                                  const PinholeCamera& camera) {
  const Eigen::Isometry3d map_in_camera = camera.in_map.inverse();
  const DetectedObject* best = nullptr;
  double least = 0.35;  // tangent of the angle from the axis
  for (const DetectedObject& each : seen) {
    if (each.furniture || each.cut) continue;
    const Point3 c = each.center();
    const Eigen::Vector3d p = map_in_camera * Eigen::Vector3d(c.x, c.y, c.z);
    const double off = p.z() > 0.0 ? std::hypot(p.x(), p.y()) / p.z() : 1e9;
    if (off < least) {
      least = off;
      best = &each;
    }
  }
  return best;
}

}  // namespace

void ShownThing::begin(const std::string& kind) {
  kind_ = kind;
  views_.clear();
  sizes_.clear();
}

std::optional<GenericObject> ShownThing::add(const std::vector<DetectedObject>& seen,
                                             const PinholeCamera& camera) {
  if (kind_.empty()) return std::nullopt;
  const DetectedObject* shown = inTheMiddle(seen, camera);
  if (shown == nullptr) return std::nullopt;
  views_.push_back(shown->descriptor);
  sizes_.emplace_back(shown->high.x - shown->low.x, shown->high.y - shown->low.y,
                      shown->high.z - shown->low.z);
  if (views_.size() < views_to_learn_) return std::nullopt;
  GenericObject learnt = learnObject(kind_, views_, sizes_);
  kind_.clear();
  return learnt;
}

}  // namespace hyselam_objects
