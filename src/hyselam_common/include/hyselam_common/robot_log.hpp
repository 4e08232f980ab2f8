// What a robot recorded: scans, odometry and, if known, where it really was.
#pragma once

#include <optional>
#include <vector>

#include "hyselam_common/laser_scan.hpp"
#include "hyselam_common/pose2.hpp"

namespace hyselam {

/// Each list is ordered by time, [s] on one clock.
struct RobotLog {
  std::vector<LaserScan> scans;
  std::vector<StampedPose2> odometry;      ///< base in odom
  std::vector<StampedPose2> ground_truth;  ///< base in map; empty if unknown
};

/// The pose of the motion from `a` to `b` at `fraction` (0: a, 1: b): positions linearly, the angle
/// on the shorter way.
Pose2 interpolate(const Pose2& a, const Pose2& b, double fraction);

/// The pose at `stamp`, interpolated between its neighbours. Outside the covered time the first or
/// last pose holds for up to `tolerance` [s]; beyond that, and for an empty trajectory, there is
/// none.
std::optional<Pose2> poseAt(const std::vector<StampedPose2>& trajectory, double stamp,
                            double tolerance = 0.0);

/// First and last stamp of everything in the log; nothing for an empty log.
struct TimeSpan {
  double begin = 0.0;  ///< [s]
  double end = 0.0;    ///< [s]
};
std::optional<TimeSpan> timeSpan(const RobotLog& log);

}  // namespace hyselam
