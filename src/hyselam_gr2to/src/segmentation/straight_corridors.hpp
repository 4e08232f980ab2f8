// Straight corridors: strips of free space between two parallel lines along which walls carry on,
// found before any border is judged. Wide-open fronts, doors and fans of rays interrupt the walls
// of a corridor here and there, but not its two lines.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "free_space.hpp"

namespace hyselam_topo {

struct StraightCorridor {
  cv::Point2d start, end;   ///< of its axis [cells of FreeSpace::free]
  double half_width = 0.0;  ///< [cells]
  double odds = 0.0;        ///< log-odds that walls carry on along both lines, > 0

  /// Whether the middle of a cell lies in it.
  bool contains(cv::Point2d cell) const;
  /// How far a cell between the two lines lies beyond the ends [cells]; -1: not between the lines.
  double beyond(cv::Point2d cell) const;
  /// How far a cell between the two ends lies out of the side [cells], 0 within; -1: beyond an end.
  double aside(cv::Point2d cell) const;
  /// Whether it lies between the two ends, however far to the side.
  bool beside(cv::Point2d cell) const { return aside(cell) >= 0.0; }
};

/// The surest first; of the same direction, none covers much of another. `furniture`: CV_8U, what
/// is no wall. None on a map whose diagonal has 32000 cells or more.
std::vector<StraightCorridor> findStraightCorridors(const FreeSpace& space,
                                                    const cv::Mat& furniture);

}  // namespace hyselam_topo
