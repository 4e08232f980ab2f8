// Buildings of voxels for tests of OctoMaps.
#pragma once

#include <cmath>
#include <map>
#include <tuple>

#include "hyselam_gr2to/octomap/octomap_reader.hpp"

namespace hyselam_topo::testing {

/// A building of boxes: occupied where walls, floors and furniture are, else free.
class Building {
 public:
  explicit Building(double resolution) { map_.resolution = resolution; }

  /// [x0, x1) x [y0, y1) x [z0, z1) in metres.
  void add(double x0, double x1, double y0, double y1, double z0, double z1, bool occupied) {
    const auto cell = [&](double v) { return static_cast<int>(std::lround(v / map_.resolution)); };
    for (int z = cell(z0); z < cell(z1); ++z) {
      for (int y = cell(y0); y < cell(y1); ++y) {
        for (int x = cell(x0); x < cell(x1); ++x) cells_[{x, y, z}] = occupied;
      }
    }
  }

  /// A storey of 6 m x 4 m with a wall in the middle, a door in it, a table and a cupboard.
  void addStorey(double z) {
    add(-0.2, 6.2, -0.2, 4.2, z - 0.2, z + 2.8, true);
    add(0, 6, 0, 4, z, z + 2.6, false);
    add(2.9, 3.1, 0, 4, z, z + 2.6, true);
    add(2.9, 3.1, 1, 2, z, z + 2.0, false);           // door with a lintel
    add(0.5, 1.5, 0.5, 1.5, z + 0.7, z + 0.8, true);  // table
    add(4.5, 5.0, 2.0, 3.0, z, z + 1.2, true);        // cupboard
  }

  VoxelMap map() const {
    VoxelMap map = map_;
    for (const auto& [cell, occupied] : cells_) {
      map.leaves.push_back(
          {std::get<0>(cell), std::get<1>(cell), std::get<2>(cell), 1, occupied ? 1.0f : 0.0f});
    }
    return map;
  }

 private:
  VoxelMap map_;
  std::map<std::tuple<int, int, int>, bool> cells_;
};

}  // namespace hyselam_topo::testing
