// Names for the rooms beside a corridor of the map from a tour past them (hyselam_language's
// tour_reader.hpp, tour_match.hpp).
#pragma once

#include <vector>

#include "hyselam_language/reader/tour_match.hpp"
#include "hyselam_language/reader/tour_reader.hpp"
#include "hyselam_topological_map/topological_map.hpp"

namespace hyselam_topo {

/// The places on both sides of a corridor, seen by a robot that looks along it.
struct TourDoors {
  std::vector<TourSlot> slots;  ///< the left ones first, the nearest first
  std::vector<Id> places;       ///< behind each
};

/// Of each place that is joined to the corridor through a door on its left or right; those at its
/// ends (within 30 degrees of the heading) are not beside it. `heading`: of the robot [rad, map
/// frame]. Throws hyselam::InputError for a place that is not on the map.
TourDoors doorsAlong(const AugmentedTopologicalMap& map, Id corridor, double heading);

/// The map with the likeliest names as unconfirmed words, first the name, then its aliases; those
/// less probable than `least`, and words for no room in particular ("my office"), are left out.
/// Unconfirmed words that the map had of these places before are replaced.
AugmentedTopologicalMap withTourNames(const AugmentedTopologicalMap& map, const TourDoors& doors,
                                      const ToldTour& tour, const TourMatch& match,
                                      double least = 0.5);

}  // namespace hyselam_topo
