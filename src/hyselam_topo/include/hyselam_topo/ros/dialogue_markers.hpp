// The place names and the wall search of a dialogue, for rviz.
#pragma once

#include <visualization_msgs/MarkerArray.h>

#include "hyselam_topo/dialogue/dialogue.hpp"
#include "hyselam_topological_map/ros/map_markers.hpp"

namespace hyselam_topo {

/// As mapMarkers(), but each name with the generated id of its place (e.g. SS03), in the colours of
/// Fig. 7.10: green without a name, red guessed, blue confirmed; namespaces `names` and
/// `name_states`, a ring around each middle.
visualization_msgs::MarkerArray namedMapMarkers(const AugmentedTopologicalMap& map,
                                                const MapMarkerParams& params);

/// The search for a wall of glass that the robot asks about (Fig. 7.5), in the namespace
/// `glass_wall`: the searched area green, corners red, the wall blue. Without a question it
/// deletes what was shown.
visualization_msgs::MarkerArray questionMarkers(const Question& question,
                                                const std::string& frame_id);

}  // namespace hyselam_topo
