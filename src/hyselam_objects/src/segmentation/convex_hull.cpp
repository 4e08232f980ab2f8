#include "convex_hull.hpp"

#include <algorithm>

namespace hyselam_objects {
namespace {

double cross(const Eigen::Vector2f& a, const Eigen::Vector2f& b) {
  return static_cast<double>(a.x()) * b.y() - static_cast<double>(a.y()) * b.x();
}

}  // namespace

// Monotone chain (Andrew 1979).
ConvexHull convexHull(std::vector<Eigen::Vector2f> points) {
  std::sort(points.begin(), points.end(), [](const auto& a, const auto& b) {
    return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
  });
  ConvexHull hull;
  for (int side = 0; side < 2; ++side) {
    const std::size_t begin = hull.size();
    for (const Eigen::Vector2f& p : points) {
      while (hull.size() >= begin + 2 &&
             cross(hull.back() - hull[hull.size() - 2], p - hull.back()) <= 0.0) {
        hull.pop_back();
      }
      hull.push_back(p);
    }
    if (!hull.empty()) hull.pop_back();
    std::reverse(points.begin(), points.end());
  }
  return hull;
}

double areaOf(const ConvexHull& hull) {
  double area = 0.0;
  for (std::size_t i = 0; i < hull.size(); ++i) area += cross(hull[i], hull[(i + 1) % hull.size()]);
  return 0.5 * area;
}

double distanceOutside(const ConvexHull& hull, const Eigen::Vector2f& p) {
  double farthest = -1e9;
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Eigen::Vector2f edge = hull[(i + 1) % hull.size()] - hull[i];
    const double length = edge.norm();
    if (length > 0.0) farthest = std::max(farthest, -cross(edge, p - hull[i]) / length);
  }
  return farthest;
}

}  // namespace hyselam_objects
