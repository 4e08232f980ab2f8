// The object map's places are those of the topological map.
#pragma once

#include "hyselam_objects/object_map.hpp"

namespace hyselam_objects {

/// Gives places that have none the id of the place of the same name in the topological map, and
/// puts the objects with a position that are at no place into the one whose cells they lie in.
/// Names that fit several places are left alone; returns how many are left without an id.
std::size_t linkPlaces(ObjectMap* map, const hyselam_topo::AugmentedTopologicalMap& topology);

}  // namespace hyselam_objects
