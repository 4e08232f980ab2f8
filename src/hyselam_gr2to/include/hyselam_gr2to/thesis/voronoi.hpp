// The Voronoi diagram of a grid map (dos Santos 2014, section 4.2, third stage; Lau, Sprunk,
// Burgard 2010): the cells that are equally far from two obstacles, as lines one cell wide. It
// follows a changing distance map where that has changed.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "hyselam_common/parameters.hpp"
#include "hyselam_gr2to/thesis/distance_map.hpp"

namespace hyselam_topo {

struct VoronoiParams {
  /// Bumps of a wall up to this depth make no branch [cells], >= 0.5. Two sites at distance d on
  /// one bumpy wall are at most sqrt(2 d noise + noise^2) apart; only sites farther apart than that
  /// have a border.
  double noise = 1.5;

  void describe(hyselam::ParameterVisitor& visit);
  void validate() const;  ///< @throws hyselam::ParameterError
};

class VoronoiDiagram {
 public:
  /// From scratch. @throws hyselam::ParameterError for a parameter out of range.
  explicit VoronoiDiagram(const DistanceMap& distances, const VoronoiParams& params = {});

  /// Follows `distances.update()`, which gave `changed`. The result is the same as from scratch.
  void update(const DistanceMap& distances, const std::vector<RowSpan>& changed);

  /// CV_8U, 255 on the diagram: lines one cell wide (up to crossings), 8-connected.
  const cv::Mat& lines() const { return lines_; }
  /// Before thinning: every cell on the nearer side of a border between two cells; lines are up to
  /// two cells wide, more where borders meet.
  const cv::Mat& borders() const { return borders_; }

 private:
  void thinTile(int tx, int ty);

  double noise_;
  cv::Mat borders_;
  cv::Mat lines_;
};

/// Whether two obstacles bound a passage: they are farther apart than bumps of one wall can be.
/// `squared`: squared distance [cells^2] of the farther of the two cells whose sites they are.
bool separateSites(hyselam::Cell a, hyselam::Cell b, std::int32_t squared, double noise);

}  // namespace hyselam_topo
