// What a region looks like: the numbers from which its class is told (Maffei 2017, 6.2, 6.4).
#pragma once

#include <array>
#include <cstddef>

namespace ngram_slam {

/// Lengths are counts of observations (0.1 m each by default), densities 0..1, angles radians.
struct SemanticFeatures {
  double length = 0.0;       ///< syllable s
  double level = 0.0;        ///< smoothed density where it stood or turned: the region's own
  double rise_before = 0.0;  ///< level minus that of the region before; 0 if there is none
  double rise_after = 0.0;   ///< the same for the region after
  double variation = 0.0;    ///< of the density: how far the region differs from its neighbours
  double density_min = 0.0;  ///< of single observations
  double density_max = 0.0;
  double frontiers = 0.0;  ///< mean number of frontiers of free space in the region's middle half
  double few_frontiers = 0.0;   ///< share of the observations with at most one
  double many_frontiers = 0.0;  ///< with at least three
  double turn = 0.0;            ///< range of the robot's headings, unwrapped, >= 0
  double angle = 0.0;           ///< |a| of Alg. 4.3
  double stands = 0.0;          ///< 1: the density stood at its level, 0: it only turned
};

constexpr std::size_t kSemanticFeatures = 13;

/// In the order of the members; for learning.
inline std::array<float, kSemanticFeatures> vectorOf(const SemanticFeatures& f) {
  const auto v = [](double x) { return static_cast<float>(x); };
  return {v(f.length),        v(f.level),          v(f.rise_before), v(f.rise_after),
          v(f.variation),     v(f.density_min),    v(f.density_max), v(f.frontiers),
          v(f.few_frontiers), v(f.many_frontiers), v(f.turn),        v(f.angle),
          v(f.stands)};
}

}  // namespace ngram_slam
