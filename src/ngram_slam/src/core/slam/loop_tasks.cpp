#include "ngram_slam/slam/loop_tasks.hpp"

#include <algorithm>
#include <limits>

#include "ngram_slam/slam/path_segment.hpp"

namespace ngram_slam {

using hyselam::Pose2;

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The newer segment must not be compared with itself [m of path].
double endOfOlder(const std::vector<SlamKeyframe>& keyframes, int older, int newer,
                  const LoopParams& params) {
  const SlamKeyframe& there = keyframes[static_cast<std::size_t>(older)];
  const SlamKeyframe& here = keyframes[static_cast<std::size_t>(newer)];
  return there.run == here.run ? here.path_length - params.segment_separation : kInfinity;
}

}  // namespace

LoopTask farLoopTask(const std::vector<SlamKeyframe>& keyframes, int older, int newer,
                     const LoopParams& params) {
  LoopTask task;
  task.older = older;
  task.newer = newer;
  task.far = task.any_heading = true;
  task.source = LoopSource::kSignature;
  task.window = params.signature_search_window;
  task.angle = std::min(params.signature_search_angle, hyselam::kPi);
  task.old_segment = segmentAround(keyframes, older, params.far_old_segment_half_length,
                                   endOfOlder(keyframes, older, newer, params));
  task.new_segment = segmentAround(keyframes, newer, params.far_new_segment_half_length, kInfinity);
  return task;
}

LoopTask nearLoopTask(const std::vector<SlamKeyframe>& keyframes, int older, int newer,
                      double uncertainty, const LoopParams& params) {
  const SlamKeyframe& from = keyframes[static_cast<std::size_t>(older)];
  const SlamKeyframe& to = keyframes[static_cast<std::size_t>(newer)];
  LoopTask task;
  task.older = older;
  task.newer = newer;
  task.initial_guess = between(from.pose, to.pose);
  task.window = uncertainty;
  task.angle = std::min(params.near_search_angle, hyselam::kPi);
  task.old_segment = segmentAround(keyframes, older, params.near_segment_half_length,
                                   endOfOlder(keyframes, older, newer, params));
  task.new_segment.push_back(
      {Pose2{}, to.points, {to.scan->laser_in_base.x, to.scan->laser_in_base.y}});
  return task;
}

LoopTask stepTask(const std::vector<SlamKeyframe>& keyframes, int k,
                  const StepCheckParams& params) {
  const auto at = [&](int i) -> const SlamKeyframe& {
    return keyframes[static_cast<std::size_t>(i)];
  };
  const SlamKeyframe &before = at(k - 1), &behind = at(k);
  LoopTask task;
  task.older = k - 1;
  task.newer = k;
  task.far = task.step = true;
  task.initial_guess = between(before.pose, behind.pose);
  task.window = params.window;
  task.angle = std::min(params.angle, hyselam::kPi);
  task.old_segment = segmentAround(keyframes, k - 1, params.path_before, before.path_length);
  const auto end = static_cast<int>(keyframes.size());
  for (int i = k; i < end && at(i).run == behind.run &&
                  at(i).path_length - behind.path_length <= params.path_behind;
       ++i) {
    task.new_segment.push_back({between(behind.pose, at(i).pose),
                                at(i).points,
                                {at(i).scan->laser_in_base.x, at(i).scan->laser_in_base.y}});
  }
  return task;
}

}  // namespace ngram_slam
