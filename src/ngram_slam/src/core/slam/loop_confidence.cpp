#include "ngram_slam/slam/loop_confidence.hpp"

#include <algorithm>
#include <cmath>

#include "hyselam_common/odds.hpp"

namespace ngram_slam {

namespace {

// Learnt from the 1272 loops that evaluate_places verified in the nine logs of the document.
constexpr double kConstant = -3.960, kOfMisfit = -2.040, kOfSupport = 2.477,
                 kOfContradiction = -9.096;
constexpr double kLeastMisfit = 0.005;

}  // namespace

double loopProbability(const SlamLoop& loop, const LoopCompany& company) {
  const double misfit = std::max(kLeastMisfit, 1.0 - loop.fit);
  const double others = std::max(0.0, company.support - loop.inlier_ratio);
  const double all = company.support + company.contradiction;
  const double contradicting = all > 0.0 ? company.contradiction / all : 0.0;
  const double log_odds = kConstant + kOfMisfit * std::log(misfit) +
                          kOfSupport * std::log1p(others) + kOfContradiction * contradicting;
  return hyselam::probabilityOf(log_odds);
}

}  // namespace ngram_slam
