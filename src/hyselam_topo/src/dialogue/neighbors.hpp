// Which places of a map lie beside each other: by doors, by walls that they share.
#pragma once

#include <vector>

#include "hyselam_topological_map/topological_map.hpp"

namespace hyselam_topo {

/// Whether an edge of the map joins one of `a` and one of `b`.
bool areJoined(const AugmentedTopologicalMap& map, const std::vector<Id>& a,
               const std::vector<Id>& b);
/// What edges join with one of `places`, without these.
std::vector<Id> neighborsOf(const AugmentedTopologicalMap& map, const std::vector<Id>& places);
/// What lies behind walls of `places` (sharedWalls()), without an edge to them.
std::vector<Id> placesBehind(const AugmentedTopologicalMap& map, const std::vector<Id>& places);
/// Whether two places have an edge or share a wall.
bool areNeighbors(const AugmentedTopologicalMap& map, Id a, Id b);
/// Whether edges lead from both of them to the same place.
bool haveCommonNeighbor(const AugmentedTopologicalMap& map, Id a, Id b);

}  // namespace hyselam_topo
