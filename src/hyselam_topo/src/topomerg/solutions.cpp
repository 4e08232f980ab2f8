#include "solutions.hpp"

#include <algorithm>

namespace hyselam_topo::merging {

bool preferred(const MatchSolution& a, const MatchSolution& b) {
  if (a.vertices != b.vertices) return a.vertices < b.vertices;
  return a.assignment < b.assignment;
}

void Solutions::offer(MatchSolution solution) {
  if (solution.fitness < needed()) return;
  const bool better = !any() || solution.fitness > best_ + kEqualFitness;
  if (better) fewest_ = solution.vertices;
  // Within kEqualFitness the largest value leads, so that the order of arrival does not matter.
  best_ = any() ? std::max(best_, solution.fitness) : solution.fitness;
  floor_ = std::max(floor_, best_);
  if (!better && solution.fitness >= best_ - kEqualFitness)
    fewest_ = std::min(fewest_, solution.vertices);
  kept_.push_back(std::move(solution));
  if (better) {
    full_ = false;
    more_ = more_ && params_.keep_within > 0.0;
  }
  if (better || kept_.size() >= 2 * params_.max_solutions) trim();
  if (kept_.size() >= params_.max_solutions) full_ = true;
}

void Solutions::restart(double fitness) {
  kept_.clear();
  best_ = -1.0;
  floor_ = fitness;
  fewest_ = 0;
  full_ = more_ = false;
}

void Solutions::trim() {
  kept_.erase(std::remove_if(kept_.begin(), kept_.end(),
                             [this](const MatchSolution& s) { return s.fitness < needed(); }),
              kept_.end());
  const auto equal = std::partition(kept_.begin(), kept_.end(), [this](const MatchSolution& s) {
    return s.fitness >= best_ - kEqualFitness;
  });
  std::sort(kept_.begin(), equal, preferred);
  std::sort(equal, kept_.end(), [](const MatchSolution& a, const MatchSolution& b) {
    return a.fitness != b.fitness ? a.fitness > b.fitness : preferred(a, b);
  });
  if (kept_.size() > params_.max_solutions) {
    more_ = true;
    kept_.resize(params_.max_solutions);
  }
}

PlaceAssignment Solutions::finish() {
  trim();
  PlaceAssignment match;
  match.equal = static_cast<std::size_t>(
      std::count_if(kept_.begin(), kept_.end(),
                    [this](const MatchSolution& s) { return s.fitness >= best_ - kEqualFitness; }));
  match.solutions = kept_;
  match.more = more_ || full_;
  return match;
}

}  // namespace hyselam_topo::merging
