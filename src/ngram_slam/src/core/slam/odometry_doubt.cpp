#include "ngram_slam/slam/odometry_doubt.hpp"

#include <algorithm>
#include <cmath>

namespace ngram_slam {

using hyselam::LaserScan;
using hyselam::Range;

void OdometryDoubtParams::describe(hyselam::ParameterVisitor& visit) {
  visit("scan_interval", scan_interval, Range::atLeast(0.0), "s",
        "a scan this long after the last one matched is matched, however near odometry says it is; "
        "0: only where it moved, or the scan differs");
  visit("range_change", range_change, Range::above(0.0), "m",
        "ranges that differ by more have changed, if also by ...");
  visit("range_change_ratio", range_change_ratio, Range::atLeast(0.0), "m/m",
        "... more than this part of themselves");
  visit(
      "changed_ratio", changed_ratio, Range::between(0.0, 1.0), "",
      "a scan differs from the last one matched if more than this part of its ranges has changed");
  visit("max_speed", max_speed, Range::above(0.0), "m/s",
        "where odometry fails the robot may have moved so fast");
  visit("max_turn_rate", max_turn_rate, Range::above(0.0), "rad/s", "and turned so fast");
  visit("max_window", max_window, Range::above(0.0), "m",
        "a search for where it went is no wider, to each side");
  visit("failure_probability", failure_probability, Range::between(0.0, 0.5), "",
        "of a motion, that odometry fails; 0: it never does");
  visit("max_deviations", max_deviations, Range::above(0.0), "",
        "corrections of so many standard deviations make odometry doubtful");
  visit("patience", patience, Range::atLeast(0.0), "s",
        "later scans are awaited when one does not fit while odometry stands still; then the robot "
        "is lost");
  visit("gap", gap, Range::above(0.0), "s", "scans that are this long apart are a gap");
}

Eigen::Matrix3d OdometryDoubtParams::freeMotionInformation(double seconds) const {
  const double t = std::max(seconds, 1e-3);
  const double position = 1.0 / (max_speed * t), heading = 1.0 / (max_turn_rate * t);
  return Eigen::Vector3d(position * position, position * position, heading * heading).asDiagonal();
}

bool scansDiffer(const LaserScan& older, const LaserScan& newer,
                 const OdometryDoubtParams& params) {
  if (older.ranges.size() != newer.ranges.size() || older.angle_min != newer.angle_min ||
      older.angle_increment != newer.angle_increment) {
    return true;
  }
  const auto isReturn = [](const LaserScan& s, float r) {
    return static_cast<double>(r) >= s.range_min && static_cast<double>(r) < s.range_max;
  };
  std::size_t compared = 0, changed = 0;
  for (std::size_t i = 0; i < older.ranges.size(); ++i) {
    const float a = older.ranges[i], b = newer.ranges[i];
    if (!isReturn(older, a) || !isReturn(newer, b)) continue;
    ++compared;
    const auto far = static_cast<double>(std::max(a, b));
    if (std::abs(static_cast<double>(a - b)) >
        std::max(params.range_change, params.range_change_ratio * far)) {
      ++changed;
    }
  }
  return static_cast<double>(changed) > params.changed_ratio * static_cast<double>(compared);
}

}  // namespace ngram_slam
