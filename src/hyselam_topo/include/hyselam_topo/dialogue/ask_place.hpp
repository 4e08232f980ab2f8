// TopoAskPlace (dos Santos, Alg. 1): what the robot asks unprompted on entering a place.
#pragma once

#include "hyselam_topo/dialogue/place_man.hpp"

namespace hyselam_topo {

/// When the robot asks unprompted.
enum class AskPolicy {
  kNever,
  kUnconfirmed,  ///< only whether a guessed name is right
  kAlways        ///< also for the name of a place without one
};

enum class PlaceQuestion {
  kNothing,
  kConfirmName,  ///< "Is this the kitchen?"
  kName          ///< "What is the name of this place?"
};

/// What to ask of a place with a name in this state.
PlaceQuestion askPlace(NameState state, AskPolicy policy);

}  // namespace hyselam_topo
