// A description in the words of a person: from DescribedBuilding back to text, for
// simulated people and for tests.
#pragma once

#include <string>

#include "hyselam_language/building/described_building.hpp"
#include "hyselam_language/grammar/grammar.hpp"

namespace hyselam_topo {

/// Sentences of the grammar's section `say`, in this order: the number of places, the neighbours of
/// each place as the robot sees them from there, other connections, sizes, parts, kinds that the
/// names do not imply, aliases, relations, places without any other statement, the robot's place.
/// TopoParser and DescriptionBuilder make the same description of it again, save for ids, if
/// - the orders of each place and side are 0, 1, 2, ...,
/// - the robot is somewhere if any side is described,
/// - places at the end of another are connected with it, an area beside length and width is their
///   product, and no place is virtual by kind,
/// - no two places have names that may mean the same (place_names.hpp).
/// Throws hyselam::InputError for a description that checkDescription() refuses, a name that cannot
/// be put between any quotation marks, and a grammar without a needed phrase.
std::string describeBuilding(const DescribedBuilding& building, const Grammar& grammar);

}  // namespace hyselam_topo
