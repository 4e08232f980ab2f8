// Poses in spite of false loops.
#pragma once

#include "hyselam_pose_graph/graph_optimizer.hpp"
#include "pose_system.hpp"

namespace hyselam_pose_graph {

/// Graduated non-convexity (Yang et al. 2020) with truncated least squares, in stages each of which
/// has a linear system for a global solver, as the method wants. It begins with the loops that
/// other loops confirm (findCompany), or, where there are none, with what annealing of the
/// rotations alone leaves from odometry on; these with rotations and positions relaxed in turn;
/// then the full cost, with every loop back that fits by then. Loops that lost their weight leave
/// the linear system too: false ones tie everything to everything and make it dense.
OptimizeResult solveGnc(const PoseGraph& graph, const PoseSystem& system,
                        const OptimizeParams& params);

}  // namespace hyselam_pose_graph
