#include "hyselam_sim/geometry.hpp"

#include <algorithm>
#include <cmath>

namespace hyselam_sim {

double distance(Point2 p, const Segment& s) {
  const Point2 d = s.b - s.a;
  const double square = dot(d, d);
  const double t = square > 0.0 ? std::clamp(dot(p - s.a, d) / square, 0.0, 1.0) : 0.0;
  return length(p - (s.a + t * d));
}

bool contains(const Polygon& polygon, Point2 p) {
  bool inside = false;
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const Point2 a = polygon[i], b = polygon[j];
    if ((a.y > p.y) != (b.y > p.y) && p.x < (b.x - a.x) * (p.y - a.y) / (b.y - a.y) + a.x) {
      inside = !inside;
    }
  }
  return inside;
}

Polygon thickSegment(Point2 a, Point2 b, double thickness, double before, double after) {
  const double l = length(b - a);
  const Point2 u = (1.0 / l) * (b - a);
  const Point2 n = (0.5 * thickness) * Point2{-u.y, u.x};
  const Point2 from = a - before * u, to = b + after * u;
  return {from - n, to - n, to + n, from + n};
}

bool touchesBox(const Segment& s, Point2 min, Point2 max) {
  // Liang-Barsky: what is left of the segment after clipping it with the four sides.
  double t0 = 0.0, t1 = 1.0;
  const Point2 d = s.b - s.a;
  const double p[4] = {-d.x, d.x, -d.y, d.y};
  const double q[4] = {s.a.x - min.x, max.x - s.a.x, s.a.y - min.y, max.y - s.a.y};
  for (int i = 0; i < 4; ++i) {
    if (p[i] == 0.0) {
      if (q[i] < 0.0) return false;
    } else if (p[i] < 0.0) {
      t0 = std::max(t0, q[i] / p[i]);
    } else {
      t1 = std::min(t1, q[i] / p[i]);
    }
  }
  return t0 <= t1;
}

double polylineLength(const std::vector<Point2>& points) {
  double sum = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i) sum += length(points[i] - points[i - 1]);
  return sum;
}

}  // namespace hyselam_sim
