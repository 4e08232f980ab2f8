// Second step of the segmentation: the basins of the distance map. Every place is made of whole
// basins; which ones belong together is decided later.
#pragma once

#include <opencv2/core.hpp>

namespace hyselam_topo {

struct BasinParams {
  /// Two basins are one if from the smaller peak to the saddle between them the clearance falls by
  /// less than this [m] ...
  double shallow = 0.05;
  /// ... or to more than this share of it.
  double level = 0.93;
  double smallest = 0.0;  ///< connected parts smaller than this are no free space [m^2]
};

struct Basins {
  cv::Mat labels;  ///< CV_32S, 0 not free, 1 .. count in the order of their first cell
  int count = 0;
};

/// Cells from where the steepest way up leads to the same peak of `clearance` (CV_32F [cells], 0
/// exactly where not free, which the outermost cells are), low saddles between them done away with.
/// Sets the clearance of parts that are too small to 0.
Basins findBasins(cv::Mat& clearance, double resolution, const BasinParams& params = {});

}  // namespace hyselam_topo
