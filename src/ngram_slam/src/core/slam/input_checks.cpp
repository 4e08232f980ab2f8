#include "ngram_slam/slam/input_checks.hpp"

#include <algorithm>
#include <cmath>

namespace ngram_slam {

namespace {

constexpr double kMaxCoordinate = 0.99e7;  // [m] cells beyond 10^7 m have no number in local maps
constexpr double kMaxLaserOffset = 5.0;    // [m] it must lie on the local map of the words' sensor

}  // namespace

const char* scanError(const hyselam::LaserScan& scan) {
  if (!std::isfinite(scan.angle_min) || !std::isfinite(scan.angle_increment) ||
      !std::isfinite(scan.range_min) || std::isnan(scan.range_max) ||
      !scan.laser_in_base.isFinite()) {
    return "its geometry is not finite";
  }
  if (std::hypot(scan.laser_in_base.x, scan.laser_in_base.y) > kMaxLaserOffset) {
    return "the laser is more than 5 m from the base";
  }
  if (!scan.ranges.empty() && scan.angle_increment == 0.0) {
    return "all beams have one bearing: angle_increment is 0";
  }
  return nullptr;
}

const char* poseError(const hyselam::Pose2& pose) {
  if (!pose.isFinite()) return "is not finite";
  if (std::max(std::abs(pose.x), std::abs(pose.y)) > kMaxCoordinate) {
    return "is more than 10000 km from its origin";
  }
  return nullptr;
}

}  // namespace ngram_slam
