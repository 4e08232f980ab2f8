// First step of the segmentation: the free space of a grid map as people see it, at a resolution
// that the later steps are made for. Clutter is seen through, leaks are cut off.
#pragma once

#include <cstddef>
#include <opencv2/core.hpp>
#include <vector>

#include "cell_runs.hpp"
#include "hyselam_common/occupancy_grid.hpp"
#include "hyselam_gr2to/segmentation/place_segmentation.hpp"

namespace hyselam_topo {

struct SolidPiece {
  cv::Rect box;
  int cells = 0;
  std::size_t begin = 0, end = 0;
};

struct FreeSpace {
  cv::Mat free;      ///< CV_8U, 255 free, 0 not; the outermost cells are never free
  cv::Mat occupied;  ///< CV_8U, 255 where an obstacle was seen; not all else is free
  cv::Mat closed;    ///< CV_8U, 255 where fans of rays were closed; empty: none were looked for
  double resolution = 0.0;  ///< [m/cell]
  int joined = 1;           ///< so many cells of the grid, along each axis, make one cell
  double resampled = 1.0;   ///< ... of which each then became so many, along each axis; at least 1
  cv::Point origin;         ///< joined cell whose corner is that of (0, 0) of `free`
  /// The connected pieces that were not free before clutter was seen through, and their cells: of
  /// a piece those from `begin` to before `end`.
  std::vector<SolidPiece> pieces;
  std::vector<CellRun> solid;
};

/// Empty `free` if the grid has no free cell. `without_ray_fans`: they are closed.
FreeSpace findFreeSpace(const hyselam::OccupancyGrid& grid, const SegmentationParams& params,
                        bool without_ray_fans);

/// Labels of working cells, brought to the grid's cells. Those that are free without a label get
/// that of the nearest labelled one on a way of at most `reach` free cells, none of a closed fan.
cv::Mat toGrid(const cv::Mat& labels, const FreeSpace& space, const hyselam::OccupancyGrid& grid,
               int free_max, int reach);

}  // namespace hyselam_topo
