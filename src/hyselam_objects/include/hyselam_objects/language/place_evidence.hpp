// Objects as evidence for TopoMerg (dos Santos, section 5.4: "objects related to a place can also
// be used as attributes"): the objects that people described in a place against those seen in the
// places of the map.
#pragma once

#include <vector>

#include "hyselam_common/parameters.hpp"
#include "hyselam_language/building/described_building.hpp"
#include "hyselam_objects/mapping/object_map.hpp"

namespace hyselam_objects {

/// Probabilities, each between 0 and 1 (exclusive).
struct EvidenceParams {
  double p_missed = 0.15;  ///< a described object is not detected in a place that was observed
  double p_not_described = 0.5;  ///< a detected object was not described: people mention few
  double p_chance = 0.1;         ///< a kind of object is in any one place

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError
  void validate() const;
};

/// Evidence between each place of the description at which objects were described and each place
/// of the topological map in which objects were detected (their places' topological ids). For each
/// kind the smaller of both counts agrees, the rest does not: the likelihood ratio of "the same
/// place" against "some place" by the probabilities above, as a probability at even odds, is the
/// value, 0 .. 1. An object's movability m weakens it: log ratios count (1 - m) + 0.3 of their size
/// at most 1.
///
/// Names of places are matched as by PlaceNames; described places that match no name or several
/// give no evidence.
/// @throws hyselam::ParameterError.
std::vector<hyselam_topo::MatchEvidence> placeEvidence(
    const ObjectMap& described, const ObjectMap& detected,
    const hyselam_topo::DescribedBuilding& building, const EvidenceParams& params = {});

}  // namespace hyselam_objects
