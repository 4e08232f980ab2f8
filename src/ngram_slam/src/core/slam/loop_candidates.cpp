#include "ngram_slam/slam/loop_candidates.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <utility>

namespace ngram_slam {

using hyselam::Pose2;

void GraphWays::add(int a, int b, double way) {
  const auto needed = static_cast<std::size_t>(std::max(a, b)) + 1;
  if (ways_.size() < needed) ways_.resize(needed);
  ways_[static_cast<std::size_t>(a)].push_back({b, static_cast<float>(way)});
  ways_[static_cast<std::size_t>(b)].push_back({a, static_cast<float>(way)});
}

std::vector<double> GraphWays::from(int keyframe) const {
  std::vector<double> length(std::max(ways_.size(), static_cast<std::size_t>(keyframe) + 1),
                             std::numeric_limits<double>::infinity());
  using Open = std::pair<double, int>;
  std::priority_queue<Open, std::vector<Open>, std::greater<Open>> open;
  length[static_cast<std::size_t>(keyframe)] = 0.0;
  open.push({0.0, keyframe});
  while (!open.empty()) {
    const auto [done, at] = open.top();
    open.pop();
    if (done > length[static_cast<std::size_t>(at)] || static_cast<std::size_t>(at) >= ways_.size())
      continue;
    for (const Way& w : ways_[static_cast<std::size_t>(at)]) {
      const double next = done + static_cast<double>(w.length);
      if (next >= length[static_cast<std::size_t>(w.to)]) continue;
      length[static_cast<std::size_t>(w.to)] = next;
      open.push({next, w.to});
    }
  }
  return length;
}

std::vector<LoopCandidate> loopCandidates(const std::vector<SlamKeyframe>& keyframes, int keyframe,
                                          const std::vector<double>& ways,
                                          const LoopParams& params) {
  struct Near {
    LoopCandidate candidate;
    double distance;
  };
  std::vector<Near> found;
  const SlamKeyframe& here = keyframes[static_cast<std::size_t>(keyframe)];
  double last_way = -std::numeric_limits<double>::infinity();
  constexpr double kGap = 3.0;  // [m] of way between two stretches
  for (int k = 0; k < keyframe; ++k) {
    const SlamKeyframe& old = keyframes[static_cast<std::size_t>(k)];
    if (old.run == here.run && here.way - old.way < params.least_way) break;
    const double way = ways[static_cast<std::size_t>(k)];
    if (!std::isfinite(way)) continue;
    // A run that has only begun beside an old one: its views may have little in common with those.
    if (old.run != here.run && way < params.least_way) continue;
    const double reach = std::min(params.most_uncertainty, params.reach(way));
    const double d = distance(old.pose, here.pose);
    // Two metres beside the old way its surfaces are still seen.
    if (d >= reach + 2.0) continue;
    const Near near{{k, reach, params.turn_growth * way + 0.1}, d};
    if (found.empty() || old.way - last_way > kGap)
      found.push_back(near);
    else if (d < found.back().distance)
      found.back() = near;
    last_way = old.way;
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Near& a, const Near& b) { return a.distance < b.distance; });
  std::vector<LoopCandidate> out;
  out.reserve(found.size());
  for (const Near& n : found) out.push_back(n.candidate);
  return out;
}

LoopContradiction contradiction(const SlamLoop& a, const SlamLoop& b,
                                const std::vector<SlamKeyframe>& keyframes) {
  const auto at = [&](int k) -> const SlamKeyframe& {
    return keyframes[static_cast<std::size_t>(k)];
  };
  LoopContradiction c;
  if (at(a.newer).run != at(b.newer).run || at(a.older).run != at(b.older).run) {
    c.way = std::numeric_limits<double>::infinity();
    return c;
  }
  c.way = std::max(std::abs(at(a.newer).way - at(b.newer).way),
                   std::abs(at(a.older).way - at(b.older).way));
  const Pose2 foretold = between(at(a.older).pose, at(b.older).pose) * b.measured *
                         between(at(b.newer).pose, at(a.newer).pose);
  c.distance = distance(foretold, a.measured);
  c.turn = std::abs(hyselam::normalizeAngle(foretold.theta - a.measured.theta));
  return c;
}

std::vector<std::size_t> agreeing(const SlamLoop& loop, const std::vector<SlamLoop>& others,
                                  const std::vector<SlamKeyframe>& keyframes,
                                  const LoopParams& params) {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < others.size(); ++i) {
    const LoopContradiction c = contradiction(loop, others[i], keyframes);
    if (c.way <= params.company_way && c.turn <= params.agreement_turn &&
        c.distance <= params.agreement + params.agreement_growth * c.way)
      out.push_back(i);
  }
  return out;
}

}  // namespace ngram_slam
