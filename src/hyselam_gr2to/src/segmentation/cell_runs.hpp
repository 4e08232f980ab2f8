// Connected pieces of an image as runs along its rows: cheaper than an image of pieces where most
// cells lie in few of them.
#pragma once

#include <cstddef>
#include <opencv2/core.hpp>
#include <vector>

namespace hyselam_topo {

struct CellRun {
  int y;
  int first, last;  ///< columns, both in it
  int value;        ///< of its cells
  int piece;        ///< 0 .. pieces - 1
};

struct CellRuns {
  std::vector<CellRun> runs;      ///< by y, then by first
  std::vector<std::size_t> rows;  ///< where each row's runs begin, and the end of the last
  int pieces = 0;                 ///< numbered in the order of their first cells
};

/// The runs of equal cells (CV_8U or CV_16U) but for those of the value `none`. Runs of the same
/// value are one piece where they touch, with `corners` also at a corner.
CellRuns connectedRuns(const cv::Mat& cells, int none, bool corners);

}  // namespace hyselam_topo
