// The fitness of a whole assignment. Where the robot's heading is not known, the best one is found.
#include <algorithm>
#include <cmath>
#include <utility>

#include "fitness_terms.hpp"

namespace hyselam_topo::merging {
namespace {

/// A heading is better than another only if its deviations are smaller by more than this [rad].
constexpr double kEqualDeviation = 1e-12;

/// Where one described side is right.
struct RightHeadings {
  std::vector<double> headings;
  double share = 1.0;   ///< of the side's value, that it has there
  double weight = 1.0;  ///< of the side
};

/// The best heading, and what the sides lose there.
struct BestHeading {
  double heading = 0.0;
  double lost = 0.0;  ///< sum of what the sides lose
  double off = 0.0;   ///< sum of the deviations
};

/// What is lost is piecewise linear in the heading and bends upwards only where one of the
/// deviations is 0 or begins to count: the best heading is there. Of equally good ones that with
/// the smallest deviations is taken.
BestHeading bestHeading(const FitnessTerms& terms, const std::vector<RightHeadings>& sides) {
  BestHeading best;
  bool first = true;
  const auto tryHeading = [&](double value) {
    BestHeading now{value, 0.0, 0.0};
    for (const RightHeadings& side : sides) {
      double off = kPi;
      for (const double right : side.headings)
        off = std::min(off, std::abs(wrapAngleOnce(right - value)));
      now.lost += side.weight * side.share * terms.lostShare(off);
      now.off += side.share * off;
    }
    const bool better =
        now.lost < best.lost - kEqualDeviation ||
        (now.lost < best.lost + kEqualDeviation && now.off < best.off - kEqualDeviation);
    if (first || better) best = now;
    first = false;
  };
  for (const RightHeadings& side : sides) {
    for (const double right : side.headings) {
      tryHeading(right);
      if (!terms.by_doors) continue;
      tryHeading(wrapAngleOnce(right + FitnessTerms::kRightWithin));
      tryHeading(wrapAngleOnce(right - FitnessTerms::kRightWithin));
    }
  }
  return best;
}

RightHeadings rightHeadings(const FitnessTerms& terms, const MatchProblem::DescribedSide& side,
                            const VertexSet& from, const VertexSet& to) {
  RightHeadings right;
  if (terms.by_doors)
    right.share = terms.forEachDoor(from.members, to.members, [&](const MatchProblem::Passage& p) {
      right.headings.push_back(wrapAngleOnce(p.bearing - side.side_angle));
    });
  else if (FitnessTerms::comparable(from, to))
    right.headings.push_back(wrapAngleOnce(FitnessTerms::bearing(from, to) - side.angle));
  return right;
}

}  // namespace

double evaluate(const FitnessTerms& terms, const std::vector<VertexSet>& names, double* heading) {
  const MatchProblem& problem = terms.problem;
  const auto of = [&names](int i) -> const VertexSet& {
    return names[static_cast<std::size_t>(i)];
  };
  const int n = static_cast<int>(names.size());
  double loss = 0.0;
  for (int i = 0; i < n; ++i) loss += terms.unaryLoss(i, of(i));
  for (int i = 0; i < n; ++i)
    for (int j = i + 1; j < n; ++j) loss += terms.edgeLoss(i, j, of(i), of(j));
  for (const FitnessTerms::Clause& clause : terms.clauses) loss += terms.clauseLoss(clause, of);

  if (problem.heading) {
    for (const MatchProblem::DescribedSide& s : problem.sides)
      loss += terms.sideLoss(s, of(s.from), of(s.to), {*problem.heading, 0.0});
    if (heading != nullptr) *heading = *problem.heading;
    return 1.0 - loss;
  }
  std::vector<RightHeadings> comparable;
  for (const MatchProblem::DescribedSide& s : problem.sides) {
    if (of(s.from).empty() || of(s.to).empty()) {
      loss += terms.absentSideLoss(s, of(s.from), of(s.to));
      continue;
    }
    RightHeadings right = rightHeadings(terms, s, of(s.from), of(s.to));
    if (right.headings.empty()) {
      loss += terms.missingSideLoss(s);
      continue;
    }
    if (terms.by_doors) loss += terms.rankLoss(s, of(s.from).members, of(s.to).members);
    right.weight = terms.sideWeight(s);
    loss += right.weight * (1.0 - right.share);
    comparable.push_back(std::move(right));
  }
  const BestHeading best = bestHeading(terms, comparable);
  loss += best.lost;
  if (heading != nullptr) *heading = best.heading;
  return 1.0 - loss;
}

}  // namespace hyselam_topo::merging
