// Error of SLAM with respect to reference poses.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "hyselam_common/pose2.hpp"
#include "ngram_slam/slam/slam_types.hpp"

namespace ngram_slam {

struct TrajectoryError {
  std::size_t poses = 0;                    ///< compared
  double mean = 0.0, rms = 0.0, max = 0.0;  ///< of the positions, after the best rigid motion [m]
  double mean_angle = 0.0;                  ///< of the headings [rad]
  /// Mean errors of the relative motion over one meter of path.
  double mean_step = 0.0, mean_step_angle = 0.0;  ///< [m], [rad]
};

/// Compares each pose with the reference at its time; poses without one in 0.5 s are left out.
TrajectoryError trajectoryError(const std::vector<hyselam::StampedPose2>& trajectory,
                                const std::vector<hyselam::StampedPose2>& reference);

/// Error of a measurement between keyframes with respect to the reference.
struct LoopError {
  double distance = 0.0;  ///< [m]
  double angle = 0.0;     ///< [rad], >= 0
  /// More than a meter or 20 degrees off: another place.
  bool isFalse() const { return distance > 1.0 || angle > hyselam::radians(20.0); }
};
/// Nothing where the reference has no pose within 0.5 s of both.
std::optional<LoopError> loopError(const SlamKeyframe& older, const SlamKeyframe& newer,
                                   const hyselam::Pose2& measured,
                                   const std::vector<hyselam::StampedPose2>& reference);

}  // namespace ngram_slam
