// Fifth stage of the thesis' pipeline (section 4.2): the polygon of a place from what is seen of
// its walls.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "hyselam_gr2to/thesis/thesis.hpp"

namespace hyselam_topo {

using cv::Point2d;

namespace {

constexpr double kBeam = 2.0 * hyselam::kPi / 8.0;

Point2d centreOf(const Circle& circle) {
  return {static_cast<double>(circle.centre.x), static_cast<double>(circle.centre.y)};
}

/// How far the polygon of a circle may reach in each beam (Eq. 4.4).
std::array<double, 8> limitsOf(std::size_t i, const std::vector<Circle>& circles) {
  std::array<double, 8> limits;
  limits.fill(std::numeric_limits<double>::infinity());
  std::array<double, 8> closest = limits;
  for (std::size_t j = 0; j < circles.size(); ++j) {
    if (j == i) continue;
    const Point2d to = centreOf(circles[j]) - centreOf(circles[i]);
    const double d = std::hypot(to.x, to.y);
    const auto beam =
        static_cast<std::size_t>((std::lround(std::atan2(to.y, to.x) / kBeam) + 8) % 8);
    if (d >= closest[beam]) continue;
    closest[beam] = d;
    limits[beam] = circles[i].radius / (circles[i].radius + circles[j].radius) * d;
  }
  return limits;
}

class Obstacles {
 public:
  explicit Obstacles(const cv::Mat& cells) : cells_(cells) {}

  /// The vertex in the beam of an axis: the farthest of the obstacles that its rays meet first.
  Point2d vertex(const Circle& circle, double axis, double limit) const {
    constexpr int kRays = 17;  // in a beam
    const Point2d centre = centreOf(circle);
    Point2d vertex;
    double farthest = -1.0;
    for (int ray = 0; ray < kRays; ++ray) {
      const double angle = axis + kBeam * (static_cast<double>(ray) / (kRays - 1) - 0.5);
      const Point2d u{std::cos(angle), std::sin(angle)};
      for (int half = 2; 0.5 * half <= limit; ++half) {
        const double s = 0.5 * half;
        const int x = static_cast<int>(std::lround(centre.x + s * u.x)),
                  y = static_cast<int>(std::lround(centre.y + s * u.y));
        if (!isInside(x, y)) break;
        if (!isAt(x, y)) continue;
        if (s > farthest) {
          farthest = s;
          vertex = Point2d(x, y);
        }
        break;
      }
    }
    if (farthest >= 0.0) return vertex;
    const double s = std::isfinite(limit) ? limit : circle.radius;
    return centre + s * Point2d(std::cos(axis), std::sin(axis));
  }

  /// Whether obstacles lie along a share of the line. A wall that is not along the cells swerves by
  /// one beside its chord.
  bool isWall(const Point2d& a, const Point2d& b, double share) const {
    const int n = std::max(1, static_cast<int>(std::ceil(std::hypot(b.x - a.x, b.y - a.y))));
    int occupied = 0;
    for (int t = 0; t <= n; ++t) {
      const Point2d p = a + (static_cast<double>(t) / n) * (b - a);
      occupied += touches(static_cast<int>(std::lround(p.x)), static_cast<int>(std::lround(p.y)));
    }
    return occupied >= share * (n + 1);
  }

 private:
  bool isInside(int x, int y) const {
    return x >= 0 && y >= 0 && x < cells_.cols && y < cells_.rows;
  }
  bool isAt(int x, int y) const { return cells_.at<std::uint8_t>(y, x) != 0; }
  bool touches(int x, int y) const {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        if (isInside(x + dx, y + dy) && isAt(x + dx, y + dy)) return true;
      }
    }
    return false;
  }

  const cv::Mat& cells_;
};

}  // namespace

std::vector<PlacePolygon> drawPolygons(const std::vector<Circle>& circles, const cv::Mat& obstacles,
                                       double wall_share) {
  const Obstacles walls(obstacles);
  std::vector<PlacePolygon> out(circles.size());
  for (std::size_t i = 0; i < circles.size(); ++i) {
    auto& [vertices, wall] = out[i];
    const std::array<double, 8> limits = limitsOf(i, circles);
    for (std::size_t k = 0; k < 8; ++k) {
      vertices[k] = walls.vertex(circles[i], static_cast<double>(k) * kBeam, limits[k]);
    }
    for (std::size_t k = 0; k < 8; ++k) {
      wall[k] = walls.isWall(vertices[k], vertices[(k + 1) % 8], wall_share);
    }
  }
  return out;
}

}  // namespace hyselam_topo
