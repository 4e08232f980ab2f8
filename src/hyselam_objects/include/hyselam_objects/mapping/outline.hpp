// The outline of an object seen from above, as a convex set: how far it reaches in each direction.
// Views of one object are combined direction by direction, whichever part of it each of them shows.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace hyselam_objects {

/// Of the directions; the first is x, they go on counterclockwise.
constexpr std::size_t kOutlineDirections = 72;

/// Largest coordinate along each direction, map frame [m]. Empty: not known.
using Outline = std::vector<double>;

/// A rectangle on the ground.
struct GroundBox {
  double x = 0.0, y = 0.0;           ///< its middle [m]
  double length = 0.0, width = 0.0;  ///< along its first and second axis [m]
  double yaw = 0.0;                  ///< of its first axis, in (-pi/4, pi/4]
};

/// Of points, in each direction without the share `trim` that reaches farthest. Empty without
/// points.
Outline outlineOf(const std::vector<Eigen::Vector2f>& points, double trim);

/// Of a rectangle.
Outline outlineOf(const GroundBox& box);

/// The rectangle of least area; one that is aligned with the axes unless another is clearly
/// smaller, so that round objects are not turned.
GroundBox boxAround(const Outline& outline);

/// Four corners, counterclockwise.
std::array<Eigen::Vector2d, 4> cornersOf(const GroundBox& box);

/// Area that two rectangles have in common [m^2].
double commonArea(const GroundBox& a, const GroundBox& b);

/// Least distance of two rectangles; 0 if they overlap [m].
double gapBetween(const GroundBox& a, const GroundBox& b);

/// Adds one view to what is known, `gain` of its share, 0 .. 1. A view shows a part, hardly ever
/// more: what reaches farther counts for more than what reaches less.
void addView(Outline& known, const Outline& view, double gain);

/// The outline around both.
void unite(Outline& a, const Outline& b);

/// Moves it by (x, y).
void shift(Outline& outline, double x, double y);

}  // namespace hyselam_objects
