#include "ngram_slam/slam/loop_candidates.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <utility>

namespace ngram_slam {

using hyselam::Pose2;

void GraphPathLengths::addEdge(int a, int b, double length) {
  const auto needed = static_cast<std::size_t>(std::max(a, b)) + 1;
  if (edges_.size() < needed) edges_.resize(needed);
  edges_[static_cast<std::size_t>(a)].push_back({b, static_cast<float>(length)});
  edges_[static_cast<std::size_t>(b)].push_back({a, static_cast<float>(length)});
}

std::vector<double> GraphPathLengths::from(int keyframe) const {
  return search(keyframe, nullptr);
}

std::vector<double> GraphPathLengths::from(int keyframe, const std::vector<int>& wanted) const {
  return search(keyframe, &wanted);
}

std::vector<double> GraphPathLengths::search(int keyframe, const std::vector<int>* wanted) const {
  std::vector<double> lengths(std::max(edges_.size(), static_cast<std::size_t>(keyframe) + 1),
                              std::numeric_limits<double>::infinity());
  // Dijkstra's algorithm: what leaves the queue is final.
  std::vector<bool> is_wanted(wanted == nullptr ? 0 : lengths.size(), false);
  std::size_t missing = wanted == nullptr ? std::numeric_limits<std::size_t>::max() : 0;
  for (std::size_t i = 0; wanted != nullptr && i < wanted->size(); ++i) {
    const auto k = static_cast<std::size_t>((*wanted)[i]);
    if (k >= lengths.size() || is_wanted[k]) continue;
    is_wanted[k] = true;
    ++missing;
  }
  using Open = std::pair<double, int>;
  std::priority_queue<Open, std::vector<Open>, std::greater<Open>> open;
  lengths[static_cast<std::size_t>(keyframe)] = 0.0;
  open.push({0.0, keyframe});
  while (!open.empty() && missing > 0) {
    const auto [length, at] = open.top();
    open.pop();
    const auto here = static_cast<std::size_t>(at);
    if (length > lengths[here] || here >= edges_.size()) continue;
    if (wanted != nullptr && is_wanted[here]) {
      is_wanted[here] = false;
      --missing;
    }
    for (const Edge& edge : edges_[here]) {
      const double next = length + static_cast<double>(edge.length);
      if (next >= lengths[static_cast<std::size_t>(edge.to)]) continue;
      lengths[static_cast<std::size_t>(edge.to)] = next;
      open.push({next, edge.to});
    }
  }
  return lengths;
}

std::vector<std::pair<int, double>> GraphPathLengths::within(int keyframe,
                                                             double max_length) const {
  // Asked for each keyframe of large maps: a table of all is faster than a map of those in reach.
  std::vector<double> lengths(std::max(edges_.size(), static_cast<std::size_t>(keyframe) + 1),
                              std::numeric_limits<double>::infinity());
  std::vector<int> reached{keyframe};
  using Open = std::pair<double, int>;
  std::priority_queue<Open, std::vector<Open>, std::greater<Open>> open;
  lengths[static_cast<std::size_t>(keyframe)] = 0.0;
  open.push({0.0, keyframe});
  while (!open.empty()) {
    const auto [length, at] = open.top();
    open.pop();
    const auto here = static_cast<std::size_t>(at);
    if (length > lengths[here] || here >= edges_.size()) continue;
    for (const Edge& edge : edges_[here]) {
      const double next = length + static_cast<double>(edge.length);
      double& known = lengths[static_cast<std::size_t>(edge.to)];
      if (next > max_length || next >= known) continue;
      if (std::isinf(known)) reached.push_back(edge.to);
      known = next;
      open.push({next, edge.to});
    }
  }
  std::sort(reached.begin(), reached.end());
  std::vector<std::pair<int, double>> out;
  out.reserve(reached.size());
  for (const int k : reached) out.emplace_back(k, lengths[static_cast<std::size_t>(k)]);
  return out;
}

std::vector<int> keyframesInReach(const std::vector<SlamKeyframe>& keyframes, int keyframe,
                                  const LoopParams& params) {
  const hyselam::Pose2& here = keyframes[static_cast<std::size_t>(keyframe)].pose;
  const double reach = params.max_position_uncertainty + params.visibility_margin;
  std::vector<int> found;
  for (int k = 0; k < keyframe; ++k) {
    const hyselam::Pose2& pose = keyframes[static_cast<std::size_t>(k)].pose;
    const double dx = pose.x - here.x, dy = pose.y - here.y;
    // A little more than distance() would say.
    if (dx * dx + dy * dy < reach * reach * (1.0 + 1e-9)) found.push_back(k);
  }
  return found;
}

std::vector<LoopCandidate> loopCandidates(const std::vector<SlamKeyframe>& keyframes, int keyframe,
                                          const std::vector<double>& path_lengths,
                                          const LoopParams& params) {
  struct Near {
    LoopCandidate candidate;
    double distance;
  };
  std::vector<Near> found;
  const SlamKeyframe& here = keyframes[static_cast<std::size_t>(keyframe)];
  double last_path_length = -std::numeric_limits<double>::infinity();
  int first_of_run = keyframe;
  while (first_of_run > 0 &&
         keyframes[static_cast<std::size_t>(first_of_run) - 1].run == here.run) {
    --first_of_run;
  }
  const bool has_only_begun =
      here.path_length - keyframes[static_cast<std::size_t>(first_of_run)].path_length <
      params.segment_separation;
  for (int k = 0; k < keyframe; ++k) {
    const SlamKeyframe& old = keyframes[static_cast<std::size_t>(k)];
    if (old.run == here.run && here.path_length - old.path_length < params.min_path_length) break;
    const double length = path_lengths[static_cast<std::size_t>(k)];
    if (!std::isfinite(length)) continue;
    // A run that has only begun beside an old one: its views may have little in common with those.
    if (old.run != here.run && length < params.min_path_length && has_only_begun) continue;
    const double uncertainty =
        std::min(params.max_position_uncertainty, params.positionUncertainty(length));
    const double distance_to = distance(old.pose, here.pose);
    if (distance_to >= uncertainty + params.visibility_margin) continue;
    const Near near{{k, uncertainty,
                     params.heading_uncertainty_per_meter * length + params.heading_uncertainty},
                    distance_to};
    // One candidate for each segment of the old path: its nearest keyframe.
    if (found.empty() || old.path_length - last_path_length > params.candidate_spacing) {
      found.push_back(near);
    } else if (distance_to < found.back().distance) {
      found.back() = near;
    }
    last_path_length = old.path_length;
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Near& a, const Near& b) { return a.distance < b.distance; });
  std::vector<LoopCandidate> out;
  out.reserve(found.size());
  for (const Near& n : found) out.push_back(n.candidate);
  return out;
}

