// When odometry is not to be believed: wheels that stand in it while the robot moves, slip, scans
// that are missing.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "hyselam_common/laser_scan.hpp"
#include "hyselam_common/parameters.hpp"

namespace ngram_slam {

struct OdometryDoubtParams {
  /// A scan this long after the last one matched is matched, however near odometry says it is [s],
  /// >= 0; 0: only where the robot moved, or the scan differs.
  double scan_interval = 1.0;
  /// A range that differs by more than this, and this part of itself, has changed [m], > 0.
  double range_change = 0.1;
  double range_change_ratio = 0.02;  ///< >= 0
  /// A scan differs from the last one matched if more than this part of its ranges has, 0..1.
  double changed_ratio = 0.12;
  /// Where odometry fails the robot may have moved this fast [m/s] and turned this fast [rad/s],
  /// > 0.
  double max_speed = 1.0;
  double max_turn_rate = 1.0;
  double max_window = 3.0;  ///< a search for it is no wider, +- [m], > 0
  /// Of a motion, that odometry fails; 0: it never does, 0..0.5.
  double failure_probability = 1e-3;
  /// Corrections beyond this many standard deviations of odometry make it doubtful, > 0.
  double max_deviations = 4.0;
  /// A scan that does not fit while odometry stands still may show somebody in front of the laser:
  /// so long later ones are awaited, then the robot is lost [s], >= 0.
  double patience = 2.0;
  double gap = 2.0;  ///< scans that are this long apart are a gap [s], > 0

  void describe(hyselam::ParameterVisitor& visit);

  /// Inverse covariance of (x, y, theta) of what a robot may have done in `seconds` whatever its
  /// odometry says.
  Eigen::Matrix3d freeMotionInformation(double seconds) const;
};

/// Whether another scan from the same place would look like `newer`: the part of the beams with a
/// return in both whose ranges have changed is small. Scans of other geometry differ.
bool scansDiffer(const hyselam::LaserScan& older, const hyselam::LaserScan& newer,
                 const OdometryDoubtParams& params);

/// What a run went through, since the process began: not saved.
struct RoughRoad {
  std::uint64_t scans_moved_unseen = 0;  ///< scans that moved where odometry says that they did not
  double path_unseen = 0.0, turn_unseen = 0.0;  ///< by them [m], [rad]
  std::uint64_t odometry_overruled = 0;  ///< motions that the scans tell otherwise than odometry
  std::uint64_t wide_searches = 0;       ///< for scans that did not fit where odometry has them
  std::uint64_t gaps = 0;                ///< of OdometryDoubtParams::gap or more without a scan
  std::uint64_t steps_checked = 0;       ///< see StepCheckParams
  std::uint64_t steps_mended = 0;        ///< of them, those that the scans told otherwise
  std::uint64_t lost = 0;                ///< motions that neither odometry nor scans know ...
  std::uint64_t runs_split = 0;          ///< ... at which the run was split
};

}  // namespace ngram_slam
