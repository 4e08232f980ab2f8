// What a new match of the description with the map changes, and what of it is not sure.
#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "hyselam_language/building/described_building.hpp"
#include "hyselam_topo/dialogue/place_man.hpp"
#include "hyselam_topo/dialogue/question_keeper.hpp"
#include "hyselam_topo/dialogue/uncertainty.hpp"
#include "hyselam_topo/topomerg/topomerg.hpp"

namespace hyselam_topo {

/// The name that an answer of TopoMerg gives a vertex: its number in the problem, -1 for none.
int nameAt(const MatchSolution& solution, std::size_t vertex);

/// The places where each name of a description is guessed; names that are confirmed are left out.
using GuessedPlaces = std::map<std::string, std::set<Id>>;
GuessedPlaces guessedPlaces(const PlaceMan& places, const DescribedBuilding& building);

/// The names that were guessed before and are elsewhere now, or nowhere. Not those that a person
/// has confirmed or taken back since.
std::vector<MovedName> movedNames(const GuessedPlaces& before, const PlaceMan& places,
                                  const DescribedBuilding& building);

/// Leads with that one of the equally good answers which leaves most names where they were guessed
/// before: a true sentence that lets more answers fit moves no name. Of those that name no more
/// places than the first; where more fit than were kept, the names are looked for where they were.
void leaveWhereGuessed(const GuessedPlaces& before, const MatchProblem& problem,
                       const SolverParams& params, const DescribedBuilding& building,
                       PlaceAssignment* match);

/// Names that equally good answers put elsewhere, and those whose calibrated probability is too
/// small (nameUncertainties()).
Uncertainty uncertaintyOf(const PlaceAssignment& match, const MatchProblem& problem,
                          const SolverParams& params, const DescribedBuilding& building);

}  // namespace hyselam_topo
