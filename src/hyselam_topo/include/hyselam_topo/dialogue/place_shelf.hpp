// The shelf of the place manager: names by people whose places the present map does not show. A
// robot that starts in the middle of a building, or with a wrong map, loses none of them.
#pragma once

#include <cstddef>
#include <map>
#include <vector>

#include "hyselam_topological_map/topological_map.hpp"

namespace hyselam_topo {

/// What one former map knew of the places that were lost with it: these places alone, with their
/// outlines, centres and cells, no walls and no doors. Those that were found again since stay
/// without words, as witnesses of which map this is, until no other one has words.
using ShelvedMap = AugmentedTopologicalMap;

/// The one shelved last is the last. At most 500 places with words, the newest.
using Shelf = std::vector<ShelvedMap>;

/// Those of the places of a map that a person has named, with the confirmed words only.
ShelvedMap shelvedFrom(const AugmentedTopologicalMap& map, const std::vector<Id>& places);

/// How many places have words.
std::size_t wordedPlaces(const Shelf& shelf);

/// Puts a map on the shelf, if it has a place with words; what is too much of the oldest is gone.
void shelve(ShelvedMap lost, Shelf* shelf);

/// Takes out the words of these places of a shelved map, and the map when no place has words.
void takeFrom(std::size_t shelved, const std::vector<Id>& places, Shelf* shelf);

/// Old places that lie, in their own frame, where one of the new map is, with nearly its limits
/// (shared cells / all cells of both >= 0.75). The new map's place by the old one's.
std::map<Id, Id> clearSuccessors(const AugmentedTopologicalMap& old,
                                 const AugmentedTopologicalMap& fresh);

/// The places of the new map that are those of a shelved one, each by the shelved one's id. Empty
/// unless it shows clearly that it is of the same building in the same frame: at least 60 % of the
/// shelved places, and two, have a clear successor; a single one shares 0.85 of them.
std::map<Id, Id> foundAgain(const ShelvedMap& shelved, const AugmentedTopologicalMap& fresh);

}  // namespace hyselam_topo
