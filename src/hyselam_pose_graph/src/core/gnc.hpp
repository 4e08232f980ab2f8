// Graduated non-convexity: optimization that rejects false loops.
#pragma once

#include "hyselam_pose_graph/graph_optimizer.hpp"
#include "pose_system.hpp"

namespace hyselam_pose_graph {

/// Graduated non-convexity (Yang et al. 2020) with truncated least squares, in stages that each
/// have a linear system as global solver, as the method requires. The first stage takes the loops
/// that other loops support (findConsistentLoops) or, if there are none, those that annealing of
/// the rotations alone keeps, starting from odometry; it solves rotations and positions in turn.
/// The following stages minimize the full cost and take back each loop that fits. Rejected loops
/// leave the linear system too: false ones would make it dense.
OptimizeResult solveGnc(const PoseGraph& graph, const PoseSystem& system,
                        const OptimizeParams& params);

/// The same with the loops that agree with a known solution (kAgreeingWeight) in the first stage,
/// starting there.
OptimizeResult solveGncFrom(const OptimizeResult& known, const PoseGraph& graph,
                            const PoseSystem& system, const OptimizeParams& params);

}  // namespace hyselam_pose_graph
