// Several states of SLAM as one, and one as several: what is known of runs goes along.
#pragma once

#include <cstdint>
#include <vector>

#include "ngram_slam/slam/slam_types.hpp"

namespace ngram_slam {

/// The states one after another; keyframes, runs, scans and observations are numbered on, path
/// lengths go on. Nothing is said of where they lie to each other: the poses of each stay as they
/// are in its own map frame. Density classes that were learnt are learnt anew.
/// @throws hyselam::InputError for a state that is not consistent.
SlamState joinedStates(const std::vector<SlamState>& states);

/// Some runs of a state, true for each; what joins them to others is left out. Of the counters only
/// that of scans is known.
/// @throws hyselam::InputError for a state that is not consistent.
SlamState partOfState(const SlamState& state, const std::vector<bool>& runs);

/// Of each keyframe, a number that tells its scan from all others.
std::vector<std::uint64_t> scanNumbers(const SlamState& state);

/// Number of runs: one more than the last keyframe's.
std::uint32_t runsOf(const SlamState& state);

}  // namespace ngram_slam
