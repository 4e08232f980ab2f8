// Between the augmented topological map and its messages.
#pragma once

#include <hyselam_msgs/AugmentedTopologicalMap.h>

#include <string>

#include "hyselam_topological_map/topological_map.hpp"

namespace hyselam_topo {

/// fromMsg(toMsg(m)) == m, but for a stamp that is not a whole number of ns. @throws
/// hyselam::InputError for a stamp that messages cannot hold.
hyselam_msgs::AugmentedTopologicalMap toMsg(const AugmentedTopologicalMap& map);

hyselam_msgs::Wall toMsg(const Wall& wall);

/// @throws hyselam::InputError, beginning with `source`, for constants that do not exist, arrays
/// that do not fit together, and maps that checkMap() refuses.
AugmentedTopologicalMap fromMsg(const hyselam_msgs::AugmentedTopologicalMap& msg,
                                const std::string& source);

/// A frame as tf2 wants it, without a slash in front; a map without one is taken to be in "map".
std::string frameOf(const std::string& frame_id);

}  // namespace hyselam_topo
