// Steps of the path whose scan had to be searched: asked again with what was seen behind them.
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "ngram_slam/slam/loop_tasks.hpp"
#include "ngram_slam/slam/slam_engine.hpp"

namespace ngram_slam {

using hyselam::between;
using hyselam::Pose2;

namespace {

// Smaller changes are left to the graph.
constexpr double kLeastDistance = 0.15;  // [m]
constexpr double kLeastTurn = 0.05;      // [rad]

Eigen::Vector3d vectorOf(const Pose2& p) {
  return {p.x, p.y, p.theta};
}

}  // namespace

/// Before the keyframe at the pose is added.
void SlamEngine::noteStep(const Motion& motion) {
  // Where odometry failed nothing is known of the step but what the scan said.
  if (params_.step_check.path_behind <= 0.0 || !doubt_.searched || doubt_.since_keyframe ||
      motion.jump) {
    return;
  }
  doubt_.steps.push_back(lastKeyframe() + 1);
}

/// The next step behind which enough path is known.
std::optional<LoopTask> SlamEngine::stepToCheck() {
  if (doubt_.steps.empty()) return std::nullopt;
  const int k = doubt_.steps.front();
  if (state_.keyframes.back().path_length - keyframe(k).path_length <
      params_.step_check.path_behind) {
    return std::nullopt;
  }
  doubt_.steps.pop_front();
  ++doubt_.road.steps_checked;
  return stepTask(state_.keyframes, k, params_.step_check);
}

/// Changes the step where the scans of both sides contradict it, to what they and odometry say
/// together, and moves what came behind it.
void SlamEngine::applyStep(const LoopTask& task, const LoopVerification& answer) {
  const SlamKeyframe &before = keyframe(task.older), &behind = keyframe(task.newer);
  if (!answer.verified || behind.run != currentRun()) return;
  const auto edge =
      std::find_if(state_.odometry.rbegin(), state_.odometry.rend(),
                   [&](const auto& e) { return e.from == task.older && e.to == task.newer; });
  if (edge == state_.odometry.rend()) return;
  const Pose2& found = answer.loop.measured;
  const Eigen::Matrix3d& by_scans = answer.loop.information;
  const Pose2 error = between(found, edge->measured);
  const Eigen::Vector3d e = vectorOf(error);
  const double deviations = params_.step_check.min_deviations;
  if ((std::hypot(error.x, error.y) < kLeastDistance && std::abs(error.theta) < kLeastTurn) ||
      e.dot(by_scans * e) < deviations * deviations) {
    return;
  }
  // Along a bare corridor the scans know little.
  const Pose2 told = between(before.odometry, behind.odometry);
  const Eigen::Matrix3d by_odometry =
      params_.odometry_information_scale * odometry_noise_.noise().information(told);
  const Eigen::Matrix3d both = by_scans + by_odometry;
  const Eigen::Vector3d shift = both.ldlt().solve(by_odometry * vectorOf(between(found, told)));
  edge->measured = found * Pose2{shift.x(), shift.y(), shift.z()};
  edge->information = 0.5 * (both + both.transpose());
  ++doubt_.road.steps_mended;

  const Pose2 correction = before.pose * edge->measured * behind.pose.inverse();
  for (auto k = static_cast<std::size_t>(task.newer); k < state_.keyframes.size(); ++k) {
    state_.keyframes[k].pose = correction * state_.keyframes[k].pose;
  }
  pose_ = correction * pose_;
  matched_pose_ = correction * matched_pose_;
  rebuildLocalMap();
  if (!state_.loops.empty()) loops_changed_ = true;
  ++revision_;
}

}  // namespace ngram_slam
