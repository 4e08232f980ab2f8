#include "ngram_slam/slam/segment_context.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace ngram_slam {

namespace {

using hyselam_scan_matching::SurfacePoint;
using hyselam_scan_matching::SurfacePoints;

constexpr std::size_t kSectors = 60, kRings = 20;
constexpr double kRange = 20.0;    // [m]
constexpr std::size_t kApart = 5;  // sectors between two turns that are told
using Context = std::array<std::array<float, kRings>, kSectors>;

Context contextOf(const SurfacePoints& points) {
  Context context{};
  for (const SurfacePoint& p : points) {
    const double r = std::hypot(p.x, p.y);
    if (r >= kRange) continue;
    const double turn = (std::atan2(p.y, p.x) + hyselam::kPi) / (2.0 * hyselam::kPi);
    const auto sector = std::min(kSectors - 1, static_cast<std::size_t>(turn * kSectors));
    context[sector][static_cast<std::size_t>(r / kRange * kRings)] += 1.0F;
  }
  for (auto& column : context) {
    for (float& count : column) count = std::sqrt(count);
  }
  return context;
}

}  // namespace

std::vector<double> likelyTurns(const SurfacePoints& older, const SurfacePoints& newer,
                                std::size_t count) {
  const Context a = contextOf(older), b = contextOf(newer);
  std::array<float, kSectors> fit{};
  for (std::size_t turn = 0; turn < kSectors; ++turn) {
    for (std::size_t s = 0; s < kSectors; ++s) {
      const auto& column = b[(s + kSectors - turn) % kSectors];
      for (std::size_t r = 0; r < kRings; ++r) fit[turn] += a[s][r] * column[r];
    }
  }
  std::vector<double> turns;
  std::array<bool, kSectors> taken{};
  while (turns.size() < count) {
    std::size_t best = kSectors;
    for (std::size_t t = 0; t < kSectors; ++t) {
      if (!taken[t] && (best == kSectors || fit[t] > fit[best])) best = t;
    }
    if (best == kSectors) break;
    turns.push_back(
        hyselam::normalizeAngle(2.0 * hyselam::kPi * static_cast<double>(best) / kSectors));
    for (std::size_t k = 0; k <= kApart; ++k) {
      taken[(best + k) % kSectors] = taken[(best + kSectors - k) % kSectors] = true;
    }
  }
  return turns;
}

}  // namespace ngram_slam
