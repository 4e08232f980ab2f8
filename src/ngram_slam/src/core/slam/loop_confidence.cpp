#include "ngram_slam/slam/loop_confidence.hpp"

#include <algorithm>
#include <cmath>

namespace ngram_slam {

namespace {

// Learnt from the 1208 loops that evaluate_places verified in the nine logs of the document.
constexpr double kConstant = -3.228, kOfMisfit = -2.124, kOfSupport = 1.717,
                 kOfContradiction = -7.879;
constexpr double kLeastMisfit = 0.005;

}  // namespace

double loopProbability(const LoopVerification& verification, const LoopCompany& company) {
  if (!verification.verified) return 0.0;
  const double misfit = std::max(
      kLeastMisfit,
      1.0 - std::min(verification.new_in_old.surface_ratio, verification.old_in_new.surface_ratio));
  const double others = std::max(0.0, company.support - verification.loop.inlier_ratio);
  const double all = company.support + company.contradiction;
  const double contradicting = all > 0.0 ? company.contradiction / all : 0.0;
  const double log_odds = kConstant + kOfMisfit * std::log(misfit) +
                          kOfSupport * std::log1p(others) + kOfContradiction * contradicting;
  return 1.0 / (1.0 + std::exp(-log_odds));
}

}  // namespace ngram_slam
