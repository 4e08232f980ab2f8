#include "log_moments.hpp"

namespace fsd_localization {

std::vector<LogMoment> momentsOf(const hyselam::RobotLog& log,
                                 const std::vector<hyselam::StampedPose2>& truth) {
  std::vector<LogMoment> all;
  for (const hyselam::LaserScan& scan : log.scans) {
    const auto odom = hyselam::poseAt(log.odometry, scan.stamp, 0.2);
    const auto at = hyselam::poseAt(truth, scan.stamp, 0.05);
    if (!odom || !at) continue;
    const double way =
        all.empty() ? 0.0 : all.back().way + hyselam::distance(all.back().truth, *at);
    all.push_back({&scan, *odom, *at, way});
  }
  return all;
}

}  // namespace fsd_localization
