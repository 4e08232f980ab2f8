#include "ngram_slam/slam/slam_score.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "hyselam_common/robot_log.hpp"

namespace ngram_slam {

using hyselam::Pose2;

namespace {
constexpr double kTolerance = 0.5;  // [s]
}

TrajectoryError trajectoryError(const std::vector<hyselam::StampedPose2>& trajectory,
                                const std::vector<hyselam::StampedPose2>& reference) {
  std::vector<std::pair<Pose2, Pose2>> pairs;  // ours, theirs
  for (const auto& p : trajectory)
    if (const auto r = hyselam::poseAt(reference, p.stamp, kTolerance))
      pairs.emplace_back(p.pose, *r);
  TrajectoryError e;
  e.poses = pairs.size();
  if (pairs.empty()) return e;
  const auto n = static_cast<double>(pairs.size());
  double ox = 0.0, oy = 0.0, rx = 0.0, ry = 0.0;
  for (const auto& [o, r] : pairs) {
    ox += o.x / n;
    oy += o.y / n;
    rx += r.x / n;
    ry += r.y / n;
  }
  double along = 0.0, across = 0.0;
  for (const auto& [o, r] : pairs) {
    along += (o.x - ox) * (r.x - rx) + (o.y - oy) * (r.y - ry);
    across += (o.x - ox) * (r.y - ry) - (o.y - oy) * (r.x - rx);
  }
  const Pose2 turned{0.0, 0.0, std::atan2(across, along)};
  const Pose2 moved = Pose2{rx, ry, 0.0} * turned * Pose2{-ox, -oy, 0.0};
  for (const auto& [o, r] : pairs) {
    const Pose2 at = moved * o;
    const double d = distance(at, r);
    e.mean += d / n;
    e.rms += d * d / n;
    e.max = std::max(e.max, d);
    e.mean_angle += std::abs(hyselam::normalizeAngle(at.theta - r.theta)) / n;
  }
  e.rms = std::sqrt(e.rms);
  std::size_t last = 0, steps = 0;
  double path_length = 0.0;
  for (std::size_t i = 1; i < pairs.size(); ++i) {
    path_length += distance(pairs[i - 1].second, pairs[i].second);
    if (path_length < 1.0) continue;
    const Pose2 off = between(between(pairs[last].second, pairs[i].second),
                              between(pairs[last].first, pairs[i].first));
    e.mean_step += std::hypot(off.x, off.y);
    e.mean_step_angle += std::abs(off.theta);
    ++steps;
    last = i;
    path_length = 0.0;
  }
  if (steps > 0) {
    e.mean_step /= static_cast<double>(steps);
    e.mean_step_angle /= static_cast<double>(steps);
  }
  return e;
}

std::optional<LoopError> loopError(const SlamKeyframe& older, const SlamKeyframe& newer,
                                   const Pose2& measured,
                                   const std::vector<hyselam::StampedPose2>& reference) {
  const auto a = hyselam::poseAt(reference, older.stamp, kTolerance);
  const auto b = hyselam::poseAt(reference, newer.stamp, kTolerance);
  if (!a || !b) return std::nullopt;
  const Pose2 off = between(between(*a, *b), measured);
  return LoopError{std::hypot(off.x, off.y), std::abs(off.theta)};
}

}  // namespace ngram_slam
