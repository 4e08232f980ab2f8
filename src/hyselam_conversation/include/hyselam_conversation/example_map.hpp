// A building to try a talk in: an office of twenty rooms along a corridor (maps/README.md).
#pragma once

#include "hyselam_topological_map/topological_map.hpp"

namespace hyselam_conversation {

/// The library carries it. None of its places has a name.
hyselam_topo::AugmentedTopologicalMap exampleMap();

}  // namespace hyselam_conversation
