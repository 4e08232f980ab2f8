// Which verified far loops are believed: one rule, of SLAM and of the evaluation of recognition.
#pragma once

#include <cstddef>
#include <vector>

#include "ngram_slam/slam/run_connections.hpp"
#include "ngram_slam/slam/slam_params.hpp"
#include "ngram_slam/slam/slam_types.hpp"

namespace ngram_slam {

/// Loops that may wait in SLAM. A saved map waits for nothing more: there all may.
constexpr std::size_t kMaxWaitingLoops = 400;

/// Adds a verified far loop to those that `wait`. Returns those that are believed now, itself or
/// some that waited for one like it, the newest first, and takes them out; `accepted`: far loops
/// believed before. One that says again what an accepted or a waiting one says of the same
/// keyframes is no news. At most `max_waiting` wait: the oldest are given up.
///
/// A loop is believed if its company does not contradict it (companyOf()), it is not less probable
/// than `LoopParams::min_signature_probability` where signatures proposed it (loopProbability()),
/// and it is consistent with an accepted one or, pairwise, with enough others of which the same is
/// true
/// (`min_consistent_loops`, `min_consistent_signature_loops`) along `consistency_min_span` of path.
/// One that ties two maps together needs more: `min_tie_loops` along `tie_min_span`.
std::vector<SlamLoop> believeFarLoops(const SlamLoop& loop, const std::vector<SlamLoop>& accepted,
                                      const std::vector<SlamKeyframe>& keyframes,
                                      const RunConnections& connections, const LoopParams& params,
                                      std::vector<SlamLoop>* waiting,
                                      std::size_t max_waiting = kMaxWaitingLoops);

}  // namespace ngram_slam
