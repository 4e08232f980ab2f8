#include "ngram_slam/semantics/semantic_classifier.hpp"

#include <algorithm>
#include <cmath>

#include "hyselam_common/errors.hpp"

namespace ngram_slam {
namespace {

/// How sure it is that `value` lies on its side of `threshold`: 0.5 at it, 0.98 where the distance
/// is the threshold itself.
double certainty(double value, double threshold) {
  return 1.0 / (1.0 + std::exp(-4.0 * std::abs(value - threshold) / threshold));
}

}  // namespace

void DecisionTreeParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  const Range angle = Range::aboveUpTo(0.0, 1e3);
  visit("high_variation", high_variation, Range::aboveUpTo(0.0, 1.0), "",
        "of the density; more is high");
  visit("high_density", high_density, Range::aboveUpTo(0.0, 1.0), "", "more is high");
  visit("few_frontiers", few_frontiers, Range::aboveUpTo(0.0, 255.0), "", "fewer are low");
  visit("many_frontiers", many_frontiers, Range::aboveUpTo(0.0, 255.0), "", "more are high");
  visit("huge_turn", huge_turn, angle, "rad", "more is very high");
  visit("small_turn", small_turn, angle, "rad", "less is low");
  visit("straight", straight, angle, "rad", "turns below it may be a corridor for low variation");
  visit("very_long", very_long, Range::aboveUpTo(0.0, 1e9), "observations",
        "longer regions are corridors");
}

void DecisionTreeParams::validate() const {
  hyselam::checkParameters(*this);
  if (small_turn > huge_turn) {
    throw hyselam::ParameterError("small_turn", small_turn, "at most 'huge_turn' [rad]");
  }
}

DecisionTree::DecisionTree(const DecisionTreeParams& params) : params_(params) {
  params_.validate();
}

SemanticPrediction DecisionTree::classify(const SemanticFeatures& f) const {
  const DecisionTreeParams& p = params_;
  const bool very_long = f.length > p.very_long;
  const bool flat = f.variation <= p.high_variation, straight = f.turn < p.straight;
  const double length = certainty(f.length, p.very_long);
  const double variation = certainty(f.variation, p.high_variation);
  const double direction = certainty(f.turn, p.straight);
  // Either of the two is enough.
  if (very_long || (flat && straight)) {
    const double by_length = very_long ? length : 0.0;
    const double by_density = flat && straight ? std::min(variation, direction) : 0.0;
    return {SemanticClass::kCorridor, std::max(by_length, by_density)};
  }
  double sure = std::min(length, std::max(flat ? 0.0 : variation, straight ? 0.0 : direction));
  const auto test = [&](double value, double threshold) {
    sure = std::min(sure, certainty(value, threshold));
  };
  test(f.frontiers, p.few_frontiers);
  if (f.frontiers < p.few_frontiers) {
    test(f.density_max, p.high_density);
    return {f.density_max > p.high_density ? SemanticClass::kHall : SemanticClass::kCorridor, sure};
  }
  test(f.frontiers, p.many_frontiers);
  if (f.frontiers > p.many_frontiers) return {SemanticClass::kBifurcation, sure};
  test(f.turn, p.huge_turn);
  if (f.turn > p.huge_turn) return {SemanticClass::kDeadEnd, sure};
  test(f.turn, p.small_turn);
  return {f.turn < p.small_turn ? SemanticClass::kCorridor : SemanticClass::kCorner, sure};
}

}  // namespace ngram_slam
