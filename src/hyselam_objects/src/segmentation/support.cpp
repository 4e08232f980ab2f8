#include "support.hpp"

#include <algorithm>
#include <cmath>

namespace hyselam_objects {
namespace {

/// Standard deviation of a depth [m].
double sigmaAt(float depth, const SegmentParams& params) {
  const double more = std::max(0.0, static_cast<double>(depth) - 0.4);
  return params.noise_floor + params.noise_growth * more * more;
}

}  // namespace

bool exceedsObjectHeight(const DetectedObject& object,
                         const std::vector<HorizontalSurface>& surfaces,
                         const DetectParams& params) {
  constexpr double kAside = 0.1, kShare = 0.95;  // [m]; of the largest height
  const Point3 c = object.center();
  for (const HorizontalSurface& surface : surfaces) {
    const Eigen::Vector2f middle(static_cast<float>(c.x), static_cast<float>(c.y));
    if (surface.height > c.z || distanceOutside(surface.hull, middle) > kAside) continue;
    return object.high.z > surface.height + kShare * params.segmentation.max_object_height;
  }
  return false;
}

bool isFloating(const DetectedObject& object, const std::vector<DetectedObject>& others,
                const std::vector<HorizontalSurface>& surfaces,
                const Eigen::Vector3f& camera_position, const DetectParams& params) {
  constexpr double kContact = 0.02, kAside = 0.02;  // [m]
  const Point3 c = object.center();
  const Eigen::Vector3f middle(static_cast<float>(c.x), static_cast<float>(c.y),
                               static_cast<float>(c.z));
  const double noise = 2.0 * sigmaAt((middle - camera_position).norm(), params.segmentation) +
                       params.segmentation.support_distance;
  for (const HorizontalSurface& surface : surfaces) {
    const double gap = object.low.z - surface.height;
    if (gap > -kContact && gap < kContact + noise &&
        distanceOutside(surface.hull, middle.head<2>()) < kAside) {
      return false;
    }
  }
  // A layer as thin as the noise on another object is the top of that object.
  if (object.high.z - object.low.z < kContact + noise) return true;
  return std::none_of(others.begin(), others.end(), [&](const DetectedObject& below) {
    if (&below == &object || below.center().z > c.z) return false;
    const bool over = c.x > below.low.x - kAside && c.x < below.high.x + kAside &&
                      c.y > below.low.y - kAside && c.y < below.high.y + kAside;
    return over && std::abs(object.low.z - below.high.z) < kContact + noise;
  });
}

}  // namespace hyselam_objects
