// Texts for tests and benches: random ones, and the way of a robot round a building.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "hyselam_common/rng.hpp"
#include "ngram_slam/words/word_lattice.hpp"

namespace random_texts {

using ngram_slam::Syllables;

/// A word near a given one: size and angle a little different.
inline Syllables noisy(Syllables w, hyselam::Rng& rng, double size_share, double angle) {
  const double size = w.size * (1.0 + rng.uniform(-size_share, size_share));
  w.size = static_cast<std::uint32_t>(std::max(1.0, std::round(size)));
  w.angle = static_cast<float>(hyselam::normalizeAngle(w.angle + rng.uniform(-angle, angle)));
  return w;
}

/// Words drawn from few classes, sizes and angles, so that matches are common; neighbours differ in
/// class. Now and then a stretch of old words is written again, with noise; now and then a run
/// ends.
inline void write(ngram_slam::WordLattice& text, std::size_t positions, hyselam::Rng& rng) {
  std::vector<Syllables> real;
  const std::uint32_t classes = 2 + rng.below(3), sizes = 1 + rng.below(4),
                      angles = 1 + rng.below(4);
  while (real.size() < positions) {
    std::size_t from = real.size(), count = 1;
    if (!real.empty() && rng.below(4) == 0) {
      from = rng.below(static_cast<std::uint32_t>(real.size()));
      count = 1 + rng.below(12);
    }
    if (rng.below(20) == 0) text.startRun();
    for (std::size_t k = 0; k < count && real.size() < positions; ++k) {
      Syllables w;
      if (from + k < real.size()) {
        w = noisy(real[from + k], rng, 0.15, 0.3);
      } else {
        w.density_class = static_cast<int>(rng.below(classes));
        w.size = 4u << rng.below(sizes);
        w.angle = static_cast<float>(
            hyselam::normalizeAngle(rng.below(angles) * hyselam::kPi / 2 + rng.uniform(-0.1, 0.1)));
      }
      if (!real.empty() && w.density_class == real.back().density_class) {
        w.density_class = (w.density_class + 1) % static_cast<int>(classes);
      }
      real.push_back(w);
      text.push(w);
    }
  }
}

}  // namespace random_texts
