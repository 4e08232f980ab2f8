// Objects as evidence for TopoMerg (dos Santos, section 5.4: "objects related to a place can also
// be used as attributes"): what people told of the objects in a place against what was seen in
// places of the map.
#pragma once

#include <vector>

#include "hyselam_language/building/described_building.hpp"
#include "hyselam_objects/object_map.hpp"
#include "hyselam_topo/topomerg/topomerg_problem.hpp"

namespace hyselam_objects {

struct EvidenceParams {
  double told_only = 0.15;  ///< chance that a told object is missed though the place was looked at
  double seen_only = 0.5;   ///< chance that a seen object was not told of: people tell little
  double by_chance = 0.1;   ///< chance that a kind of object stands in any one place
};

/// Evidence between each place of the description that objects are `told` to be at and each place
/// of the topological map in which objects were `seen` (their places' topological ids). For each
/// kind the smaller of both counts agrees, the rest does not: the likelihood ratio of "the same
/// place" against "some place" by the chances above, as a probability at even odds, is the value, 0
/// .. 1. An object's movability m weakens it: log ratios count (1 - m) + 0.3 of their size at
/// most 1.
///
/// Names of places are matched as PlaceNames does; told places that fit no name or several give no
/// evidence. Throws hyselam::ParameterError for chances outside 0 .. 1 (exclusive).
std::vector<hyselam_topo::MatchEvidence> placeEvidence(
    const ObjectMap& told, const ObjectMap& seen, const hyselam_topo::DescribedBuilding& building,
    const EvidenceParams& params = {});

}  // namespace hyselam_objects
