// Random grids and scans that look like buildings and lasers, for properties and benches.
#pragma once

#include <algorithm>
#include <random>

#include "fsd_localization/density/bit_plane.hpp"
#include "hyselam_common/laser_scan.hpp"
#include "transcription/free_space.hpp"

namespace random_worlds {

/// Rooms: walls along random lines with door gaps, some clutter, some unknown patches.
inline transcription::Cells rooms(std::mt19937_64& rng, int width, int height) {
  const auto upTo = [&rng](int n) { return static_cast<int>(rng() % static_cast<unsigned>(n)); };
  transcription::Cells m;
  m.width = width;
  m.height = height;
  m.state.assign(static_cast<std::size_t>(width * height), transcription::Cells::kFree);
  const auto put = [&m](int x, int y, transcription::Cells::State s) {
    if (transcription::inside(m, x, y)) m.state[static_cast<std::size_t>(y * m.width + x)] = s;
  };
  const int walls = 2 + upTo(8);
  for (int i = 0; i < walls; ++i) {
    const bool across = upTo(2) == 0;
    const int at = upTo(across ? height : width), gap = upTo(across ? width : height);
    for (int k = 0; k < (across ? width : height); ++k) {
      if (std::abs(k - gap) > 4) {
        across ? put(k, at, transcription::Cells::kOccupied)
               : put(at, k, transcription::Cells::kOccupied);
      }
    }
  }
  const int clutter = upTo(width * height / 40 + 1);
  for (int i = 0; i < clutter; ++i) put(upTo(width), upTo(height), transcription::Cells::kOccupied);
  const int patches = upTo(4);
  for (int i = 0; i < patches; ++i) {
    const int x0 = upTo(width), y0 = upTo(height), w = 1 + upTo(12), h = 1 + upTo(12);
    for (int y = y0; y < y0 + h; ++y) {
      for (int x = x0; x < x0 + w; ++x) put(x, y, transcription::Cells::kUnknown);
    }
  }
  return m;
}

inline fsd_localization::FreeSpaceGrid toFreeSpace(const transcription::Cells& m) {
  fsd_localization::FreeSpaceGrid s(m.width, m.height);
  for (int y = 0; y < m.height; ++y) {
    for (int x = 0; x < m.width; ++x) {
      s.free.set(x, y, m.at(x, y) == transcription::Cells::kFree);
      s.unknown.set(x, y, m.at(x, y) == transcription::Cells::kUnknown);
    }
  }
  return s;
}

/// Beams over some field of view with returns, no-returns, NaN and too short ranges among them.
inline hyselam::LaserScan scan(std::mt19937_64& rng, int beams, double field_of_view,
                               double reach) {
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  hyselam::LaserScan s;
  s.angle_increment = field_of_view / (beams - 1);
  s.angle_min = -0.5 * field_of_view + 0.3 * (unit(rng) - 0.5);
  s.range_min = 0.05;
  s.range_max = 1.5 * reach;
  double r = reach * unit(rng);
  for (int i = 0; i < beams; ++i) {
    if (unit(rng) < 0.1) r = reach * 1.3 * unit(rng);
    double value = std::max(0.0, r + 0.02 * (unit(rng) - 0.5));
    const double kind = unit(rng);
    if (kind < 0.02) {
      value = std::numeric_limits<double>::quiet_NaN();
    } else if (kind < 0.04) {
      value = std::numeric_limits<double>::infinity();
    } else if (kind < 0.05) {
      value = 0.01;
    }
    s.ranges.push_back(static_cast<float>(value));
  }
  return s;
}

}  // namespace random_worlds
