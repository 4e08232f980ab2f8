#include "hyselam_common/robot_log.hpp"

#include <algorithm>

namespace hyselam {

Pose2 interpolate(const Pose2& a, const Pose2& b, double fraction) {
  return {a.x + fraction * (b.x - a.x), a.y + fraction * (b.y - a.y),
          normalizeAngle(a.theta + fraction * normalizeAngle(b.theta - a.theta))};
}

std::optional<Pose2> poseAt(const std::vector<StampedPose2>& trajectory, double stamp,
                            double tolerance) {
  if (trajectory.empty() || !std::isfinite(stamp)) return std::nullopt;
  const auto after = std::lower_bound(trajectory.begin(), trajectory.end(), stamp,
                                      [](const StampedPose2& p, double s) { return p.stamp < s; });
  if (after == trajectory.end()) {
    if (stamp - trajectory.back().stamp > tolerance) return std::nullopt;
    return trajectory.back().pose;
  }
  if (after->stamp == stamp) return after->pose;
  if (after == trajectory.begin()) {
    if (after->stamp - stamp > tolerance) return std::nullopt;
    return after->pose;
  }
  const StampedPose2& a = *(after - 1);
  return interpolate(a.pose, after->pose, (stamp - a.stamp) / (after->stamp - a.stamp));
}

std::optional<TimeSpan> timeSpan(const RobotLog& log) {
  std::optional<TimeSpan> span;
  const auto include = [&](double first, double last) {
    if (!span) {
      span = TimeSpan{first, last};
    } else {
      span->begin = std::min(span->begin, first);
      span->end = std::max(span->end, last);
    }
  };
  if (!log.scans.empty()) include(log.scans.front().stamp, log.scans.back().stamp);
  if (!log.odometry.empty()) include(log.odometry.front().stamp, log.odometry.back().stamp);
  if (!log.ground_truth.empty()) {
    include(log.ground_truth.front().stamp, log.ground_truth.back().stamp);
  }
  return span;
}

}  // namespace hyselam
