// What other optimisers make of the published graphs.
#pragma once

#include <string>
#include <vector>

#include "hyselam_pose_graph/pose_graph.hpp"

namespace pose_graph_bench {

/// One optimiser with one setting on one graph.
struct PeerRun {
  std::string peer, setting;
  double seconds = 0.0;  ///< CPU time of the optimisation alone, ordering included
  double cost = 0.0;     ///< sum of e^T Omega e where it ended
  int iterations = 0;
  std::string failed;  ///< why there is no result; empty: there is one
};

/// Ceres, where the program was built with it; else empty.
std::vector<PeerRun> runCeres(const hyselam_pose_graph::PoseGraph& graph);

}  // namespace pose_graph_bench
