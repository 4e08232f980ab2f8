// A recorded run scan by scan, with what is true.
#pragma once

#include <vector>

#include "hyselam_common/robot_log.hpp"

namespace fsd_localization {

struct LogMoment {
  const hyselam::LaserScan* scan;  ///< of the log, which has to live as long
  hyselam::Pose2 odometry, truth;
  double way;  ///< from the first moment on, along the true poses [m]
};

/// Those scans of which odometry and true pose are known.
std::vector<LogMoment> momentsOf(const hyselam::RobotLog& log,
                                 const std::vector<hyselam::StampedPose2>& truth);

}  // namespace fsd_localization
