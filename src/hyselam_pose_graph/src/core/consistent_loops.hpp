// Loops that are consistent with one another: pairwise consistency as in Olson 2009 and PCM
// (Mangelson et al. 2018), between neighboring loops only.
#pragma once

#include <vector>

#include "hyselam_pose_graph/pose_graph.hpp"

namespace hyselam_pose_graph {

struct ConsistentLoops {
  /// For each edge, the number of other loops that are consistent with it; 0 for odometry edges.
  std::vector<int> support;
  /// Median squared error of the consistent pairs divided by the median of chi^2: below 1 where the
  /// edges are more accurate than their information says.
  double error_scale = 1.0;
};

/// Two loops whose ends lie at most `max_distance` poses apart close a small cycle: odometry, loop,
/// odometry, loop back. They are consistent if its squared Mahalanobis error is at most
/// `max_squared_error` (chi^2 with three degrees of freedom). A robot that drives along a known
/// corridor closes many loops consistent with one another; false loops rarely are.
ConsistentLoops findConsistentLoops(const PoseGraph& graph, double max_squared_error,
                                    int max_distance);

}  // namespace hyselam_pose_graph
