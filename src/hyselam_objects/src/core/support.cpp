#include "support.hpp"

#include <algorithm>
#include <cmath>

namespace hyselam_objects {
namespace {

double sigmaAt(float depth, const SegmentParams& params) {
  const double more = std::max(0.0, static_cast<double>(depth) - 0.4);
  return params.noise_floor + params.noise_growth * more * more;
}

}  // namespace

bool isTaller(const DetectedObject& object, const std::vector<LevelSurface>& surfaces,
              const DetectParams& params) {
  const Point3 c = object.center();
  for (const LevelSurface& surface : surfaces) {
    const Eigen::Vector2f middle(static_cast<float>(c.x), static_cast<float>(c.y));
    if (surface.height > c.z || outside(surface.hull, middle) > 0.1) continue;
    return object.high.z > surface.height + 0.95 * params.segment.tallest;
  }
  return false;
}

bool isFloating(const DetectedObject& object, const std::vector<DetectedObject>& others,
                const std::vector<LevelSurface>& surfaces, const Eigen::Vector3f& eye,
                const DetectParams& params) {
  constexpr double kContact = 0.02, kAside = 0.02;
  const Point3 c = object.center();
  const Eigen::Vector3f middle(static_cast<float>(c.x), static_cast<float>(c.y),
                               static_cast<float>(c.z));
  const double noise =
      2.0 * sigmaAt((middle - eye).norm(), params.segment) + params.segment.support_distance;
  for (const LevelSurface& surface : surfaces) {
    const double air = object.low.z - surface.height;
    if (air > -kContact && air < kContact + noise &&
        outside(surface.hull, middle.head<2>()) < kAside) {
      return false;
    }
  }
  // What is as thin as the noise on another thing is that thing's own top.
  if (object.high.z - object.low.z < kContact + noise) return true;
  return std::none_of(others.begin(), others.end(), [&](const DetectedObject& below) {
    if (&below == &object || below.center().z > c.z) return false;
    const bool over = c.x > below.low.x - kAside && c.x < below.high.x + kAside &&
                      c.y > below.low.y - kAside && c.y < below.high.y + kAside;
    return over && std::abs(object.low.z - below.high.z) < kContact + noise;
  });
}

}  // namespace hyselam_objects
