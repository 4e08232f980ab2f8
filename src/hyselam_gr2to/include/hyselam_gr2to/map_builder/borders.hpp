// Where places touch: the lines between cells of different labels.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace hyselam_topo {

/// A connected line between two places. Points are corners of cells: (x, y) is the lower left
/// corner of cell (x, y).
struct Border {
  int a = 0;  ///< the labels on its sides, a < b
  int b = 0;
  cv::Point first;      ///< its two ends, the ones farthest apart if it has more; a closed line has
  cv::Point last;       ///< the two of its points that are farthest apart
  bool closed = false;  ///< it has no ends: one place surrounds the other
  std::vector<cv::Point> points;  ///< all corners on it, each once, sorted by y, then x
  int length = 0;                 ///< sides of cells on it
};

/// All borders of a label image (CV_16U, 0 no place), sorted by (a, b), then by their lowest point.
std::vector<Border> findBorders(const cv::Mat& labels);

}  // namespace hyselam_topo
