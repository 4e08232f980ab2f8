// The places of the object map, linked to those of the topological map.
#pragma once

#include "hyselam_language/building/place_names.hpp"
#include "hyselam_objects/mapping/object_map.hpp"

namespace hyselam_objects {

/// Gives places without an id in the topological map that of the place with the same name, and puts
/// objects that have a position but no place into the place whose cells they lie in. Names that
/// match several places are left alone.
/// `names` decides which names are the same, e.g. shippedPlaceNames(), which takes long to make.
/// @return number of places left without an id.
std::size_t linkPlaces(ObjectMap& map, const hyselam_topo::AugmentedTopologicalMap& topology,
                       const hyselam_topo::PlaceNames& names);

/// By the shipped grammars of all languages.
hyselam_topo::PlaceNames shippedPlaceNames();

}  // namespace hyselam_objects
