// What people have confirmed and rejected, for matching their description with the map.
#pragma once

#include "hyselam_language/building/described_building.hpp"
#include "hyselam_language/building/description_builder.hpp"
#include "hyselam_topo/dialogue/place_man.hpp"
#include "hyselam_topo/topomerg/topomerg.hpp"

namespace hyselam_topo {

/// Places with confirmed names are those of the description that are called so, or none of it; what
/// was rejected is excluded for the others.
MatchConstraints constraintsOf(const PlaceMan& places, const DescriptionBuilder& builder);

/// The name that a match gives a vertex: its number in the description, -1 for none.
int nameAt(const MatchSolution& solution, std::size_t vertex);

/// Answers that are as good as the best one.
struct EqualAnswers {
  std::size_t count = 0;    ///< with the best one
  std::vector<int> unsure;  ///< names that they put in different places
};

/// Answers that only give a name more places say less than the one with the fewest, which is taken:
/// they do not count.
EqualAnswers equalAnswers(const PlaceAssignment& match);

}  // namespace hyselam_topo
