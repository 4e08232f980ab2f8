#include "ngram_slam/slam/map_ties.hpp"

#include <algorithm>
#include <cmath>

#include "ngram_slam/slam/far_loops.hpp"
#include "ngram_slam/slam/loop_candidates.hpp"

namespace ngram_slam {

namespace {

/// The loops that are believed if all others are known, whichever came first.
std::vector<SlamLoop> believedOf(const std::vector<SlamLoop>& between,
                                 const std::vector<SlamKeyframe>& keyframes,
                                 const RunConnections& connections, const LoopParams& params) {
  const double reach = params.company_half_length + params.consistency_max_path_length;
  const auto pathLengthAt = [&](const SlamLoop& l) {
    return keyframes[static_cast<std::size_t>(l.newer)].path_length;
  };
  std::vector<SlamLoop> believed;
  std::vector<double> judged;  // path lengths around which all loops were
  for (std::size_t i = 0; i < between.size(); ++i) {
    const double here = pathLengthAt(between[i]);
    if (std::any_of(judged.begin(), judged.end(),
                    [&](double j) { return std::abs(j - here) <= reach; })) {
      continue;
    }
    judged.push_back(here);
    std::vector<SlamLoop> waiting;
    for (std::size_t k = 0; k < between.size(); ++k) {
      const bool known = std::any_of(believed.begin(), believed.end(),
                                     [&](const SlamLoop& l) { return isSamePair(l, between[k]); });
      if (k != i && !known && !isSamePair(between[k], between[i])) waiting.push_back(between[k]);
    }
    for (const SlamLoop& l :
         believeFarLoops(between[i], {}, keyframes, connections, params, &waiting)) {
      believed.push_back(l);
    }
  }
  return believed;
}

}  // namespace

std::optional<MapTie> bestTie(const std::vector<SlamLoop>& between,
                              const std::vector<SlamKeyframe>& keyframes,
                              const RunConnections& connections, const LoopParams& params,
                              double max_rival) {
  const auto contradict = [&](const SlamLoop& a, const SlamLoop& b) {
    return isContradiction(loopInconsistency(a, b, keyframes, connections), params);
  };
  const std::vector<SlamLoop> believed = believedOf(between, keyframes, connections, params);
  const SlamLoop* best = nullptr;
  MapTie tie;
  for (const SlamLoop& candidate : believed) {
    double support = 0.0;
    for (const SlamLoop& other : between) {
      if (!contradict(candidate, other)) support += other.inlier_ratio;
    }
    if (best != nullptr && support <= tie.support) continue;
    best = &candidate;
    tie.support = support;
  }
  if (best == nullptr) return std::nullopt;
  std::vector<const SlamLoop*> with, against;
  for (const SlamLoop& l : between) (contradict(*best, l) ? against : with).push_back(&l);
  for (const SlamLoop* rival : against) {
    // What speaks for one of the two only.
    double for_rival = 0.0, for_best = 0.0;
    for (const SlamLoop* l : against) {
      if (!contradict(*rival, *l)) for_rival += l->inlier_ratio;
    }
    for (const SlamLoop* l : with) {
      if (contradict(*rival, *l)) for_best += l->inlier_ratio;
    }
    if (for_rival > max_rival * for_best) return std::nullopt;
    tie.rival = std::max(tie.rival, for_rival);
  }
  tie.loops.push_back(*best);
  for (const SlamLoop& l : believed) {
    if (!isSamePair(l, *best) && !contradict(*best, l)) tie.loops.push_back(l);
  }
  return tie;
}

}  // namespace ngram_slam
