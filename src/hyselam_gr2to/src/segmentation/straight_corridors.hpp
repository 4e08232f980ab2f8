// Straight corridors: strips of free space between two parallel lines along which walls carry on,
// found before any border is judged. Wide-open fronts, doors and fans of rays interrupt the walls
// of a corridor here and there, but not its two lines.
#pragma once

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <utility>
#include <vector>

#include "free_space.hpp"

namespace hyselam_topo {

/// Asked of every cell of a map, so that its direction is not found anew each time.
struct StraightCorridor {
  StraightCorridor(cv::Point2d from, cv::Point2d to, double half_width, double odds);

  cv::Point2d start, end;  ///< of its axis [cells of FreeSpace::free]
  double half_width;       ///< [cells]
  double odds;             ///< log-odds that walls carry on along both lines, > 0

  /// Whether the middle of a cell lies in it.
  bool contains(cv::Point2d cell) const { return beyond(cell) == 0.0; }
  /// How far a cell between the two lines lies beyond the ends [cells]; -1: not between the lines.
  double beyond(cv::Point2d cell) const {
    if (std::abs(along_.cross(cell - start)) > half_width) return -1.0;
    const double t = along_.dot(cell - start);
    return std::max({-t, t - length_, 0.0});
  }
  /// The columns of a row, none below 0 or from `width` on, outside of which no cell lies between
  /// the lines and up to `beyond` the ends: first, and one behind the last.
  std::pair<int, int> columns(int row, double beyond, int width) const;
  /// How far a cell between the two ends lies out of the side [cells], 0 within; -1: beyond an end.
  double aside(cv::Point2d cell) const {
    const double t = along_.dot(cell - start);
    if (t < 0.0 || t > length_) return -1.0;
    return std::max(0.0, std::abs(along_.cross(cell - start)) - half_width);
  }
  /// Whether it lies between the two ends, however far to the side.
  bool beside(cv::Point2d cell) const { return aside(cell) >= 0.0; }

 private:
  double length_;
  cv::Point2d along_;  // of length 1
};

/// The surest first; of the same direction, none covers much of another. `furniture`: CV_8U, what
/// is no wall. None on a map whose diagonal has 32000 cells or more.
std::vector<StraightCorridor> findStraightCorridors(const FreeSpace& space,
                                                    const cv::Mat& furniture);

}  // namespace hyselam_topo
