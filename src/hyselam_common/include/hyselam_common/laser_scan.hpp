// One planar laser scan as a plain value.
#pragma once

#include <vector>

#include "hyselam_common/pose2.hpp"

namespace hyselam {

/// Beam i has bearing angle_min + i * angle_increment in the laser frame, counter-clockwise.
///
/// A range is a return when range_min <= r < range_max; at or above range_max, or +inf, it is "no
/// return: free as far as the sensor sees"; NaN, -inf and anything below range_min is invalid.
struct LaserScan {
  double stamp = 0.0;            ///< time of the scan [s]
  double angle_min = 0.0;        ///< bearing of beam 0 [rad]
  double angle_increment = 0.0;  ///< between beams [rad]; negative for a sensor mounted upside down
  double range_min = 0.0;        ///< [m]
  double range_max = 0.0;        ///< [m]
  std::vector<float> ranges;     ///< [m]
  Pose2 laser_in_base;           ///< where the laser sits on the robot
};

}  // namespace hyselam
