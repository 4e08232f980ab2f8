// The augmented topological map of a segmented grid map: places with their walls, edges with their
// doors, and which cell belongs to which place.
#pragma once

#include "hyselam_common/occupancy_grid.hpp"
#include "hyselam_topo/segmentation.hpp"
#include "hyselam_topo/topological_map.hpp"
#include "hyselam_topo/walls.hpp"

namespace hyselam_topo {

/// When a place is a corridor. Its width is the diameter of the largest circle that fits between
/// its walls (what stands free in it is seen through), its elongation its area by its width
/// squared: 1 for a square, and the length by the width for a corridor, straight, bent or branched.
struct CorridorRule {
  double max_width = 4.0;        ///< [m] > 0
  double min_elongation = 3.0;   ///< with `min_neighbours` or more places around, >= 1
  double long_elongation = 6.0;  ///< with any number, >= min_elongation
  int min_neighbours = 3;
};

struct MapBuilderParams {
  WallParams walls;
  CorridorRule corridor;
};

/// Place k + 1 of the map is label k + 1; ids of walls and doors are given in order. Places have
/// area, centre, outline and kind, no words. Doors are open: a closed one is a wall in the grid.
/// @throws as extractWalls(), hyselam::ParameterError for a rule out of range.
AugmentedTopologicalMap buildTopologicalMap(const hyselam::OccupancyGrid& grid,
                                            const Segmentation& segmentation,
                                            const MapBuilderParams& params = {});

}  // namespace hyselam_topo
