// Loops that confirm each other.
#pragma once

#include <vector>

#include "hyselam_pose_graph/pose_graph.hpp"

namespace hyselam_pose_graph {

/// How far loops agree with loops beside them, seen along short pieces of odometry alone.
struct LoopCompany {
  /// For each edge, how many others agree with it; 0 for odometry.
  std::vector<int> companions;
  /// Median squared error of agreement, as a part of what the information says it should be: below
  /// 1 where the edges are better than they say.
  double scale = 1.0;
};

/// Two loops whose ends lie within `reach` poses of each other close a small cycle: odometry, loop,
/// odometry, loop back. They agree if its squared error is below `limit` (chi^2 of three degrees of
/// freedom). Loops of a robot that drives along a known street come in such company (as in
/// consistency-checked groups: Olson 2009, Mangelsdorf et al. 2018); false ones mostly do not.
LoopCompany findCompany(const PoseGraph& graph, double limit, int reach);

}  // namespace hyselam_pose_graph
