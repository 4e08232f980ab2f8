// Gaussian noise by the million: a hash of (seed, step, index) looked up in a table of quantiles.
// The same numbers whatever the order or the thread they are asked in.
#pragma once

#include <array>
#include <cstdint>

#include "hyselam_common/rng.hpp"

namespace fsd_localization {

class NoiseTable {
 public:
  NoiseTable();
  /// Three independent standard normal numbers from one hash (21 bits each): quantiles in 4096
  /// steps with linear interpolation; cut at +-3.7 sigma, variance 1.
  void gaussians(std::uint64_t hash, float& a, float& b, float& c) const {
    a = quantile(hash);
    b = quantile(hash >> 21);
    c = quantile(hash >> 42);
  }

 private:
  float quantile(std::uint64_t bits) const {
    const auto i = static_cast<std::size_t>(bits & 0xFFF);
    const float t =
        static_cast<float>(static_cast<std::int32_t>(bits >> 12 & 0x1FF)) * (1.0F / 512.0F);
    return table_[i] + t * (table_[i + 1] - table_[i]);
  }
  std::array<float, 4097> table_;
};

/// Hash number `index` of a stream; streams come from hyselam::mix() of seed and step.
inline std::uint64_t hashAt(std::uint64_t stream, std::uint64_t index) {
  return hyselam::splitmix64(stream + index * 0x9e3779b97f4a7c15ULL);
}
/// Uniform in [0, 1), from the upper 53 bits.
inline double toUnit(std::uint64_t hash) {
  return static_cast<double>(hash >> 11) * 0x1.0p-53;
}

}  // namespace fsd_localization
