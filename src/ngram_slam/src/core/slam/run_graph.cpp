#include "ngram_slam/slam/run_graph.hpp"

#include <utility>

namespace ngram_slam {

static_assert(hyselam_pose_graph::kAgreeingWeight == kMinLoopWeight,
              "the optimizer counts the loops that the engine uses");

RunGraph runGraph(const SlamState& state, int first) {
  RunGraph run;
  run.first = first;
  hyselam_pose_graph::PoseGraph& g = run.graph;
  // The map, and a pose without edges: a loop from the map to the first keyframe joins poses that
  // do not follow each other, or it would pass for odometry.
  if (first > 0) g.poses.resize(2);
  run.offset = g.poses.size();
  const auto begin = static_cast<std::size_t>(first);
  for (std::size_t k = begin; k < state.keyframes.size(); ++k) {
    g.poses.push_back(state.keyframes[k].pose);
  }
  for (std::size_t i = 0; i < g.poses.size(); ++i) g.ids.push_back(static_cast<std::int64_t>(i));
  const auto poseOf = [&](int k) { return k - first + static_cast<int>(run.offset); };
  for (hyselam_pose_graph::PoseEdge e : state.odometry) {
    if (e.from < first || e.to < first) continue;
    e.from = poseOf(e.from);
    e.to = poseOf(e.to);
    g.edges.push_back(e);
  }
  run.odometry_edges = g.edges.size();
  for (std::size_t l = 0; l < state.loops.size(); ++l) {
    const SlamLoop& loop = state.loops[l];
    if (loop.newer < first) continue;
    hyselam_pose_graph::PoseEdge e{0, poseOf(loop.newer), loop.measured, loop.information};
    if (loop.older < first) {
      e.measured = state.keyframes[static_cast<std::size_t>(loop.older)].pose * loop.measured;
    } else {
      e.from = poseOf(loop.older);
    }
    g.edges.push_back(e);
    run.loops.push_back(l);
  }
  return run;
}

hyselam_pose_graph::OptimizeResult optimizedGraph(hyselam_pose_graph::PoseGraph graph,
                                                  const SlamParams& params) {
  using hyselam_pose_graph::GraphRobust;
  hyselam_pose_graph::OptimizeParams p;
  p.start = hyselam_pose_graph::GraphStart::kGiven;
  p.dcs_phi = params.dcs_phi;
  p.robust = params.loops == LoopClosureMode::kThesis ? GraphRobust::kNone : GraphRobust::kDcs;
  p.follow = hyselam_pose_graph::FollowLoops::kAll;
  return hyselam_pose_graph::GraphOptimizer(std::move(graph)).optimize(p);
}

}  // namespace ngram_slam
