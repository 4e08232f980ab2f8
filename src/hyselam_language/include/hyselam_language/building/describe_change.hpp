// What is new, changed or gone between two descriptions, in the words of a grammar: the read-back
// of statements.
#pragma once

#include <string>
#include <vector>

#include "hyselam_language/building/described_building.hpp"
#include "hyselam_language/grammar/grammar.hpp"

namespace hyselam_topo {

/// Short sentences of the grammar's section `say`; none for equal descriptions. Places are the same
/// that have the same id.
/// - What is new or has another value is told as it is now: "The boardroom is across from the
///   lifts.", "This is the corridor." (the robot's place).
/// - What is told no more, of places that are still there: "No longer: the kitchen is on the left
/// of
///   the corridor." What was only made more exact (joined, then on the left) is not mentioned.
/// - Places that are gone: "The kitchen is gone."
/// The second place of one name is "another toilet". Told from nothing, TopoParser and
/// DescriptionBuilder make `after` of the sentences again, as of describeBuilding().
/// Throws as describeBuilding().
std::vector<std::string> describeChange(const DescribedBuilding& before,
                                        const DescribedBuilding& after, const Grammar& grammar);

}  // namespace hyselam_topo
