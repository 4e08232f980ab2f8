// A peer for evaluate_places: Scan Context (Kim and Kim, "Scan Context: Egocentric Spatial
// Descriptor for Place Recognition within 3D Point Cloud Map", IROS 2018), transcribed for planar
// scans: returns in rings and sectors, the count of which takes the place of the height.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "hyselam_common/laser_scan.hpp"
#include "ngram_slam/signatures/place_features.hpp"

namespace ngram_slam_peers {

struct PolarContext {
  static constexpr std::size_t kRings = ngram_slam::PlaceFeatures::kRings,
                               kSectors = ngram_slam::PlaceFeatures::kSectors;
  static constexpr double kRange = ngram_slam::PlaceFeatures::kRange;  ///< [m]
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

/// Of a single scan.
inline PolarContext contextOf(const hyselam::LaserScan& scan) {
  PolarContext context;
  for (std::size_t b = 0; b < scan.ranges.size(); ++b) {
    const double r = scan.ranges[b];
    if (!(r >= scan.range_min && r < scan.range_max && r < PolarContext::kRange)) continue;
    const double bearing = scan.angle_min + static_cast<double>(b) * scan.angle_increment;
    const double turn = 0.5 + hyselam::normalizeAngle(bearing) / (2.0 * hyselam::kPi);
    const auto sector = std::min(PolarContext::kSectors - 1,
                                 static_cast<std::size_t>(turn * PolarContext::kSectors));
    context.columns[sector][static_cast<std::size_t>(r / PolarContext::kRange *
                                                     PolarContext::kRings)] += 1.0F;
  }
  context.computeNorms();
  return context;
}

/// Of the submap around a place.
inline PolarContext contextOf(const ngram_slam::PlaceFeatures& features) {
  PolarContext context;
  for (std::size_t s = 0; s < PolarContext::kSectors; ++s) {
    for (std::size_t r = 0; r < PolarContext::kRings; ++r) {
      context.columns[s][r] = static_cast<float>(features.context[s][r]);
    }
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
