// How well a laser scan fits a grid map at a pose.
#pragma once

#include <vector>

#include "hyselam_common/laser_scan.hpp"
#include "hyselam_common/occupancy_grid.hpp"
#include "hyselam_common/pose2.hpp"

namespace selovis {

/// The returns of a scan, thinned.
using ScanPoints = std::vector<hyselam::Point2>;  // in the frame of the base [m]

/// At most `most` returns, at even distances of beams. Beams without a return say nothing.
ScanPoints scanPoints(const hyselam::LaserScan& scan, std::size_t most = 60);

struct FittedPose {
  hyselam::Pose2 base;  ///< in the map
  double fit = 0.0;     ///< ScanFit::at() there
};

/// Log-likelihood of returns in the likelihood field of a grid map (Thrun et al. 2005, 6.4): each
/// return is an obstacle of the map, with the standard deviation `kSigma`, or anything.
class ScanFit {
 public:
  static constexpr double kSigma = 0.15;    ///< [m]
  static constexpr double kAnything = 0.1;  ///< share of returns that the map does not explain
  /// Cells from this value on are obstacles.
  static constexpr int kOccupiedFrom = 65;

  /// @throws hyselam::InputError for a grid whose cell count does not fit its size.
  explicit ScanFit(const hyselam::OccupancyGrid& map);

  /// Mean log-likelihood of the returns, against that of a return exactly at an obstacle: 0 for a
  /// perfect fit, log(kAnything) where nothing fits or there is no return.
  double at(const ScanPoints& points, const hyselam::Pose2& base) const;

  /// The best fit within `reach` [m] (along x and along y) and `turn` [rad] of a pose: a search on
  /// a lattice of 0.25 m and 5 degrees with every second return, refined to 2 cm and 0.4 degrees.
  FittedPose best(const ScanPoints& points, const hyselam::Pose2& around, double reach,
                  double turn) const;

 private:
  hyselam::GridGeometry geometry_;
  std::vector<float> values_;  // of a return in each cell
};

}  // namespace selovis
