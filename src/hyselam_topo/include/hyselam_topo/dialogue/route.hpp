// Routes through the building along the topological graph: from door to door, clear of the walls.
#pragma once

#include <optional>
#include <vector>

#include "hyselam_common/parameters.hpp"
#include "hyselam_topological_map/topological_map.hpp"

namespace hyselam_topo {

struct RouteParams {
  double clearance = 0.35;  ///< no nearer to a wall than this where there is room [m], >= 0
  double comfortable_clearance = 0.8;  ///< nearer than this costs extra [m], >= 0
  double discomfort = 4.0;      ///< extra cost at a wall, in multiples of the path length, >= 0
  double closed_door = 1000.0;  ///< extra cost of a door that is known to be closed [m], >= 0
  double spacing = 0.1;         ///< of the poses of the path [m], > 0

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError for a parameter out of range.
  void validate() const;
};

/// A route to one place.
struct RouteLeg {
  std::vector<Id> places;  ///< from the place of the start to the goal
  std::vector<Id> doors;   ///< passed on the way, in order; 0 where two places meet without a door
  std::vector<hyselam::Pose2> waypoints;  ///< the middles of the doors, then the goal
  std::vector<hyselam::Pose2> path;       ///< from the start to the goal, looking ahead
  double length = 0.0;                    ///< of the path [m]
};

/// The cheapest route from a pose to the pose of the nearest of `goals` (several places may have
/// one name). Nothing if the map has no grid, the start lies on no place (or farther than 0.5 m
/// from the next one), or no route exists. A robot in one of the goals goes to its middle. No route
/// leads through a door of `shut`.
std::optional<RouteLeg> planRoute(const AugmentedTopologicalMap& map, const hyselam::Pose2& from,
                                  const std::vector<Id>& goals, const RouteParams& params = {},
                                  const std::vector<Id>& shut = {});

}  // namespace hyselam_topo
