// The graph of one run in a map that is held: what most optimizations need of a large map.
#pragma once

#include <cstddef>
#include <vector>

#include "hyselam_pose_graph/graph_optimizer.hpp"
#include "hyselam_pose_graph/pose_graph.hpp"
#include "ngram_slam/slam/slam_params.hpp"
#include "ngram_slam/slam/slam_types.hpp"

namespace ngram_slam {

/// A part of the graph of a state: the keyframes from `first` on. Those before stay where they are:
/// a loop to one of them ties its other end to the map itself, which is the first pose.
struct RunGraph {
  hyselam_pose_graph::PoseGraph graph;  ///< edges of odometry, followed by loops
  int first = 0;                        ///< keyframe
  std::size_t offset = 0;               ///< of its pose in the graph
  std::size_t odometry_edges = 0;
  std::vector<std::size_t> loops;  ///< of the state, in the order of their edges
};

/// The whole graph for `first` 0.
RunGraph runGraph(const SlamState& state, int first);

/// Optimized robustly from the poses as they are, and where loops would lose their weight also from
/// all of them.
hyselam_pose_graph::OptimizeResult optimizedGraph(hyselam_pose_graph::PoseGraph graph,
                                                  const SlamParams& params);

}  // namespace ngram_slam
