// The sides that people tell, as directions.
#pragma once

#include "hyselam_common/pose2.hpp"
#include "hyselam_language/building/described_building.hpp"

namespace hyselam_topo {

/// Where a side lies, from the direction in which somebody looks, left > 0 [rad]: front 0, left
/// pi/2, back pi, right -pi/2; 0 for a side that is not known.
inline double angleOf(Side side) {
  switch (side) {
    case Side::kLeft:
      return 0.5 * hyselam::kPi;
    case Side::kRight:
      return -0.5 * hyselam::kPi;
    case Side::kBack:
      return hyselam::kPi;
    case Side::kFront:
    case Side::kUnknown:
      break;
  }
  return 0.0;
}

}  // namespace hyselam_topo
