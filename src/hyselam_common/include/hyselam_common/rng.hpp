// Random numbers that are the same with every standard library: <random>'s distributions are not.
#pragma once

#include <cmath>
#include <cstdint>

#include "hyselam_common/pose2.hpp"

namespace hyselam {

/// The mixing function of SplitMix64 (Steele, Lea, Flood 2014): a good hash of a counter.
constexpr std::uint64_t splitmix64(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

/// A hash of two numbers, to derive independent streams ("seed 7, particle 12").
constexpr std::uint64_t mix(std::uint64_t a, std::uint64_t b) {
  return splitmix64(splitmix64(a) ^ (b * 0xd1342543de82ef95ULL));
}

/// Counter-based generator; copying it copies its future. Satisfies UniformRandomBitGenerator.
class Rng {
 public:
  using result_type = std::uint64_t;
  explicit Rng(std::uint64_t seed = 0, std::uint64_t stream = 0) : state_(mix(seed, stream)) {}

  static constexpr result_type min() { return 0; }
  static constexpr result_type max() { return ~std::uint64_t{0}; }
  result_type operator()() {
    const std::uint64_t value = splitmix64(state_);
    state_ += 0x9e3779b97f4a7c15ULL;
    return value;
  }

  /// In [0, 1), 53 random bits.
  double uniform() { return static_cast<double>((*this)() >> 11) * 0x1.0p-53; }
  /// In [low, high).
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// In 0 .. n - 1 for n > 0 (multiply and shift; the bias is below n / 2^32).
  std::uint32_t below(std::uint32_t n) {
    return static_cast<std::uint32_t>((((*this)() >> 32) * n) >> 32);
  }
  /// Standard normal (Box-Muller; the second value is not kept, so that the state is one number).
  double gaussian() {
    const double u = 1.0 - uniform();  // (0, 1]
    const double angle = 2.0 * kPi * uniform();
    return std::sqrt(-2.0 * std::log(u)) * std::cos(angle);
  }
  double gaussian(double mean, double sigma) { return mean + sigma * gaussian(); }

 private:
  std::uint64_t state_;
};

}  // namespace hyselam
