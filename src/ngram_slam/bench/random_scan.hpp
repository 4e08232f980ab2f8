#pragma once

#include <memory>

#include "hyselam_common/laser_scan.hpp"
#include "hyselam_common/pose2.hpp"
#include "hyselam_common/rng.hpp"

namespace ngram_slam {

/// 181 beams over the half circle ahead.
inline std::shared_ptr<const hyselam::LaserScan> randomIndoorScan(hyselam::Rng& rng) {
  hyselam::LaserScan scan;
  scan.angle_min = -hyselam::kPi / 2;
  scan.angle_increment = hyselam::radians(1.0);
  scan.range_min = 0.05;
  scan.range_max = 80.0;
  for (int i = 0; i < 181; ++i) scan.ranges.push_back(static_cast<float>(rng.uniform(1.0, 15.0)));
  return std::make_shared<const hyselam::LaserScan>(scan);
}

}  // namespace ngram_slam
