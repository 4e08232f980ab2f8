// Work of the engine that may run on another thread: what it takes along, and taking in the result.
#include <algorithm>
#include <utility>

#include "ngram_slam/slam/slam_engine.hpp"

namespace ngram_slam {

using hyselam::Pose2;

namespace {

using hyselam_pose_graph::GraphOptimizer;
using hyselam_pose_graph::GraphRobust;
using hyselam_pose_graph::GraphStart;
using hyselam_pose_graph::OptimizeParams;
using hyselam_pose_graph::OptimizeResult;

std::size_t believed(const OptimizeResult& r) {
  return static_cast<std::size_t>(std::count_if(r.weights.begin(), r.weights.end(),
                                                [](double w) { return w >= kDoubtedWeight; }));
}

/// From the poses as they are. A loop that closes after hundreds of metres looks wrong from there,
/// however right it is: where loops would lose their weight, all are followed first, and the poses
/// that are found so are kept if more of the loops are believed there.
OptimizeResult optimise(hyselam_pose_graph::PoseGraph graph, const SlamParams& params) {
  OptimizeParams p;
  p.start = GraphStart::kGiven;
  p.dcs_phi = params.dcs_phi;
  p.robust = params.loops == SlamLoops::kThesis ? GraphRobust::kNone : GraphRobust::kDcs;
  OptimizeResult result = GraphOptimizer(graph).optimize(p);
  if (p.robust == GraphRobust::kNone || believed(result) == graph.edges.size()) return result;
  OptimizeParams all = p;
  all.start = GraphStart::kChordal;
  all.robust = GraphRobust::kNone;
  graph.poses = GraphOptimizer(graph).optimize(all).poses;
  OptimizeResult other = GraphOptimizer(std::move(graph)).optimize(p);
  return believed(other) > believed(result) ? other : result;
}

}  // namespace

std::optional<SlamJob> SlamEngine::takeJob() {
  return job(false);
}
std::optional<SlamJob> SlamEngine::takeLastJob() {
  return job(true);
}

std::optional<SlamJob> SlamEngine::job(bool last) {
  if (job_out_) return std::nullopt;
  SlamJob j;
  const auto n = static_cast<int>(state_.keyframes.size());
  if (!tasks_.empty()) {
    j.tasks.swap(tasks_);
  } else if (dirty_ && (last || urgent_ || n - optimised_keyframes_ >= params_.optimise_every)) {
    j.graph = graph();
    job_odometry_ = state_.odometry.size();
    dirty_ = urgent_ = false;
    optimised_keyframes_ = n;
  } else {
    return std::nullopt;
  }
  j.params = params_;
  job_out_ = true;
  return j;
}

SlamJobResult runJob(const SlamJob& job) {
  SlamJobResult result;
  for (const LoopTask& task : job.tasks) {
    result.answers.push_back(verifyLoop(task, job.params));
    LoopTask asked = task;
    asked.old_stretch.clear();
    asked.new_stretch.clear();
    result.tasks.push_back(std::move(asked));
  }
  if (job.graph) result.optimised = optimise(*job.graph, job.params);
  return result;
}

void SlamEngine::apply(const SlamJobResult& result) {
  job_out_ = false;
  for (std::size_t i = 0; i < result.tasks.size() && i < result.answers.size(); ++i)
    takeAnswer(result.tasks[i], result.answers[i]);
  if (!result.optimised || result.optimised->poses.empty()) return;
  const auto& optimised = *result.optimised;
  const std::size_t n = optimised.poses.size();
  // What came since moves along with the last pose that was optimised.
  const Pose2 moved = optimised.poses[n - 1] * state_.keyframes[n - 1].pose.inverse();
  for (std::size_t i = 0; i < state_.keyframes.size(); ++i) {
    Pose2& pose = state_.keyframes[i].pose;
    pose = i < n ? optimised.poses[i] : moved * pose;
  }
  pose_ = moved * pose_;
  matched_pose_ = moved * matched_pose_;
  for (std::size_t i = job_odometry_, l = 0;
       l < state_.loops.size() && i < optimised.weights.size(); ++i, ++l)
    state_.loops[l].weight = optimised.weights[i];
  relearnWays();
  rebuildLocalMap();
  ++state_.counters.optimisations;
  ++revision_;
}

}  // namespace ngram_slam
