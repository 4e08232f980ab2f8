// How sure a loop is that the scans verified.
#pragma once

#include "ngram_slam/slam/loop_candidates.hpp"

namespace ngram_slam {

/// The probability that a verified far loop is right, 0..1: by how well both segments fit what the
/// other one observed, and by the loops close to it. By logistic regression on nine buildings, see
/// docs/algorithms/signatures.md.
double loopProbability(const SlamLoop& loop, const LoopCompany& company);

}  // namespace ngram_slam
