#include "fsd_localization/localizer_state.hpp"

namespace fsd_localization {

const char* toString(Phase phase) {
  switch (phase) {
    case Phase::kGlobal:
      return "global";
    case Phase::kTracking:
      return "tracking";
    case Phase::kLost:
      break;
  }
  return "lost";
}

Phase phaseOf(LocalizerState state) {
  switch (state) {
    case LocalizerState::kGlobalSearch:
    case LocalizerState::kGlobalHypotheses:
      return Phase::kGlobal;
    case LocalizerState::kTracking:
      return Phase::kTracking;
    case LocalizerState::kLostSearch:
    case LocalizerState::kLostHypotheses:
      break;
  }
  return Phase::kLost;
}

}  // namespace fsd_localization
