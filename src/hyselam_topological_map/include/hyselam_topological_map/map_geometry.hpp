// Geometry of the parts of an augmented topological map, seen from above.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "hyselam_topological_map/topological_map.hpp"

namespace hyselam_topo {

using Segment = std::pair<hyselam::Point2, hyselam::Point2>;

/// The straight solid wall from `a` to `b`, of unknown height, whose normal points to the left of
/// the way from a to b. Two equal points give a wall of length 0 with the normal (1, 0, 0).
Wall straightWall(hyselam::Point2 a, hyselam::Point2 b);

/// The real door between two door posts whose normal points to the left of the way from a to b.
Door doorBetween(hyselam::Point2 a, hyselam::Point2 b);

/// The door posts: doorBetween(first, second) gives the same place, width and normal.
Segment ends(const Door& door);

/// The wall on the floor, from end to end with the side of the normal to the left; two points if it
/// is straight, else as many as keep the chords within `max_error` [m] of the arc.
std::vector<hyselam::Point2> polyline(const Wall& wall, double max_error = 0.01);

/// Area within a polygon [m^2]; > 0 if its corners go counter-clockwise.
double signedArea(const std::vector<hyselam::Point2>& polygon);

/// Even-odd rule; false for less than three corners.
bool contains(const std::vector<hyselam::Point2>& polygon, hyselam::Point2 point);

struct PlaceAt {
  Id place = 0;
  double distance = 0.0;  ///< from the point to the nearest cell of the place [m], 0: inside
};

/// The place at a point of the map frame: by the grid if the map has one, then by the outlines
/// (the smallest place that contains the point). If there is none, the nearest place of the grid
/// within `max_distance` [m] (measured to the centres of cells). Nothing if that fails too, or if
/// the point is not finite.
std::optional<PlaceAt> placeAt(const AugmentedTopologicalMap& map, hyselam::Point2 point,
                               double max_distance = 0.0);

}  // namespace hyselam_topo
