// Occupancy grids with the conventions of nav_msgs/OccupancyGrid: row-major, cell (0, 0) at the
// origin, x along a row, values 0 (free) .. 100 (occupied), -1 unknown.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hyselam_common/pose2.hpp"

namespace hyselam {

/// Column x and row y of a cell; may lie outside its grid.
struct Cell {
  int x = 0;
  int y = 0;
  bool operator==(const Cell& o) const { return x == o.x && y == o.y; }
  bool operator!=(const Cell& o) const { return !(*this == o); }
};

/// Where the cells of a grid lie in the map frame.
struct GridGeometry {
  int width = 0;            ///< cells along x
  int height = 0;           ///< cells along y
  double resolution = 0.1;  ///< side of a cell [m]
  Pose2 origin;  ///< pose, in the map frame, of the outer corner of cell (0, 0); may be rotated

  std::size_t cellCount() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  bool contains(Cell c) const { return c.x >= 0 && c.y >= 0 && c.x < width && c.y < height; }
  /// Row-major index; only for cells inside.
  std::size_t index(Cell c) const {
    return static_cast<std::size_t>(c.y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(c.x);
  }
  /// The cell that holds a point of the map frame; possibly outside.
  Cell cellAt(Point2 map_point) const {
    const Point2 p = origin.inverse() * map_point;
    return {static_cast<int>(std::floor(p.x / resolution)),
            static_cast<int>(std::floor(p.y / resolution))};
  }
  /// Centre of a cell in the map frame [m].
  Point2 center(Cell c) const {
    return origin * Point2{(c.x + 0.5) * resolution, (c.y + 0.5) * resolution};
  }
};

/// A grid map. `cells.size() == geometry.cellCount()`.
struct OccupancyGrid {
  static constexpr std::int8_t kUnknown = -1;
  static constexpr std::int8_t kFree = 0;
  static constexpr std::int8_t kOccupied = 100;

  GridGeometry geometry;
  std::vector<std::int8_t> cells;

  OccupancyGrid() = default;
  explicit OccupancyGrid(const GridGeometry& g, std::int8_t value = kUnknown)
      : geometry(g), cells(g.cellCount(), value) {}

  std::int8_t at(Cell c) const { return cells[geometry.index(c)]; }
  std::int8_t& at(Cell c) { return cells[geometry.index(c)]; }
  /// The value, or unknown outside the grid.
  std::int8_t valueOr(Cell c, std::int8_t outside = kUnknown) const {
    return geometry.contains(c) ? at(c) : outside;
  }
};

}  // namespace hyselam
