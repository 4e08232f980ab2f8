// The kinds of all places of a way decided together: neighbours are of one kind, mostly.
#pragma once

#include <array>
#include <vector>

#include "hyselam_common/parameters.hpp"
#include "ngram_slam/semantics/semantic_class.hpp"

namespace ngram_slam {

struct WayDecisionParams {
  /// What a change of kind from one place to the next costs, as a logarithm of a share of votes.
  double change_cost = 2.0;
  /// Added to all shares of votes: a kind without votes is not impossible.
  double doubt = 0.02;

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError
  void validate() const;
};

/// Share of the votes that each class got at a place, 0..1.
using ClassShares = std::array<double, kSemanticClasses>;

/// The sequence of classes with the greatest sum of logarithms of its shares less the costs of its
/// changes (Viterbi 1967); among equal ones that with the first class at the end and, from there
/// back, with fewer changes.
/// @throws hyselam::ParameterError
std::vector<SemanticClass> mostLikelyClasses(const std::vector<ClassShares>& shares,
                                             const WayDecisionParams& params = {});

}  // namespace ngram_slam
