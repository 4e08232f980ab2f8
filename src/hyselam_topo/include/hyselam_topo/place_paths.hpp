// Ways within a place, over its cells: for pictures of the graph that do not cross walls, and for
// telling people the way.
#pragma once

#include <vector>

#include "hyselam_topo/topological_map.hpp"

namespace hyselam_topo {

/// The ways over the cells of a place from `points` to `goal`, each pulled taut: as few straight
/// pieces as leave no cell of the place by more than a cell's corner. Points outside of the place
/// begin at its nearest cell. A way is empty if it does not exist, or the place has no cells.
/// Cost: linear in the cells around the place.
std::vector<std::vector<hyselam::Point2>> waysWithin(const PlaceGrid& grid, Id place,
                                                     const std::vector<hyselam::Point2>& points,
                                                     hyselam::Point2 goal);

}  // namespace hyselam_topo
