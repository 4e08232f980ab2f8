#include "ngram_slam/slam/map_ties.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

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
    for (const SlamLoop& l : believeFarLoops(between[i], {}, keyframes, connections, params,
                                             &waiting, std::numeric_limits<std::size_t>::max())) {
      believed.push_back(l);
    }
  }
  return believed;
}

// Loops that a group is begun with: those that most others may agree with.
constexpr std::size_t kMostBeginnings = 30;

/// Loops of which no two contradict each other.
struct Group {
  std::vector<std::size_t> loops;
  double support = 0.0;  // sum of the inlier ratios
};

/// Who contradicts whom.
class Contradictions {
 public:
  Contradictions(const std::vector<SlamLoop>& loops, const std::vector<SlamKeyframe>& keyframes,
                 const RunConnections& connections, const LoopParams& params)
      : loops_(loops), all_(loops.size(), std::vector<bool>(loops.size(), false)) {
    for (std::size_t a = 0; a < loops.size(); ++a) {
      for (std::size_t b = 0; b < a; ++b) {
        const LoopInconsistency c = loopInconsistency(loops[a], loops[b], keyframes, connections);
        all_[a][b] = all_[b][a] = isContradiction(c, params);
      }
      paths_.push_back(keyframes[static_cast<std::size_t>(loops[a].newer)].path_length);
    }
  }

  /// The largest group of those of `from`, begun with one of `beginnings`.
  Group best(const std::vector<std::size_t>& beginnings,
             const std::vector<std::size_t>& from) const {
    std::vector<std::pair<double, std::size_t>> order;  // by how many may agree
    for (const std::size_t b : beginnings) {
      double agree = 0.0;
      for (const std::size_t l : from) agree += all_[b][l] ? 0.0 : loops_[l].inlier_ratio;
      order.emplace_back(-agree, b);
    }
    std::sort(order.begin(), order.end());
    Group best;
    for (std::size_t i = 0; i < std::min(order.size(), kMostBeginnings); ++i) {
      const Group group = around(order[i].second, from);
      if (group.support > best.support) best = group;
    }
    return best;
  }

 private:
  /// The nearest ones first: of these is known best whether they contradict.
  Group around(std::size_t beginning, std::vector<std::size_t> from) const {
    std::stable_sort(from.begin(), from.end(), [&](std::size_t a, std::size_t b) {
      return std::abs(paths_[a] - paths_[beginning]) < std::abs(paths_[b] - paths_[beginning]);
    });
    Group group{{beginning}, loops_[beginning].inlier_ratio};
    for (const std::size_t l : from) {
      if (l == beginning || std::any_of(group.loops.begin(), group.loops.end(),
                                        [&](std::size_t g) { return all_[g][l]; })) {
        continue;
      }
      group.loops.push_back(l);
      group.support += loops_[l].inlier_ratio;
    }
    return group;
  }

  const std::vector<SlamLoop>& loops_;
  std::vector<std::vector<bool>> all_;
  std::vector<double> paths_;
};

bool contains(const std::vector<std::size_t>& all, std::size_t one) {
  return std::find(all.begin(), all.end(), one) != all.end();
}

}  // namespace

std::optional<MapTie> bestTie(const std::vector<SlamLoop>& between,
                              const std::vector<SlamKeyframe>& keyframes,
                              const RunConnections& connections, const LoopParams& params,
                              double max_rival) {
  const std::vector<SlamLoop> believed_loops = believedOf(between, keyframes, connections, params);
  if (believed_loops.empty()) return std::nullopt;
  std::vector<std::size_t> all, believed;
  for (std::size_t i = 0; i < between.size(); ++i) {
    all.push_back(i);
    if (std::any_of(believed_loops.begin(), believed_loops.end(),
                    [&](const SlamLoop& l) { return isSamePair(l, between[i]); })) {
      believed.push_back(i);
    }
  }
  const Contradictions contradictions(between, keyframes, connections, params);
  const Group best = contradictions.best(believed, all);
  std::vector<std::size_t> others;
  for (const std::size_t i : all) {
    if (!contains(best.loops, i)) others.push_back(i);
  }
  MapTie tie;
  tie.support = best.support;
  tie.rival = contradictions.best(others, others).support;
  if (tie.rival > max_rival * tie.support) return std::nullopt;
  for (const std::size_t i : best.loops) {
    if (contains(believed, i)) tie.loops.push_back(between[i]);
  }
  return tie;
}

}  // namespace ngram_slam
