// Optimization that rejects false loops, from more than one start.
#pragma once

#include "hyselam_pose_graph/graph_optimizer.hpp"
#include "pose_system.hpp"

namespace hyselam_pose_graph {

/// DCS or GNC, with the other starts of OptimizeParams::follow.
OptimizeResult solveRobust(const PoseGraph& graph, const PoseSystem& system,
                           const OptimizeParams& params);

}  // namespace hyselam_pose_graph