bool isSamePair(const SlamLoop& a, const SlamLoop& b) {
  return a.older == b.older && a.newer == b.newer;
}

LoopInconsistency loopInconsistency(const SlamLoop& a, const SlamLoop& b,
                                    const std::vector<SlamKeyframe>& keyframes,
                                    const RunConnections& connections) {
  const auto at = [&](int k) -> const SlamKeyframe& {
    return keyframes[static_cast<std::size_t>(k)];
  };
  const auto pathLength = [&](const SlamKeyframe& one, const SlamKeyframe& other) {
    if (one.run == other.run) return std::abs(one.path_length - other.path_length);
    return connections.connected(one.run, other.run) ? distance(one.pose, other.pose)
                                                     : std::numeric_limits<double>::infinity();
  };
  LoopInconsistency result;
  result.path_length =
      std::max(pathLength(at(a.newer), at(b.newer)), pathLength(at(a.older), at(b.older)));
  int older = b.older, newer = b.newer;
  Pose2 measured = b.measured;
  if (!std::isfinite(result.path_length)) {
    // Runs of two maps may have come in turn: then the older end of the one is in the map of the
    // newer end of the other.
    std::swap(older, newer);
    measured = measured.inverse();
    result.path_length =
        std::max(pathLength(at(a.newer), at(newer)), pathLength(at(a.older), at(older)));
  }
  if (!std::isfinite(result.path_length)) return result;
  const Pose2 predicted = between(at(a.older).pose, at(older).pose) * measured *
                          between(at(newer).pose, at(a.newer).pose);
  result.distance = distance(predicted, a.measured);
  result.angle = std::abs(hyselam::normalizeAngle(predicted.theta - a.measured.theta));
  return result;
}

std::vector<std::size_t> consistentLoops(const SlamLoop& loop, const std::vector<SlamLoop>& others,
                                         const std::vector<SlamKeyframe>& keyframes,
                                         const RunConnections& connections,
                                         const LoopParams& params) {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < others.size(); ++i) {
    const LoopInconsistency c = loopInconsistency(loop, others[i], keyframes, connections);
    const double max_distance =
        params.consistency_distance + params.consistency_distance_per_meter * c.path_length;
    if (c.path_length <= params.consistency_max_path_length &&
        c.angle <= params.consistency_angle && c.distance <= max_distance) {
      out.push_back(i);
    }
  }
  return out;
}

bool isContradiction(const LoopInconsistency& c, const LoopParams& params) {
  // As much as odometry may be off between the two places.
  const double max_distance = params.positionUncertainty(c.path_length) + 1.0;
  const double max_angle = std::min(
      3.0,
      3.0 * (params.heading_uncertainty + params.heading_uncertainty_per_meter * c.path_length));
  return c.distance > max_distance || c.angle > max_angle;
}

LoopCompany companyOf(const SlamLoop& loop, const std::vector<SlamLoop>& others,
                      const std::vector<SlamKeyframe>& keyframes, const RunConnections& connections,
                      const LoopParams& params) {
  LoopCompany company{loop.inlier_ratio, 0.0};
  if (params.company_half_length <= 0.0) return company;
  const SlamKeyframe& here = keyframes[static_cast<std::size_t>(loop.newer)];
  for (const SlamLoop& other : others) {
    const SlamKeyframe& there = keyframes[static_cast<std::size_t>(other.newer)];
    if (here.run != there.run ||
        std::abs(here.path_length - there.path_length) > params.company_half_length) {
      continue;
    }
    const LoopInconsistency c = loopInconsistency(loop, other, keyframes, connections);
    if (!std::isfinite(c.path_length)) continue;
    const bool contradicts = isContradiction(c, params);
    if (!contradicts && isSamePair(loop, other)) continue;  // the same opinion
    (contradicts ? company.contradiction : company.support) += other.inlier_ratio;
  }
  return company;
}

}  // namespace ngram_slam
