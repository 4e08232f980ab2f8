// The way of a robot: its travel, with turns, which show as much of the surroundings.
#pragma once

namespace fsd_localization {

constexpr double kTurnAsTravel = 0.5;  ///< [m/rad] a turn shows as much as so much travel

/// Way [m] of so much travel [m] and turn [rad, all turns added up]. What the classes of this
/// folder call way is that since the localizer was made, by the refined odometry.
inline double lengthWithTurns(double length, double turned) {
  return length + kTurnAsTravel * turned;
}

}  // namespace fsd_localization
