// Headings as whole numbers: 2^32 make a full turn, so that adding two headings wraps by itself and
// the top bits are the heading in coarse steps.
#pragma once

#include <cmath>
#include <cstdint>

#include "hyselam_common/pose2.hpp"

namespace fsd_localization {

using BinaryAngle = std::uint32_t;

/// [rad], any finite value.
inline BinaryAngle toBinaryAngle(double angle) {
  constexpr double kPerRadian = 4294967296.0 / (2.0 * hyselam::kPi);
  return static_cast<BinaryAngle>(std::llround(hyselam::normalizeAngle(angle) * kPerRadian));
}
/// In [-pi, pi).
inline double toRadians(BinaryAngle angle) {
  return static_cast<std::int32_t>(angle) * (2.0 * hyselam::kPi / 4294967296.0);
}

/// Sine and cosine to 3e-7; free of branches, so that loops over many headings vectorise.
inline void sinCos(BinaryAngle angle, float& sine, float& cosine) {
  // Nearest multiple of a quarter turn, and the rest in [-pi/4, pi/4].
  const std::uint32_t quarter = (angle + 0x20000000U) >> 30;
  const auto rest = static_cast<std::int32_t>(angle - (quarter << 30));
  const float t = static_cast<float>(rest) * static_cast<float>(2.0 * hyselam::kPi / 4294967296.0);
  const float t2 = t * t;
  const float s = t + t * t2 * (-1.6666655e-1F + t2 * (8.3321608e-3F - t2 * 1.9515296e-4F));
  const float c =
      1.0F - 0.5F * t2 + t2 * t2 * (4.1666646e-2F - t2 * (1.3887316e-3F - t2 * 2.4433157e-5F));
  const bool swap = (quarter & 1U) != 0;
  const float a = swap ? c : s, b = swap ? s : c;
  sine = (quarter & 2U) != 0 ? -a : a;
  cosine = ((quarter + 1U) & 2U) != 0 ? -b : b;
}

}  // namespace fsd_localization
