#include <cmath>

#include "hyselam_common/errors.hpp"
#include "ngram_slam/slam/input_checks.hpp"
#include "ngram_slam/slam/slam_types.hpp"

namespace ngram_slam {

namespace {

constexpr std::uint32_t kMaxRuns = 1000000;
constexpr double kMaxReach = 1e4;  // [m]

/// Whether keyframes, edges and loops fit together.
const char* graphError(const SlamState& state) {
  const auto n = static_cast<int>(state.keyframes.size());
  const auto exists = [n](int k) { return k >= 0 && k < n; };
  std::uint32_t run = 0;
  for (const SlamKeyframe& k : state.keyframes) {
    if (k.run < run) return "a keyframe belongs to an earlier run than the one before it";
    run = k.run;
    if (!k.scan || !k.points || !k.pose.isFinite() || !k.odometry.isFinite()) {
      return "a keyframe lacks its scan or pose";
    }
    if (poseError(k.pose) != nullptr || poseError(k.odometry) != nullptr) {
      return "a keyframe is more than 10000 km from the origin";
    }
    if (const char* reason = scanError(*k.scan)) return reason;
  }
  for (const PlacedScan& p : state.scans) {
    if (!exists(p.keyframe)) return "a scan has no keyframe";
  }
  for (const hyselam_pose_graph::PoseEdge& e : state.odometry) {
    if (!exists(e.from) || !exists(e.to) || e.from == e.to) return "an edge lacks its keyframes";
  }
  for (const auto* loops : {&state.loops, &state.pending_loops}) {
    for (const SlamLoop& l : *loops) {
      if (!exists(l.older) || !exists(l.newer) || l.older == l.newer) {
        return "a loop lacks its keyframes";
      }
    }
  }
  if (run > kMaxRuns) return "it has too many runs";
  if (!(state.settled.cell >= 0.001 && state.settled.cell <= 10.0)) {
    return "cells of the settled map are not 1 mm to 10 m wide";
  }
  for (const SettledCell& c : state.settled.cells) {
    if (!exists(c.keyframe)) return "a settled cell has no keyframe";
    if (!(std::hypot(c.center.x, c.center.y) < kMaxReach)) {
      return "a settled cell is more than 10 km from its keyframe";
    }
  }
  return nullptr;
}

/// Whether matches and observations refer to keyframes that exist.
const char* wordsError(const SlamState& state) {
  const auto n = static_cast<int>(state.keyframes.size());
  const auto exists = [n](int k) { return k >= 0 && k < n; };
  const std::size_t observations = state.corpus.observations.size();
  for (const SlamMatch& m : state.matches) {
    if (!exists(m.keyframe_newer) || !exists(m.keyframe_older) || m.newer >= observations ||
        m.older >= observations) {
      return "a match lacks its keyframes or observations";
    }
  }
  for (const std::int32_t k : state.keyframe_of_observation) {
    if (!exists(k)) return "an observation has no keyframe";
  }
  if (state.keyframe_of_observation.size() != observations) {
    return "observations and their keyframes differ in number";
  }
  return nullptr;
}

}  // namespace

const char* SlamState::error() const {
  const char* graph = graphError(*this);
  return graph != nullptr ? graph : wordsError(*this);
}

void SlamState::validate() const {
  if (const char* reason = error()) throw hyselam::InputError("SLAM state", "", reason);
}

}  // namespace ngram_slam
