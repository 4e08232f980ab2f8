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
  /// Sums of the inlier ratios of all loops between both maps that may be right if the first one
  /// is, and of those that cannot be.
  double support = 0.0, contradiction = 0.0;
};

/// The best tie of two maps by the verified far loops between them: of the loops that are believed
/// (believeFarLoops()) the one with most support. None if none is believed, or if more than
/// `max_contradiction` of its support contradicts it.
std::optional<MapTie> bestTie(const std::vector<SlamLoop>& between,
                              const std::vector<SlamKeyframe>& keyframes,
                              const RunConnections& connections, const LoopParams& params,
                              double max_contradiction);

}  // namespace ngram_slam
