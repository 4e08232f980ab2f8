// First stage of the thesis' pipeline (section 4.2): a grid map without isolated cells, and its
// obstacles.
#include <algorithm>

#include "hyselam_gr2to/thesis/thesis.hpp"

namespace hyselam_topo {

using hyselam::OccupancyGrid;

OccupancyGrid filterIsolatedCells(const OccupancyGrid& grid, int free_max, int occupied_min) {
  OccupancyGrid out = grid;
  const auto isFree = [&](int v) { return v >= 0 && v <= free_max; };
  for (int y = 0; y < grid.geometry.height; ++y) {
    for (int x = 0; x < grid.geometry.width; ++x) {
      const int own = grid.at({x, y});
      const bool occupied = own >= occupied_min;
      if (!occupied && !isFree(own)) continue;
      int same = 0, open = 0, known = 0;
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
          if (dx == 0 && dy == 0) continue;
          const int v = grid.valueOr({x + dx, y + dy});
          same += (occupied ? v >= occupied_min : isFree(v)) ? 1 : 0;
          open += isFree(v) ? 1 : 0;
          known += v >= 0 ? 1 : 0;
        }
      }
      if (same > 0) continue;
      out.at({x, y}) =
          occupied && known > 0 && open == known ? OccupancyGrid::kFree : OccupancyGrid::kUnknown;
    }
  }
  return out;
}

cv::Mat obstaclesOf(const OccupancyGrid& grid, int free_max, int occupied_min,
                    bool unknown_blocks) {
  cv::Mat out(grid.geometry.height, grid.geometry.width, CV_8UC1);
  std::transform(grid.cells.begin(), grid.cells.end(), out.ptr<std::uint8_t>(0),
                 [&](std::int8_t v) -> std::uint8_t {
                   const bool obstacle = unknown_blocks ? v < 0 || v > free_max : v >= occupied_min;
                   return obstacle ? 255 : 0;
                 });
  return out;
}

}  // namespace hyselam_topo
