// Convex hulls in the plane.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace hyselam_objects {

/// Corners, counter-clockwise [m].
using ConvexHull = std::vector<Eigen::Vector2f>;

ConvexHull convexHull(std::vector<Eigen::Vector2f> points);

/// [m^2]
double areaOf(const ConvexHull& hull);

/// Distance of a point from the hull; <= 0 inside [m].
double distanceOutside(const ConvexHull& hull, const Eigen::Vector2f& p);

}  // namespace hyselam_objects
