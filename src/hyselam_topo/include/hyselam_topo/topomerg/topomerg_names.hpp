// After TopoMerg: the certainty of each name, what to ask next, and the map with its names.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hyselam_topo/topomerg/topomerg.hpp"

namespace hyselam_topo {

/// A name whose place is right with less probability than this is told as unsure.
constexpr double kSureProbability = 0.97;
/// A name whose place is right with this probability is rather there than anywhere else.
constexpr double kLikelyProbability = 0.5;

struct NameUncertainty {
  Id name = 0;
  Id place = 0;  ///< of the map: the largest that the name was given to; 0: none (not seen yet)
  /// By how much at least the best fitness drops if the name is not there (or has a place, if it
  /// has none): 0 if another assignment is as good, large if the name cannot be elsewhere. For a
  /// confirmed name 1.
  double drop = 0.0;
  bool proven = true;  ///< false: time was too short, the drop may be larger
  /// That the name is right there, from the drop; calibrated on generated floors
  /// (docs/algorithms/topomerg.md). For a confirmed name, and one of another floor, 1.
  double probability = 0.0;

  bool unsure() const { return probability < kSureProbability; }
};

/// How many of the kept assignments, the best included, are at most `odds` times less likely than
/// the best. Those that PlaceAssignment::more says were not kept are not counted. With
/// Weighting::kShares those equally good.
std::size_t nearEqual(const PlaceAssignment& match, double odds);

/// One search for each name whose alternative is not among the kept assignments; `time_limit` holds
/// for all of them together, each gets an equal share of what the others have left.
/// In the order of the names. Empty if the match has none.
std::vector<NameUncertainty> nameUncertainties(const MatchProblem& problem,
                                               const SolverParams& params,
                                               const PlaceAssignment& match);

/// What to ask the person.
struct MatchQuestion {
  Id place = 0;              ///< of the map: "what is the name of this place?"
  Id name = 0;               ///< its likeliest name: "is this ...?"; 0: none of the description
  double probability = 0.0;  ///< of that name, among the assignments that are kept
  double bits = 0.0;         ///< entropy of its name over these assignments
};

struct QuestionParams {
  /// Weighting::kShares: answers that are worse by this much are 1/e as likely, > 0.
  double tolerance = 0.01;
};

/// The place whose name discriminates best between the assignments: that with the largest entropy
/// of its name over the assignments of `match`, which should have been kept within a few tolerances
/// (keep_within). Of equally good places that with the smallest id. Nothing if all assignments
/// agree.
std::optional<MatchQuestion> mostInformativeQuestion(const MatchProblem& problem,
                                                     const PlaceAssignment& match,
                                                     const QuestionParams& params = {});

/// The map with the names of the solution as words, first the name, then its aliases. They are
/// unconfirmed, except where the problem has them as confirmed; unconfirmed words that the map had
/// of these places before are replaced, confirmed ones stay.
AugmentedTopologicalMap withNames(const AugmentedTopologicalMap& map,
                                  const DescribedBuilding& building, const MatchProblem& problem,
                                  const MatchSolution& solution);

}  // namespace hyselam_topo
