// Metropolis' sampling as the layouts of tours use it: each start cools down from a first
// temperature to 1 in its first third, and is looked at from then on.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>

namespace hyselam_topo {
namespace language {

/// The same numbers on every machine, unlike the distributions of <random>.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : random_(seed) {}
  double real() { return static_cast<double>(random_() >> 11) * 0x1.0p-53; }
  std::size_t below(std::size_t count) { return static_cast<std::size_t>(random_() % count); }
  /// Whether a state is left for another one, whose logarithm of likelihood is so much larger.
  bool accepts(double gain, double temperature) {
    return gain >= 0.0 || real() < std::exp(gain / temperature);
  }

 private:
  std::mt19937_64 random_;
};

struct Cooling {
  std::size_t steps = 0;  ///< of one start
  double first_temperature = 1.0;

  bool isOver(std::size_t step) const { return step >= steps / 3; }
  double temperature(std::size_t step) const {
    if (isOver(step)) return 1.0;
    const double share =
        static_cast<double>(step) / static_cast<double>(std::max<std::size_t>(steps / 3, 1));
    return first_temperature * (1.0 - share) + share;
  }
};

}  // namespace language
}  // namespace hyselam_topo
