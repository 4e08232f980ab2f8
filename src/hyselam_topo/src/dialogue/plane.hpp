// Distances in the plane that the sources of this folder share.
#pragma once

#include <algorithm>
#include <cmath>

#include "hyselam_common/pose2.hpp"

namespace hyselam_topo {

inline double distanceBetween(hyselam::Point2 a, hyselam::Point2 b) {
  return std::hypot(b.x - a.x, b.y - a.y);
}

inline double distanceToSegment(hyselam::Point2 p, hyselam::Point2 a, hyselam::Point2 b) {
  const double dx = b.x - a.x, dy = b.y - a.y;
  const double squared = dx * dx + dy * dy;
  const double t =
      squared > 0.0 ? std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / squared, 0.0, 1.0) : 0.0;
  return distanceBetween(p, {a.x + t * dx, a.y + t * dy});
}

}  // namespace hyselam_topo
