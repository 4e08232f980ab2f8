// The augmented topological map of a segmented grid map: places with their walls, edges with their
// doors, and which cell belongs to which place.
#pragma once

#include "hyselam_common/occupancy_grid.hpp"
#include "hyselam_gr2to/map_builder/walls.hpp"
#include "hyselam_gr2to/segmentation/place_segmentation.hpp"
#include "hyselam_topological_map/topological_map.hpp"

namespace hyselam_topo {

/// When a place is a corridor. Its width is four times the mean distance of its cells to its limits
/// (free-standing obstacles in it are ignored): 2/3 of the side for a square, and the width for a
/// long strip, straight, bent or branched. Its elongation is its area by its width squared: 2.25
/// for a square, about the length by the width for a strip.
struct CorridorRule {
  double max_width = 4.0;         ///< [m] > 0
  int min_neighbors = 4;          ///< other places that it leads to,
  double min_elongation = 4.0;    ///< and its elongation then, >= 1
  double long_elongation = 10.0;  ///< with two or three neighbors, >= min_elongation

  void describe(hyselam::ParameterVisitor& visit);
  void validate() const;  ///< @throws hyselam::ParameterError
};

struct MapBuilderParams {
  WallParams walls;
  CorridorRule corridor;

  void describe(hyselam::ParameterVisitor& visit);
  void validate() const;  ///< @throws hyselam::ParameterError
};

/// Place k + 1 of the map is label k + 1; ids of walls and doors are given in order. Places have
/// area, centre, outline and kind, no words. Doors are open: a closed one is a wall in the grid.
/// @throws as extractWalls(), hyselam::ParameterError for a rule out of range.
AugmentedTopologicalMap buildTopologicalMap(const hyselam::OccupancyGrid& grid,
                                            const PlaceSegmentation& segmentation,
                                            const MapBuilderParams& params = {});

}  // namespace hyselam_topo
