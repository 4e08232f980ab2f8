// Work of the engine that may run on another thread: making it, running it, applying the result.
#include <algorithm>
#include <iterator>
#include <utility>

#include "ngram_slam/slam/slam_engine.hpp"

namespace ngram_slam {

using hyselam::Pose2;

namespace {

// A job is made of no fewer, about 2 m of path.
constexpr std::size_t kKeyframesToSign = 8;

}  // namespace

std::optional<SlamJob> SlamEngine::takeJob() {
  return makeJob(false);
}
std::optional<SlamJob> SlamEngine::takeFinalJob() {
  return makeJob(true);
}

std::optional<SlamJob> SlamEngine::makeJob(bool final) {
  if (job_pending_) return std::nullopt;
  SlamJob job;
  if (auto step = stepToCheck()) {
    // One at a time: what it changes, the next one sees. What is built on the path comes later.
    job.tasks.push_back(*std::move(step));
  } else if (!tasks_.empty()) {
    job.tasks.swap(tasks_);
  } else if (place_question_) {
    job.place = std::exchange(place_question_, std::nullopt);
  } else if (mustSign(final)) {
    addKeyframesTo(&job);
  } else if (mustOptimize(final)) {
    addGraphTo(&job, final);
  }
  return sendOut(std::move(job));
}

std::optional<SlamJob> SlamEngine::takeAllWork() {
  if (job_pending_) return std::nullopt;
  SlamJob job;
  while (auto step = stepToCheck()) job.tasks.push_back(*std::move(step));
  std::move(tasks_.begin(), tasks_.end(), std::back_inserter(job.tasks));
  tasks_.clear();
  job.place = std::exchange(place_question_, std::nullopt);
  if (mustSign(false)) addKeyframesTo(&job);
  if (mustOptimize(false)) addGraphTo(&job, false);
  return sendOut(std::move(job));
}

bool SlamEngine::mustSign(bool final) const {
  return keyframes_to_sign_.size() >= kKeyframesToSign || run_to_end_ ||
         (final && !keyframes_to_sign_.empty());
}

void SlamEngine::addKeyframesTo(SlamJob* job) {
  job->keyframes.swap(keyframes_to_sign_);
  job->ends_run = run_to_end_;
  job->signatures = signatures_;
  job->ask_each = isUntied();
  run_to_end_ = false;
}

bool SlamEngine::mustOptimize(bool final) const {
  const int fresh = static_cast<int>(state_.keyframes.size()) - optimized_keyframes_;
  return loops_changed_ && (final || optimize_now_ || fresh >= params_.optimize_interval);
}

void SlamEngine::addGraphTo(SlamJob* job, bool final) {
  // A map that is known stays where it is while a run goes on in it, unless far loops move it.
  const bool in_known_map =
      run_open_ && !final && !optimize_now_ && params_.loops != LoopClosureMode::kThesis;
  job_graph_ = runGraph(state_, in_known_map ? first_of_run_ : 0);
  job->graph = std::move(job_graph_.graph);
  loops_changed_ = optimize_now_ = false;
  optimized_keyframes_ = static_cast<int>(state_.keyframes.size());
}

/// Nothing, if there is nothing in it.
std::optional<SlamJob> SlamEngine::sendOut(SlamJob job) {
  if (job.tasks.empty() && !job.graph && job.signatures == nullptr && !job.place) {
    return std::nullopt;
  }
  job.params = params_;
  job_pending_ = true;
  return job;
}

SlamJobResult runJob(const SlamJob& job) {
  SlamJobResult result;
  for (const LoopTask& task : job.tasks) {
    result.verifications.push_back(task.step ? verifyStep(task, job.params)
                                             : verifyLoop(task, job.params));
    LoopTask done = task;
    done.old_segment.clear();
    done.new_segment.clear();
    result.tasks.push_back(std::move(done));
  }
  if (job.graph) result.optimized = optimizedGraph(*job.graph, job.params);
  if (job.place) {
    result.place = PlaceAnswer{job.place->keyframe, job.place->middle,
                               job.place->maps->find(job.place->scans)};
  }
  if (job.signatures == nullptr) return result;
  const auto take = [&](const std::vector<SignatureCandidate>& candidates) {
    result.candidates.insert(result.candidates.end(), candidates.begin(), candidates.end());
  };
  job.signatures->askEach(job.ask_each);
  for (const SignatureKeyframe& k : job.keyframes) take(job.signatures->add(k));
  if (job.ends_run) take(job.signatures->endRun());
  return result;
}

void SlamEngine::apply(const SlamJobResult& result) {
  job_pending_ = false;
  // First, as its graph is the one that the job was made of.
  if (result.optimized && !result.optimized->poses.empty()) applyOptimized(*result.optimized);
  for (std::size_t i = 0; i < result.tasks.size() && i < result.verifications.size(); ++i) {
    applyVerification(result.tasks[i], result.verifications[i]);
  }
  searchSignatureLoops(result.candidates);
  if (result.place) applyPlace(*result.place);
}

void SlamEngine::applyOptimized(const hyselam_pose_graph::OptimizeResult& optimized) {
  const auto first = static_cast<std::size_t>(job_graph_.first);
  const std::size_t n = first + optimized.poses.size() - job_graph_.offset;
  // What came since moves along with the last pose that was optimized.
  const Pose2 correction = optimized.poses.back() * state_.keyframes[n - 1].pose.inverse();
  for (std::size_t i = first; i < state_.keyframes.size(); ++i) {
    Pose2& pose = state_.keyframes[i].pose;
    pose = i < n ? optimized.poses[i - first + job_graph_.offset] : correction * pose;
  }
  pose_ = correction * pose_;
  matched_pose_ = correction * matched_pose_;
  for (std::size_t i = 0; i < job_graph_.loops.size(); ++i) {
    const std::size_t edge = job_graph_.odometry_edges + i;
    if (edge < optimized.weights.size()) {
      state_.loops[job_graph_.loops[i]].weight = optimized.weights[edge];
    }
  }
  const bool was_tied = run_.tied.has_value();
  refreshConnections();
  if (was_tied && !run_.tied) ++ties_withdrawn_;
  rebuildPathLengths();
  rebuildLocalMap();
  ++state_.counters.optimizations;
  ++revision_;
}

}  // namespace ngram_slam
