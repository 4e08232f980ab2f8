// Straight lines and circles through points, and where to cut a chain of points into such pieces.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <vector>

namespace hyselam_topo {

/// A straight line in the least squares sense.
struct LineFit {
  cv::Point2d mean;
  cv::Point2d along;  ///< of length 1, in the order of the points
  double rms = 0.0;   ///< of the distances to the line
};

struct CircleFit {
  cv::Point2d centre;
  double radius = 0.0;
  double worst = 0.0;  ///< largest distance of a point from the circle
};

/// `count` >= 1 points from `first` on.
LineFit fitLine(const cv::Point2d* first, std::size_t count);

/// Nothing if the points lie on a line or are fewer than 5.
std::optional<CircleFit> fitCircle(const cv::Point2d* first, std::size_t count);

/// A piece of a chain: points first .. last - 1, and the arc they lie on, if any.
struct ChainPiece {
  std::size_t first = 0;
  std::size_t last = 0;
  std::optional<CircleFit> arc;
};

/// Cuts a chain of points into pieces that no point leaves by more than `tolerance` (Ramer,
/// Douglas, Peucker), then joins three or more that lie on one arc of at most `max_radius`. A
/// closed chain is first turned so that it begins at a corner: `points` changes.
std::vector<ChainPiece> cutChain(std::vector<cv::Point2d>& points, bool closed, double tolerance,
                                 double max_radius);

}  // namespace hyselam_topo
