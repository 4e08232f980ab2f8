#include "boxes.hpp"

#include <algorithm>
#include <cmath>

namespace hyselam_objects {

double distance(const Point3& a, const Point3& b) {
  return std::hypot(a.x - b.x, a.y - b.y, a.z - b.z);
}

ObjectPose boxOf(const DetectedObject& seen) {
  return {seen.center(),
          {seen.high.x - seen.low.x, seen.high.y - seen.low.y, seen.high.z - seen.low.z},
          0.0,
          {}};
}

void unite(ObjectPose& a, const ObjectPose& b) {
  const std::array<double, 3> other{b.position.x, b.position.y, b.position.z};
  const std::array<double*, 3> middle{&a.position.x, &a.position.y, &a.position.z};
  for (std::size_t k = 0; k < 3; ++k) {
    const double low = std::min(*middle[k] - 0.5 * a.size[k], other[k] - 0.5 * b.size[k]);
    const double high = std::max(*middle[k] + 0.5 * a.size[k], other[k] + 0.5 * b.size[k]);
    *middle[k] = 0.5 * (low + high);
    a.size[k] = high - low;
  }
}

double footprintOverlap(const ObjectPose& a, const DetectedObject& b) {
  const auto common = [](double low1, double high1, double low2, double high2) {
    return std::max(0.0, std::min(high1, high2) - std::max(low1, low2));
  };
  const double x =
      common(a.position.x - 0.5 * a.size[0], a.position.x + 0.5 * a.size[0], b.low.x, b.high.x);
  const double y =
      common(a.position.y - 0.5 * a.size[1], a.position.y + 0.5 * a.size[1], b.low.y, b.high.y);
  const double least = std::min(a.size[0] * a.size[1], (b.high.x - b.low.x) * (b.high.y - b.low.y));
  return least > 0.0 ? x * y / least : 0.0;
}

double containedFraction(const ObjectPose& a, const ObjectPose& b) {
  const std::array<double, 3> p{a.position.x, a.position.y, a.position.z},
      q{b.position.x, b.position.y, b.position.z};
  double share = 1.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double low = std::max(p[k] - 0.5 * a.size[k], q[k] - 0.5 * b.size[k]);
    const double high = std::min(p[k] + 0.5 * a.size[k], q[k] + 0.5 * b.size[k]);
    share *= std::max(0.0, high - low) / std::max(a.size[k], 1e-6);
  }
  return share;
}

bool isWithinFootprint(const ObjectPose& box, const Point3& p) {
  constexpr double kMargin = 0.02;
  return std::abs(p.x - box.position.x) < 0.5 * box.size[0] + kMargin &&
         std::abs(p.y - box.position.y) < 0.5 * box.size[1] + kMargin;
}

bool contains(const ObjectPose& box, const Point3& p) {
  return isWithinFootprint(box, p) && std::abs(p.z - box.position.z) < 0.5 * box.size[2];
}

bool areAtSameSpot(const ObjectPose& a, const ObjectPose& b) {
  const double low = std::max(a.position.z - 0.5 * a.size[2], b.position.z - 0.5 * b.size[2]);
  const double high = std::min(a.position.z + 0.5 * a.size[2], b.position.z + 0.5 * b.size[2]);
  return isWithinFootprint(a, b.position) && isWithinFootprint(b, a.position) &&
         high - low > 0.5 * std::min(a.size[2], b.size[2]);
}

}  // namespace hyselam_objects
