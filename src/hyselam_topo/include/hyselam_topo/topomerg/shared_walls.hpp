// Places of a map that lie side by side: walls of theirs are the two faces of one.
#pragma once

#include <cstddef>
#include <vector>

#include "hyselam_common/pose2.hpp"
#include "hyselam_topological_map/topological_map.hpp"

namespace hyselam_topo {

/// Walls of two places without an edge that lie back to back, at most 0.6 m apart (or overlapping
/// by 0.3 m), for 0.7 m or more: a closed door may be there.
struct SharedWall {
  std::size_t a = 0;  ///< places[a] and places[b] of the map, a < b
  std::size_t b = 0;
  hyselam::Point2 normal;  ///< from a to b, of length 1
  hyselam::Point2 middle;  ///< of the stretch that they have in common, frame of the map [m]
};

/// In the order of the places and of their walls.
std::vector<SharedWall> sharedWalls(const AugmentedTopologicalMap& map);

}  // namespace hyselam_topo
