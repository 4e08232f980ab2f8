// First step of the segmentation: the free space of a grid map as people see it, at a resolution
// that the later steps are made for. Clutter is seen through, leaks are cut off.
#pragma once

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "hyselam_common/occupancy_grid.hpp"
#include "hyselam_topo/segmentation.hpp"

namespace hyselam_topo {

struct FreeSpace {
  cv::Mat free;             ///< CV_8U, 255 free, 0 not; the outermost cells are never free
  double resolution = 0.0;  ///< [m/cell]
  int joined = 1;           ///< so many cells of the grid, along each axis, make one cell
  int split = 1;            ///< ... or one cell of the grid makes so many; one of the two is 1
  cv::Point origin;  ///< working cell at (0, 0) of `free`; grid cell (0, 0) starts cell (0, 0)
  /// CV_32S, the connected pieces that were not free before clutter was seen through, from 1, and
  /// the statistics of cv::connectedComponentsWithStats() about them.
  cv::Mat pieces;
  cv::Mat boxes;

  cv::Rect boxOf(int piece) const {
    const int* row = boxes.ptr<int>(piece);
    return {row[cv::CC_STAT_LEFT], row[cv::CC_STAT_TOP], row[cv::CC_STAT_WIDTH],
            row[cv::CC_STAT_HEIGHT]};
  }
};

/// Empty `free` if the grid has no free cell.
FreeSpace findFreeSpace(const hyselam::OccupancyGrid& grid, const SegmentationParams& params);

/// Labels of working cells, brought to the grid's cells. Those that are free without a label get
/// that of the nearest labelled one on a way through free cells of at most `reach` cells.
cv::Mat toGrid(const cv::Mat& labels, const FreeSpace& space, const hyselam::OccupancyGrid& grid,
               int free_max, int reach);

}  // namespace hyselam_topo
