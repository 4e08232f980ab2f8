// The states of a localizer and the phases that it publishes.
#pragma once

namespace fsd_localization {

/// The states of localisation. In a search, free-space density weighs particles everywhere; with
/// hypotheses, the likelihood field chooses among a few places; while tracking it follows one.
/// relocalizeGlobally() leads to kGlobalSearch, setInitialPose() to kGlobalHypotheses. What else
/// leads from one to another is decided by the search by submaps (localizer_search.cpp):
///
///     state              on                                          next
///     kGlobalSearch      the search is sure of a place               kTracking
///                        it finds places, and is sure of none        kGlobalHypotheses
///     kGlobalHypotheses  it is sure of a place, or agrees            kTracking
///                        with the filter for long
///                        the pose was told, has converged and fits   kTracking
///     kTracking          another place is better, and sure           kTracking, there
///                        other places are better, none is sure       kLostHypotheses
///     kLostHypotheses    as kGlobalHypotheses                        kTracking
///
/// or, without it (LocalizerParams::submap_search), by the share of inliers:
///
///     kGlobalSearch      few places are left                         kGlobalHypotheses
///     kGlobalHypotheses  one place is left, and fits                 kTracking
///                        too few inliers                             kGlobalSearch
///     kTracking          too few inliers                             kLostSearch
///     kLostSearch        few places are left                         kLostHypotheses
///     kLostHypotheses    one place is left, and fits                 kTracking
///                        too few inliers                             kLostSearch
///
/// Models other than hybrid use kGlobalSearch and kTracking only, and change between them as their
/// estimate converges or not.
/// Whether the estimate of an update deserves trust is LocalizationResult::converged.
enum class LocalizerState {
  kGlobalSearch,
  kGlobalHypotheses,
  kTracking,
  kLostSearch,
  kLostHypotheses,
};

/// The states as they are published.
enum class Phase {
  kGlobal,    ///< not localized yet
  kTracking,  ///< localized
  kLost,      ///< was localized; the pose is searched again
};
const char* toString(Phase phase);

Phase phaseOf(LocalizerState state);
inline bool isSearching(LocalizerState state) {
  return state == LocalizerState::kGlobalSearch || state == LocalizerState::kLostSearch;
}
/// Few places are left: from the search of the same phase.
inline LocalizerState withHypotheses(LocalizerState state) {
  return phaseOf(state) == Phase::kGlobal ? LocalizerState::kGlobalHypotheses
                                          : LocalizerState::kLostHypotheses;
}
/// No place fits: back to the search of the same phase; lost, if a place was tracked.
inline LocalizerState backToSearch(LocalizerState state) {
  return phaseOf(state) == Phase::kGlobal ? LocalizerState::kGlobalSearch
                                          : LocalizerState::kLostSearch;
}

}  // namespace fsd_localization
