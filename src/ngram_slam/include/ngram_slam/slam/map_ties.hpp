// What would tie two maps together, and how sure that is.
#pragma once

#include <optional>
#include <vector>

#include "ngram_slam/slam/run_connections.hpp"
#include "ngram_slam/slam/slam_params.hpp"
#include "ngram_slam/slam/slam_types.hpp"

namespace ngram_slam {

struct MapTie {
  std::vector<SlamLoop> loops;  ///< that are believed and do not contradict the first one
  /// Sum of the inlier ratios of all loops between both maps that may be right if the first one is.
  double support = 0.0;
  double rival = 0.0;  ///< the same of those that agree with the best of the others
};

/// The best tie of two maps by the verified far loops between them: of the loops that are believed
/// (believeFarLoops()) the one with most support. None if none is believed, or if there is a rival:
/// a loop that contradicts it, and of what speaks for one of the two only, the part for the rival
/// is more than `max_rival` of that for the best. Buildings that repeat themselves have many
/// rivals, each with little.
std::optional<MapTie> bestTie(const std::vector<SlamLoop>& between,
                              const std::vector<SlamKeyframe>& keyframes,
                              const RunConnections& connections, const LoopParams& params,
                              double max_rival);

}  // namespace ngram_slam
