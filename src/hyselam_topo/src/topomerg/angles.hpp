// Angles of the search, which normalizes them in its innermost loops.
#pragma once

#include "hyselam_common/pose2.hpp"

namespace hyselam_topo::merging {

using hyselam::kPi;

/// To -pi .. pi, for angles within -3 pi .. 3 pi. Unlike hyselam::normalizeAngle() without a
/// division.
inline double wrapAngleOnce(double angle) {
  if (angle > kPi) return angle - 2.0 * kPi;
  if (angle < -kPi) return angle + 2.0 * kPi;
  return angle;
}

/// The same line seen from its other end.
inline double reverseBearing(double bearing) {
  return bearing > 0.0 ? bearing - kPi : bearing + kPi;
}

}  // namespace hyselam_topo::merging
