#include "hyselam_objects/mapping/outline.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "hyselam_common/pose2.hpp"

namespace hyselam_objects {
namespace {

constexpr std::size_t kHalf = kOutlineDirections / 2, kQuarter = kOutlineDirections / 4;

Eigen::Vector2d direction(std::size_t k) {
  static const std::vector<Eigen::Vector2d> kAll = [] {
    std::vector<Eigen::Vector2d> all;
    for (std::size_t i = 0; i < kOutlineDirections; ++i) {
      const double angle = 2.0 * hyselam::kPi * static_cast<double>(i) / kOutlineDirections;
      all.emplace_back(std::cos(angle), std::sin(angle));
    }
    return all;
  }();
  return kAll[k];
}

using Polygon = std::vector<Eigen::Vector2d>;

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// The part of a polygon on the left of a line.
Polygon leftOf(const Polygon& polygon, const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  Polygon out;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double at_a = cross(to - from, a - from), at_b = cross(to - from, b - from);
    if (at_a >= 0.0) out.push_back(a);
    if ((at_a >= 0.0) != (at_b >= 0.0)) out.push_back(a + at_a / (at_a - at_b) * (b - a));
  }
  return out;
}

Polygon intersection(const GroundBox& a, const GroundBox& b) {
  const auto corners = cornersOf(a), cut = cornersOf(b);
  Polygon out(corners.begin(), corners.end());
  for (std::size_t i = 0; i < cut.size() && !out.empty(); ++i) {
    out = leftOf(out, cut[i], cut[(i + 1) % cut.size()]);
  }
  return out;
}

/// Distance of a point outside of a rectangle; 0 within it.
double distanceOutside(const GroundBox& box, const Eigen::Vector2d& p) {
  const double c = std::cos(box.yaw), s = std::sin(box.yaw);
  const double dx = p.x() - box.x, dy = p.y() - box.y;
  const double along = std::max(0.0, std::abs(c * dx + s * dy) - 0.5 * box.length);
  const double across = std::max(0.0, std::abs(c * dy - s * dx) - 0.5 * box.width);
  return std::hypot(along, across);
}

}  // namespace

Outline outlineOf(const std::vector<Eigen::Vector2f>& points, double trim) {
  if (points.empty()) return {};
  Outline out(kOutlineDirections, 0.0);
  std::vector<float> along(points.size());
  const auto n = static_cast<double>(points.size() - 1);
  for (std::size_t k = 0; k < kHalf; ++k) {
    const Eigen::Vector2f unit = direction(k).cast<float>();
    std::transform(points.begin(), points.end(), along.begin(),
                   [&](const Eigen::Vector2f& p) { return unit.dot(p); });
    const auto at = [&](double share) {
      const auto place = along.begin() + static_cast<std::ptrdiff_t>(share * n);
      std::nth_element(along.begin(), place, along.end());
      return static_cast<double>(*place);
    };
    out[k] = at(1.0 - trim);
    out[k + kHalf] = -at(trim);
  }
  return out;
}

Outline outlineOf(const GroundBox& box) {
  Outline out(kOutlineDirections, -std::numeric_limits<double>::infinity());
  for (const Eigen::Vector2d& corner : cornersOf(box)) {
    for (std::size_t k = 0; k < kOutlineDirections; ++k) {
      out[k] = std::max(out[k], direction(k).dot(corner));
    }
  }
  return out;
}

GroundBox boxAround(const Outline& outline) {
  // Of a rectangle that is wrong by an angle e the area is larger by (l/w + w/l) e at least.
  constexpr double kClearly = 0.95;
  const auto length = [&](std::size_t k) {
    return std::max(0.0, outline[k] + outline[(k + kHalf) % kOutlineDirections]);
  };
  std::size_t best = 0;
  for (std::size_t k = 1; k < kQuarter; ++k) {
    const double limit = best == 0 ? kClearly : 1.0;
    if (length(k) * length(k + kQuarter) < limit * length(best) * length(best + kQuarter)) best = k;
  }
  // (-pi/4, pi/4]
  const std::size_t axis = 2 * best > kQuarter ? best + kOutlineDirections - kQuarter : best;
  const std::size_t first = axis % kOutlineDirections,
                    second = (axis + kQuarter) % kOutlineDirections;
  GroundBox box;
  box.length = length(first);
  box.width = length(second);
  box.yaw = std::atan2(direction(first).y(), direction(first).x());
  const double along =
      outline[first] - 0.5 * (outline[first] + outline[(first + kHalf) % kOutlineDirections]);
  const double across =
      outline[second] - 0.5 * (outline[second] + outline[(second + kHalf) % kOutlineDirections]);
  const Eigen::Vector2d middle = along * direction(first) + across * direction(second);
  box.x = middle.x();
  box.y = middle.y();
  return box;
}

std::array<Eigen::Vector2d, 4> cornersOf(const GroundBox& box) {
  const Eigen::Vector2d middle(box.x, box.y);
  const Eigen::Vector2d u =
      0.5 * box.length * Eigen::Vector2d(std::cos(box.yaw), std::sin(box.yaw));
  const Eigen::Vector2d v =
      0.5 * box.width * Eigen::Vector2d(-std::sin(box.yaw), std::cos(box.yaw));
  return {middle - u - v, middle + u - v, middle + u + v, middle - u + v};
}

double commonArea(const GroundBox& a, const GroundBox& b) {
  const Polygon common = intersection(a, b);
  double twice = 0.0;
  for (std::size_t i = 0; i < common.size(); ++i) {
    twice += cross(common[i], common[(i + 1) % common.size()]);
  }
  return 0.5 * std::max(0.0, twice);
}

double gapBetween(const GroundBox& a, const GroundBox& b) {
  if (!intersection(a, b).empty()) return 0.0;
  // Of two convex polygons apart one corner is nearest to the other one.
  double least = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector2d& p : cornersOf(a)) least = std::min(least, distanceOutside(b, p));
  for (const Eigen::Vector2d& p : cornersOf(b)) least = std::min(least, distanceOutside(a, p));
  return least;
}

void addView(Outline& known, const Outline& view, double gain) {
  constexpr double kLess = 0.35;  // weight of what reaches less
  if (view.size() != kOutlineDirections) return;
  if (known.size() != kOutlineDirections) {
    known = view;
    return;
  }
  for (std::size_t k = 0; k < kOutlineDirections; ++k) {
    const double more = view[k] - known[k];
    known[k] += gain * (more > 0.0 ? more : kLess * more);
  }
}

void unite(Outline& a, const Outline& b) {
  if (b.size() != kOutlineDirections) return;
  if (a.size() != kOutlineDirections) {
    a = b;
    return;
  }
  for (std::size_t k = 0; k < kOutlineDirections; ++k) a[k] = std::max(a[k], b[k]);
}

void shift(Outline& outline, double x, double y) {
  for (std::size_t k = 0; k < outline.size(); ++k) {
    outline[k] += direction(k).dot(Eigen::Vector2d(x, y));
  }
}

}  // namespace hyselam_objects
