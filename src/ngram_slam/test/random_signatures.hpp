// Scans, poses and signatures drawn at random, for tests of signatures.
#pragma once

#include <algorithm>
#include <cmath>

#include "hyselam_common/laser_scan.hpp"
#include "hyselam_common/rng.hpp"
#include "ngram_slam/signatures/place_signature.hpp"

namespace ngram_slam {

inline hyselam::LaserScan randomScan(hyselam::Rng& rng) {
  hyselam::LaserScan scan;
  scan.angle_min = -hyselam::kPi / 2;
  scan.angle_increment = hyselam::radians(2.0);
  scan.range_min = 0.05;
  scan.range_max = 30.0;
  scan.laser_in_base = {0.1, 0.0, 0.0};
  for (int i = 0; i < 91; ++i) scan.ranges.push_back(static_cast<float>(rng.uniform(0.0, 32.0)));
  return scan;
}

inline hyselam::Pose2 randomPose(hyselam::Rng& rng, double side) {
  return {rng.uniform(-side, side), rng.uniform(-side, side), rng.uniform(-3.0, 3.0)};
}

/// Bytes that vary as much among places as they are taken to.
inline PlaceSignature randomSignature(hyselam::Rng& rng) {
  PlaceSignature s;
  for (auto& v : s.values) {
    v = static_cast<std::int8_t>(std::clamp(rng.gaussian(0.0, 127.0 / 4.0), -127.0, 127.0));
  }
  return s;
}

/// Another visit.
inline PlaceSignature visited(const PlaceSignature& place, const SignatureModel& model,
                              hyselam::Rng& rng) {
  PlaceSignature s;
  for (std::size_t i = 0; i < s.values.size(); ++i) {
    const double value = place.values[i] + rng.gaussian() / static_cast<double>(model.steps()[i]);
    s.values[i] = static_cast<std::int8_t>(std::lround(std::clamp(value, -127.0, 127.0)));
  }
  return s;
}

}  // namespace ngram_slam
