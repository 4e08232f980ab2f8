#include <cmath>

#include "hyselam_common/pose2.hpp"
#include "ngram_slam/signatures/place_signature.hpp"

namespace ngram_slam {

namespace {

/// Cosines and sines of the first waves over `N` samples.
template <std::size_t N, std::size_t Waves>
struct Tables {
  std::array<std::array<float, Waves>, N> cosine, sine;
  Tables() {
    for (std::size_t i = 0; i < N; ++i) {
      for (std::size_t w = 0; w < Waves; ++w) {
        const double angle = 2.0 * hyselam::kPi * static_cast<double>(i * w % N) / N;
        cosine[i][w] = static_cast<float>(std::cos(angle));
        sine[i][w] = static_cast<float>(std::sin(angle));
      }
    }
  }
};

// Steadies the roots of magnitudes near zero.
constexpr float kSmallMagnitude = 1e-4F;
constexpr float kNearest = 0.5F;  // [m] added to distances before their logarithm

}  // namespace

SignatureFeatures::Vector SignatureFeatures::of(const PlaceFeatures& features) {
  constexpr std::size_t kBeams = PlaceFeatures::kBeams, kSectors = PlaceFeatures::kSectors,
                        kRings = PlaceFeatures::kRings;
  static const Tables<kBeams, kDistanceWaves> kOfBeams;
  static const Tables<kSectors, kContextWaves> kOfSectors;
  Vector out{};
  std::size_t at = 0;
  for (const float d : features.densities) out[at++] = d;

  std::array<float, kDistanceWaves> re{}, im{};
  for (std::size_t b = 0; b < kBeams; ++b) {
    const float value = std::log(kNearest + features.distances[b]);
    for (std::size_t w = 0; w < kDistanceWaves; ++w) {
      re[w] += value * kOfBeams.cosine[b][w];
      im[w] += value * kOfBeams.sine[b][w];
    }
  }
  for (std::size_t w = 0; w < kDistanceWaves; ++w) out[at++] = std::hypot(re[w], im[w]) / kBeams;

  std::array<std::array<float, kContextWaves>, kRings> ring_re{}, ring_im{};
  for (std::size_t s = 0; s < kSectors; ++s) {
    for (std::size_t r = 0; r < kRings; ++r) {
      if (features.context[s][r] == 0) continue;
      const float value = std::sqrt(static_cast<float>(features.context[s][r]));
      for (std::size_t w = 0; w < kContextWaves; ++w) {
        ring_re[r][w] += value * kOfSectors.cosine[s][w];
        ring_im[r][w] += value * kOfSectors.sine[s][w];
      }
    }
  }
  for (std::size_t w = 0; w < kContextWaves; ++w) {
    for (std::size_t r = 0; r < kRings; ++r) {
      out[at++] = std::sqrt(std::hypot(ring_re[r][w], ring_im[r][w]) / kSectors + kSmallMagnitude);
    }
  }
  return out;
}

}  // namespace ngram_slam
