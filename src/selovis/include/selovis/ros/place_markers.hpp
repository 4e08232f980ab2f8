// Markers for rviz: the probability of each place as a bar at its center.
#pragma once

#include <visualization_msgs/MarkerArray.h>

#include <string>
#include <vector>

#include "hyselam_topological_map/topological_map.hpp"

namespace selovis {

/// Namespaces `bars` and, for places of half a per cent or more, `names`; places that are not on
/// the map, or have no middle, get none. The likeliest place is green, where the robot was
/// kidnapped orange, the others blue. Stamps are 0 (newest transform). `height` [m] of a bar of
/// probability 1.
visualization_msgs::MarkerArray placeMarkers(const hyselam_topo::AugmentedTopologicalMap& map,
                                             const std::vector<std::string>& names,
                                             const std::vector<double>& probabilities,
                                             int likeliest, bool kidnapped, double height);

}  // namespace selovis
