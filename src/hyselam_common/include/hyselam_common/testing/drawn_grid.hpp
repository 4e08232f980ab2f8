// Grid maps drawn as text, so that tests show their worlds.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "hyselam_common/occupancy_grid.hpp"

namespace hyselam::testing {

/// A character per cell: '#' occupied (wall), '.' free, '?' or ' ' unknown. The first row is the
/// one with the largest y, as on a map; the lower left corner lies at (0, 0).
/// @throws std::logic_error for rows of different length and other characters.
inline OccupancyGrid drawnGrid(const std::vector<std::string>& rows, double resolution = 0.1) {
  GridGeometry geometry;
  geometry.width = rows.empty() ? 0 : static_cast<int>(rows.front().size());
  geometry.height = static_cast<int>(rows.size());
  geometry.resolution = resolution;
  OccupancyGrid grid(geometry);
  for (int y = 0; y < geometry.height; ++y) {
    const std::string& row = rows[static_cast<std::size_t>(geometry.height - 1 - y)];
    if (row.size() != rows.front().size()) throw std::logic_error("rows differ in length");
    for (int x = 0; x < geometry.width; ++x) {
      const char c = row[static_cast<std::size_t>(x)];
      if (c != '#' && c != '.' && c != '?' && c != ' ') {
        throw std::logic_error(std::string("no cell is drawn as '") + c + "'");
      }
      grid.at({x, y}) = c == '#'   ? OccupancyGrid::kOccupied
                        : c == '.' ? OccupancyGrid::kFree
                                   : OccupancyGrid::kUnknown;
    }
  }
  return grid;
}

/// A drawing whose characters stand for rectangles: column i of characters is `column_cells[i]`
/// cells wide, row i from above `row_cells[i]` cells high.
/// @throws std::logic_error as above, and unless there is one size per column and row.
inline OccupancyGrid drawnGrid(const std::vector<std::string>& rows, double resolution,
                               const std::vector<int>& column_cells,
                               const std::vector<int>& row_cells) {
  if (rows.empty() || row_cells.size() != rows.size() ||
      column_cells.size() != rows.front().size()) {
    throw std::logic_error("as many sizes as columns and rows are needed");
  }
  std::vector<std::string> cells;
  for (std::size_t y = 0; y < rows.size(); ++y) {
    if (rows[y].size() != column_cells.size()) throw std::logic_error("rows differ in length");
    std::string row;
    for (std::size_t x = 0; x < rows[y].size(); ++x) {
      row.append(static_cast<std::size_t>(column_cells[x]), rows[y][x]);
    }
    cells.insert(cells.end(), static_cast<std::size_t>(row_cells[y]), row);
  }
  return drawnGrid(cells, resolution);
}

/// The drawing of a grid: what drawnGrid() takes, with '?' for unknown cells; occupied from 50 on.
inline std::vector<std::string> drawingOf(const OccupancyGrid& grid) {
  std::vector<std::string> rows;
  for (int y = grid.geometry.height - 1; y >= 0; --y) {
    std::string row;
    for (int x = 0; x < grid.geometry.width; ++x) {
      const int value = grid.at({x, y});
      row += value < 0 ? '?' : value >= 50 ? '#' : '.';
    }
    rows.push_back(row);
  }
  return rows;
}

}  // namespace hyselam::testing
