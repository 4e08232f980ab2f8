#include "ngram_slam/slam/placed_loops.hpp"

#include "hyselam_common/odds.hpp"
#include "ngram_slam/slam/loop_candidates.hpp"
#include "ngram_slam/slam/loop_confidence.hpp"

namespace ngram_slam {

std::vector<SubmapScan> lastMetres(const std::vector<SlamKeyframe>& keyframes, int last,
                                   double length) {
  const auto at = [&](int k) -> const SlamKeyframe& {
    return keyframes[static_cast<std::size_t>(k)];
  };
  int first = last;
  while (first > 0 && at(first - 1).run == at(last).run &&
         at(last).path_length - at(first - 1).path_length <= length) {
    --first;
  }
  std::vector<SubmapScan> scans;
  for (int k = first; k <= last; ++k) scans.push_back({at(k).pose, at(k).scan});
  return scans;
}

bool isSurePlace(const PlacedLoop& placed, const std::vector<SlamLoop>& others,
                 const std::vector<SlamLoop>& found_otherwise,
                 const std::vector<SlamKeyframe>& keyframes, const RunConnections& connections,
                 const SlamParams& params) {
  const LoopParams& p = params.loop;
  if (placed.place_probability < params.run_start.sure_place_probability) return false;
  const LoopCompany all = companyOf(placed.loop, others, keyframes, connections, p);
  LoopCompany company = companyOf(placed.loop, found_otherwise, keyframes, connections, p);
  company.contradiction = all.contradiction;
  return all.isTrusted(p) && hyselam::logOdds(placed.place_probability) +
                                     hyselam::logOdds(loopProbability(placed.loop, company)) >=
                                 hyselam::logOdds(params.run_start.min_tie_probability);
}

}  // namespace ngram_slam
