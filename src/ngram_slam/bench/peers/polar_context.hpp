// A descriptor of the field for planar scans: what is seen in rings and sectors around the robot
// (Kim and Kim, "Scan Context: Egocentric Spatial Descriptor for Place Recognition within 3D Point
// Cloud Map", IROS 2018, with the count of returns for the height of buildings).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "hyselam_common/laser_scan.hpp"

namespace ngram_slam_peers {

struct PolarContext {
  static constexpr std::size_t kRings = 20, kSectors = 60;
  std::array<std::array<float, kRings>, kSectors> columns{};
  std::array<float, kSectors> norms{};

  void computeNorms() {
    for (std::size_t s = 0; s < kSectors; ++s) {
      float sum = 0.0F;
      for (const float v : columns[s]) sum += v * v;
      norms[s] = std::sqrt(sum);
    }
  }
};

/// What a scan hit, in the robot's frame [m].
inline std::vector<hyselam::Point2> returnsOf(const hyselam::LaserScan& scan) {
  std::vector<hyselam::Point2> points;
  for (std::size_t b = 0; b < scan.ranges.size(); ++b) {
    const double r = scan.ranges[b];
    if (!(r >= scan.range_min && r < scan.range_max)) continue;
    const double bearing = scan.angle_min + static_cast<double>(b) * scan.angle_increment;
    points.push_back(scan.laser_in_base *
                     hyselam::Point2{r * std::cos(bearing), r * std::sin(bearing)});
  }
  return points;
}

/// Of points around the robot, to `range` [m].
inline PolarContext contextOf(const std::vector<hyselam::Point2>& points, double range) {
  PolarContext context;
  for (const hyselam::Point2& p : points) {
    const double r = std::hypot(p.x, p.y);
    if (r >= range) continue;
    const double bearing = std::atan2(p.y, p.x) + hyselam::kPi;
    const auto sector =
        std::min(PolarContext::kSectors - 1,
                 static_cast<std::size_t>(bearing / (2 * hyselam::kPi) * PolarContext::kSectors));
    const auto ring = static_cast<std::size_t>(r / range * PolarContext::kRings);
    context.columns[sector][ring] += 1.0F;
  }
  context.computeNorms();
  return context;
}

/// 1 - mean cosine of the columns, least over all turns; 0: the same, 1: nothing in common.
inline double contextDistance(const PolarContext& a, const PolarContext& b) {
  constexpr std::size_t n = PolarContext::kSectors;
  double best = 1.0;
  for (std::size_t turn = 0; turn < n; ++turn) {
    float sum = 0.0F;
    std::size_t columns = 0;
    for (std::size_t s = 0; s < n; ++s) {
      const std::size_t t = s + turn < n ? s + turn : s + turn - n;
      if (a.norms[s] == 0.0F && b.norms[t] == 0.0F) continue;
      ++columns;  // one that only one of them has is a difference
      if (a.norms[s] == 0.0F || b.norms[t] == 0.0F) continue;
      float dot = 0.0F;
      for (std::size_t r = 0; r < PolarContext::kRings; ++r) {
        dot += a.columns[s][r] * b.columns[t][r];
      }
      sum += dot / (a.norms[s] * b.norms[t]);
    }
    if (columns > 0) {
      best = std::min(best, 1.0 - static_cast<double>(sum) / static_cast<double>(columns));
    }
  }
  return best;
}

}  // namespace ngram_slam_peers
