// What would tie two maps together, and how sure that is.
#pragma once

#include <optional>
#include <vector>

#include "ngram_slam/slam/run_connections.hpp"
#include "ngram_slam/slam/slam_params.hpp"
#include "ngram_slam/slam/slam_types.hpp"

namespace ngram_slam {

struct MapTie {
  std::vector<SlamLoop> loops;  ///< that are believed, of the group that decides
  double support = 0.0;         ///< sum of the inlier ratios of that group
  double rival = 0.0;           ///< of the best group of the other loops
};

/// The best tie of two maps by the verified far loops between them: of the groups of which no two
/// loops contradict each other, and at least one is believed (believeFarLoops()), the one with most
/// support. None if no loop is believed, or if the best group of the others has more than
/// `max_rival` of its support. Buildings that repeat themselves have many such groups, each with
/// little.
std::optional<MapTie> bestTie(const std::vector<SlamLoop>& between,
                              const std::vector<SlamKeyframe>& keyframes,
                              const RunConnections& connections, const LoopParams& params,
                              double max_rival);

}  // namespace ngram_slam
