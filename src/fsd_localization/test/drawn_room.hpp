// A room without symmetry, what a laser sees in it, and random worlds as grids.
#pragma once

#include "fsd_localization/models/grid_ray_caster.hpp"
#include "hyselam_common/testing/drawn_grid.hpp"
#include "look.hpp"
#include "random_worlds.hpp"

inline hyselam::OccupancyGrid gridOf(const transcription::Cells& cells) {
  hyselam::GridGeometry g;
  g.width = cells.width;
  g.height = cells.height;
  hyselam::OccupancyGrid map(g);
  for (int y = 0; y < g.height; ++y) {
    for (int x = 0; x < g.width; ++x) {
      map.at({x, y}) = cells.at(x, y) == transcription::Cells::kOccupied ? 100
                       : cells.at(x, y) == transcription::Cells::kFree   ? 0
                                                                         : -1;
    }
  }
  return map;
}

/// A room of 12 x 8 m with one alcove, so that no two places look the same.
inline hyselam::OccupancyGrid room() {
  return hyselam::testing::drawnGrid({"#######",  //
                                      "#.....#",  //
                                      "#.#...#",  //
                                      "#.....#",  //
                                      "#...#.#",  //
                                      "#######"},
                                     0.1, {3, 27, 10, 30, 5, 42, 3}, {3, 17, 10, 20, 27, 3});
}
