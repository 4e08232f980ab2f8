#include "ngram_slam/slam/run_connections.hpp"

#include <algorithm>

namespace ngram_slam {

namespace {

std::uint32_t runOf(const std::vector<SlamKeyframe>& keyframes, int k) {
  return keyframes[static_cast<std::size_t>(k)].run;
}

}  // namespace

RunConnections::RunConnections(const std::vector<SlamKeyframe>& keyframes,
                               const std::vector<SlamLoop>& loops) {
  for (const SlamLoop& l : loops) {
    if (isUsed(l)) connect(runOf(keyframes, l.older), runOf(keyframes, l.newer));
  }
}

std::uint32_t RunConnections::mapOf(std::uint32_t run) const {
  while (run < first_.size() && first_[run] != run) run = first_[run];
  return run;
}

void RunConnections::connect(std::uint32_t a, std::uint32_t b) {
  a = mapOf(a);
  b = mapOf(b);
  if (a == b) return;
  for (auto next = static_cast<std::uint32_t>(first_.size()); next <= std::max(a, b); ++next) {
    first_.push_back(next);
  }
  first_[std::max(a, b)] = std::min(a, b);
}

std::vector<SlamLoop> loopsWithinRuns(const std::vector<SlamLoop>& loops,
                                      const std::vector<SlamKeyframe>& keyframes,
                                      std::uint32_t run) {
  std::vector<SlamLoop> kept;
  for (const SlamLoop& l : loops) {
    if ((runOf(keyframes, l.older) == run) == (runOf(keyframes, l.newer) == run)) kept.push_back(l);
  }
  return kept;
}

}  // namespace ngram_slam
