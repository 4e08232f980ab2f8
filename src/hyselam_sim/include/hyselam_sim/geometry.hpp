// Plane geometry of floor plans: segments and polygons in the plan frame [m].
#pragma once

#include <vector>

#include "hyselam_common/pose2.hpp"

namespace hyselam_sim {

using hyselam::Point2;
using hyselam::Pose2;

inline Point2 operator+(Point2 a, Point2 b) {
  return {a.x + b.x, a.y + b.y};
}
inline Point2 operator-(Point2 a, Point2 b) {
  return {a.x - b.x, a.y - b.y};
}
inline Point2 operator*(double s, Point2 p) {
  return {s * p.x, s * p.y};
}
inline double dot(Point2 a, Point2 b) {
  return a.x * b.x + a.y * b.y;
}
inline double cross(Point2 a, Point2 b) {
  return a.x * b.y - a.y * b.x;
}
inline double length(Point2 p) {
  return std::hypot(p.x, p.y);
}

/// A straight piece of surface.
struct Segment {
  Point2 a;
  Point2 b;
};

/// A closed outline; the last vertex connects to the first. Simple (not self-crossing).
using Polygon = std::vector<Point2>;

/// Distance from a point to the nearest point of a segment [m].
double distance(Point2 p, const Segment& s);

/// Whether the point lies inside the outline (even-odd rule; either answer on the outline itself).
bool contains(const Polygon& polygon, Point2 p);

/// The rectangle of the given thickness around a -> b, lengthened by `before` at a and `after` at
/// b.
Polygon thickSegment(Point2 a, Point2 b, double thickness, double before, double after);

/// Whether the segment touches the axis-parallel box [min, max].
bool touchesBox(const Segment& s, Point2 min, Point2 max);

/// Length of an open polyline [m].
double polylineLength(const std::vector<Point2>& points);

}  // namespace hyselam_sim
