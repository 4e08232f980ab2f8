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

/// A strip with an axis. It is asked of every cell of a map, so its direction is kept.
class StraightCorridor {
 public:
  /// `start` and `end` of its axis, which differ, and half its width [cells of FreeSpace::free];
  /// log-odds that walls carry on along both lines, > 0.
  StraightCorridor(cv::Point2d start, cv::Point2d end, double half_width, double odds)
      : start_(start),
        end_(end),
        half_width_(half_width),
        odds_(odds),
        length_(cv::norm(end - start)),
        along_((end - start) / length_) {}

  cv::Point2d start() const { return start_; }
  cv::Point2d end() const { return end_; }
  double halfWidth() const { return half_width_; }
  double odds() const { return odds_; }

  /// Whether the middle of a cell lies in it.
  bool contains(cv::Point2d cell) const { return beyond(cell) == 0.0; }
  /// How far a cell between the two lines lies beyond the ends [cells]; -1: not between the lines.
  double beyond(cv::Point2d cell) const {
    if (std::abs(along_.cross(cell - start_)) > half_width_) return -1.0;
    const double t = along_.dot(cell - start_);
    return std::max({-t, t - length_, 0.0});
  }
  /// The columns of a row, none below 0 or from `width` on, outside of which no cell lies between
  /// the lines and up to `beyond` the ends: first, and one behind the last.
  std::pair<int, int> columns(int row, double beyond, int width) const;
  /// How far a cell between the two ends lies out of the side [cells], 0 within; -1: beyond an end.
  double aside(cv::Point2d cell) const {
    const double t = along_.dot(cell - start_);
    if (t < 0.0 || t > length_) return -1.0;
    return std::max(0.0, std::abs(along_.cross(cell - start_)) - half_width_);
  }
  /// Whether it lies between the two ends, however far to the side.
  bool beside(cv::Point2d cell) const { return aside(cell) >= 0.0; }

 private:
  cv::Point2d start_, end_;
  double half_width_, odds_, length_;
  cv::Point2d along_;  // of length 1
};

/// The surest first; of the same direction, none covers much of another. `furniture`: CV_8U, what
/// is no wall. None on a map whose diagonal has 32000 cells or more.
std::vector<StraightCorridor> findStraightCorridors(const FreeSpace& space,
                                                    const cv::Mat& furniture);

}  // namespace hyselam_topo
