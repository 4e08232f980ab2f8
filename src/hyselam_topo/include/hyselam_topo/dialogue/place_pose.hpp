// A robot pose within a place: as navigation goal, or as initial pose estimate for a robot whose
// place a person states.
#pragma once

#include <array>
#include <optional>

#include "hyselam_topological_map/topological_map.hpp"

namespace hyselam_topo {

struct PlacePose {
  /// Far from the walls, near the middle; looking from the widest door into the place.
  hyselam::Pose2 pose;
  /// To the nearest cell that does not belong to the place [m]; 0: not known.
  double clearance = 0.0;
  /// Of (x, y, theta), row-major, if the robot may be anywhere in the place, looking anywhere:
  /// the spread of its cells about the pose, and pi^2 / 3.
  std::array<double, 9> covariance{};
};

/// Nothing for an id that is not in the map, and for a place of which no position is known.
/// Cost: in the cells of the box around the place.
std::optional<PlacePose> placePose(const AugmentedTopologicalMap& map, Id place);

}  // namespace hyselam_topo
