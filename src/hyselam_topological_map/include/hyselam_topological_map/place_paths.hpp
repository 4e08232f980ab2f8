// Paths within a place, over its cells: to draw the graph without crossing walls, and to describe
// routes to people.
#pragma once

#include <map>
#include <vector>

#include "hyselam_topological_map/topological_map.hpp"

namespace hyselam_topo {

/// The cells around a place: [x_begin, x_end) x [y_begin, y_end).
struct CellBox {
  int x_begin = 0, y_begin = 0, x_end = 0, y_end = 0;
};

/// The smallest box around each place that has cells. One pass over the grid.
std::map<Id, CellBox> placeBoxes(const PlaceGrid& grid);

/// The paths over the cells of a place from `points` to `goal`, as people walk: short, but not
/// close along walls where there is room, so that paths along a corridor coincide. Each is pulled
/// taut: as few straight pieces as leave no cell of the place by more than a cell's corner and come
/// no closer to its limits. Points outside of the place begin at its nearest cell. A path is empty
/// if it does not exist, or the place has no cells. `box`: of placeBoxes(); cells outside of it are
/// ignored. Cost: n log n in the box's cells.
std::vector<std::vector<hyselam::Point2>> waysWithin(const PlaceGrid& grid, Id place,
                                                     const CellBox& box,
                                                     const std::vector<hyselam::Point2>& points,
                                                     hyselam::Point2 goal);

}  // namespace hyselam_topo
