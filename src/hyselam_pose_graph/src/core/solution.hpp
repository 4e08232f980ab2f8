// One optimization from one start.
#pragma once

#include "hyselam_pose_graph/graph_optimizer.hpp"
#include "pose_system.hpp"

namespace hyselam_pose_graph {

/// Least squares, or dynamic covariance scaling with GraphRobust::kDcs. `given`: the poses of
/// GraphStart::kGiven.
OptimizeResult solveGraph(const PoseGraph& graph, const PoseSystem& system,
                          const OptimizeParams& params, const std::vector<hyselam::Pose2>& given);

}  // namespace hyselam_pose_graph
