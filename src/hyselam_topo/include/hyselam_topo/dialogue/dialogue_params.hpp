// Parameters of the dialogue with people about places.
#pragma once

#include <string>

#include "hyselam_common/parameters.hpp"
#include "hyselam_topo/dialogue/ask_place.hpp"
#include "hyselam_topo/dialogue/glass_wall.hpp"
#include "hyselam_topo/dialogue/route.hpp"
#include "hyselam_topo/dialogue/topo_state.hpp"
#include "hyselam_topo/topomerg/topomerg.hpp"

namespace hyselam_topo {

struct DialogueParams {
  /// Language of the robot's first sentences; then it answers in the language of the person.
  std::string language = "en";
  /// When the robot asks unprompted, on entering a place.
  AskPolicy ask = AskPolicy::kUnconfirmed;
  /// After a description the robot asks for the name that best discriminates between near-equal
  /// assignments, also about other places than its own, by their generated id (e.g. SS03).
  bool ask_from_afar = false;
  /// Search (TopoMerg) for the places of the map that described names belong to.
  SolverParams match = defaultMatch();
  GlassWallParams glass;  ///< search in the grid map for a glass wall that a person describes
  RouteParams route;      ///< of the paths to places
  TopoStateParams state;  ///< of TopoState, which tracks the robot's place; not of DialogueState

  /// Defaults of SolverParams, but with a time limit of 2 s, and solutions whose fitness is within
  /// 0.03 of the best are kept.
  static SolverParams defaultMatch();

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError for a parameter out of range.
  void validate() const;
};

}  // namespace hyselam_topo
