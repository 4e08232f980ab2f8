#include "ngram_slam/semantics/way_decision.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace ngram_slam {

void WayDecisionParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("change_cost", change_cost, Range::between(0.0, 1000.0), "",
        "of a change of kind between neighbors, as a logarithm of a share of votes");
  visit("doubt", doubt, Range::aboveUpTo(0.0, 1.0), "", "added to all shares of votes");
}

void WayDecisionParams::validate() const {
  hyselam::checkParameters(*this);
}

std::vector<SemanticClass> mostLikelyClasses(const std::vector<ClassShares>& shares,
                                             const WayDecisionParams& params) {
  params.validate();
  if (shares.empty()) return {};
  // Best sum of a sequence that ends with each class, and the class before in it.
  std::array<double, kSemanticClasses> sums{};
  std::vector<std::array<std::uint8_t, kSemanticClasses>> before(shares.size());
  for (std::size_t i = 0; i < shares.size(); ++i) {
    const auto best =
        static_cast<std::size_t>(std::max_element(sums.begin(), sums.end()) - sums.begin());
    const double changed = sums[best] - params.change_cost;
    for (std::size_t c = 0; c < kSemanticClasses; ++c) {
      const bool stays = i == 0 || c == best || sums[c] >= changed;
      before[i][c] = static_cast<std::uint8_t>(stays ? c : best);
    }
    for (std::size_t c = 0; c < kSemanticClasses; ++c) {
      sums[c] = (before[i][c] == c ? sums[c] : changed) + std::log(shares[i][c] + params.doubt);
    }
  }
  std::vector<SemanticClass> out(shares.size());
  auto at = static_cast<std::size_t>(std::max_element(sums.begin(), sums.end()) - sums.begin());
  for (std::size_t i = shares.size(); i-- > 0; at = before[i][at]) out[i] = kAllSemanticClasses[at];
  return out;
}

}  // namespace ngram_slam
