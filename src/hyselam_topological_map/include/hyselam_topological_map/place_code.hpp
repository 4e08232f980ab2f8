// The map's own names of places, whatever people call them.
#pragma once

#include <string>

#include "hyselam_topological_map/topological_map.hpp"

namespace hyselam_topo {

/// The generated id of a place that people read: "SS01" for rooms, "CC04" for corridors (Fig. 7.9),
/// "VV05" for virtual places; the number is Place::id.
std::string codeOf(const Place& place);

}  // namespace hyselam_topo
