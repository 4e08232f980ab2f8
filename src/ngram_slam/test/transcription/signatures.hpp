// Plain transcriptions of what the signatures compute, to compare the fast code with.
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "ngram_slam/signatures/place_recognizer.hpp"
#include "ngram_slam/signatures/place_signature.hpp"

namespace transcription {

/// Counts of a cell by its number along both axes, however far.
using Counts = std::map<std::pair<int, int>, std::pair<int, int>>;  // free, hits

/// A beam, cell by cell: one along the axis that it follows most.
inline void traceBeam(const hyselam::Pose2& laser, double bearing, double range, bool is_return,
                      double resolution, Counts* counts) {
  const double dx = std::cos(laser.theta + bearing), dy = std::sin(laser.theta + bearing);
  const double most = std::max(std::abs(dx), std::abs(dy));
  const auto cellAt = [&](double x, double y) {
    return std::make_pair(static_cast<int>(std::floor(x)), static_cast<int>(std::floor(y)));
  };
  const double x0 = laser.x / resolution, y0 = laser.y / resolution, length = range / resolution;
  const auto end = cellAt(x0 + length * dx, y0 + length * dy);
  for (int i = 0; i < static_cast<int>(length * most); ++i) {
    const auto cell = cellAt(x0 + i * dx / most, y0 + i * dy / most);
    if (is_return && cell == end) break;
    ++(*counts)[cell].first;
  }
  if (is_return) ++(*counts)[end].second;
}

/// Magnitude of the n-th wave of a spectrum.
inline double waveOf(const std::vector<double>& values, std::size_t n) {
  std::complex<double> sum;
  for (std::size_t i = 0; i < values.size(); ++i) {
    sum += std::polar(values[i], -2.0 * hyselam::kPi * static_cast<double>(i * n) /
                                     static_cast<double>(values.size()));
  }
  return std::abs(sum) / static_cast<double>(values.size());
}

inline std::vector<double> featuresOf(const ngram_slam::PlaceFeatures& f) {
  using ngram_slam::PlaceFeatures;
  std::vector<double> out(f.densities.begin(), f.densities.end());
  std::vector<double> logs;
  for (const float d : f.distances) logs.push_back(std::log(0.5 + static_cast<double>(d)));
  for (std::size_t n = 0; n < ngram_slam::SignatureFeatures::kDistanceWaves; ++n) {
    out.push_back(waveOf(logs, n));
  }
  for (std::size_t n = 0; n < ngram_slam::SignatureFeatures::kContextWaves; ++n) {
    for (std::size_t r = 0; r < PlaceFeatures::kRings; ++r) {
      std::vector<double> ring;
      for (std::size_t s = 0; s < PlaceFeatures::kSectors; ++s) {
        ring.push_back(std::sqrt(static_cast<double>(f.context[s][r])));
      }
      out.push_back(std::sqrt(waveOf(ring, n) + 1e-4));
    }
  }
  return out;
}

/// Log of N([x, y]; 0, [[t, t - 1], [t - 1, t]]) / (N(x; 0, t) N(y; 0, t)), summed over the values:
/// both of one place, whose visits vary by 1, or of two.
inline double logRatio(const ngram_slam::SignatureModel& model, const ngram_slam::PlaceSignature& a,
                       const ngram_slam::PlaceSignature& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.values.size(); ++i) {
    const double step = static_cast<double>(model.steps()[i]);
    const double t = static_cast<double>(model.variances()[i]), s = t - 1.0;
    const double x = step * a.values[i], y = step * b.values[i];
    const double determinant = t * t - s * s;
    const double together = -0.5 * std::log(determinant) -
                            0.5 * (t * x * x - 2.0 * s * x * y + t * y * y) / determinant;
    const double alone = -std::log(t) - 0.5 * (x * x + y * y) / t;
    sum += together - alone;
  }
  return sum;
}

/// The likeliest n-gram through two places: on each side of them as many places of the way as make
/// the sum greatest.
/// `ratio(d)`: log of the ratio of likelihoods of the places at a distance of d, nothing beyond a
/// run.
inline double chainScore(const std::function<std::optional<double>(int)>& ratio, int before,
                         int after, double decay) {
  const auto side = [&](int step, int length) {
    // The best of all lengths.
    double best = 0.0;
    for (int n = 1; n <= length; ++n) {
      double sum = 0.0, weight = 1.0;
      bool whole = true;
      for (int d = 1; d <= n; ++d) {
        const auto r = ratio(step * d);
        whole = whole && r;
        if (!whole) break;
        weight *= decay;
        sum += weight * *r;
      }
      if (whole) best = std::max(best, sum);
    }
    return best;
  };
  return ratio(0).value_or(0.0) + side(-1, before) + side(1, after);
}

}  // namespace transcription
