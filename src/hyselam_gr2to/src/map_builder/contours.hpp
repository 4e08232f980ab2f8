// The closed lines around labelled regions, side of a cell by side of a cell.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace hyselam_topo {

/// A side of a cell, walked with the region on the left. `from` is a corner of cells: (x, y) is the
/// lower left corner of cell (x, y). Direction 0 is +x, then counter-clockwise.
struct ContourSide {
  cv::Point from;
  int direction = 0;

  cv::Point to() const;
  cv::Point outside() const;  ///< the cell on the right
  cv::Point2d middle() const;
};

struct Contour {
  std::uint16_t label = 0;
  std::vector<ContourSide>
      sides;  ///< around the region: counter-clockwise; around a hole: clockwise
  bool hole = false;
};

/// All contours of a label image (CV_16U); a region's cells touch along sides, not corners.
std::vector<Contour> traceContours(const cv::Mat& labels);

/// Those of the wanted labels (by label; empty: all), whose cells all lie in the box.
std::vector<Contour> traceContours(const cv::Mat& labels, const cv::Rect& box,
                                   const std::vector<char>& wanted);

}  // namespace hyselam_topo
