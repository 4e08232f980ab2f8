// Convex hulls in the plane.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace hyselam_objects {

/// Corners, counter-clockwise [m].
using Hull = std::vector<Eigen::Vector2f>;

Hull hullOf(std::vector<Eigen::Vector2f> points);

double areaOf(const Hull& hull);

/// How far a point lies outside of the hull; <= 0 inside [m].
double outside(const Hull& hull, const Eigen::Vector2f& p);

}  // namespace hyselam_objects
