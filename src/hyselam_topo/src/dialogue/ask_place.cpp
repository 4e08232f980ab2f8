#include "hyselam_topo/dialogue/ask_place.hpp"

namespace hyselam_topo {

PlaceQuestion askPlace(NameState state, AskPolicy policy) {
  if (policy == AskPolicy::kNever) return PlaceQuestion::kNothing;
  switch (state) {
    case NameState::kUnconfirmed:
      return PlaceQuestion::kConfirmName;
    case NameState::kNone:
      return policy == AskPolicy::kAlways ? PlaceQuestion::kName : PlaceQuestion::kNothing;
    case NameState::kConfirmed:
      break;
  }
  return PlaceQuestion::kNothing;
}

}  // namespace hyselam_topo
