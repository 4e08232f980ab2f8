// What a laser sees in a grid map.
#pragma once

#include "fsd_localization/models/grid_ray_caster.hpp"
#include "hyselam_common/laser_scan.hpp"
#include "hyselam_common/pose2.hpp"

/// 181 beams over the half circle ahead; nothing is seen farther than `range_max` [m].
inline hyselam::LaserScan look(const fsd_localization::GridRayCaster& rays,
                               const hyselam::Pose2& at, double stamp, double range_max = 30.0) {
  hyselam::LaserScan s;
  s.stamp = stamp;
  s.angle_min = -hyselam::kPi / 2;
  s.angle_increment = hyselam::kPi / 180;
  s.range_max = range_max;
  for (int b = 0; b < 181; ++b) {
    s.ranges.push_back(static_cast<float>(
        rays.range(at.x, at.y, at.theta + s.angle_min + b * s.angle_increment, range_max)));
  }
  return s;
}
