#include "hyselam_topo/topomerg/fitness.hpp"

#include "fitness_terms.hpp"
#include "hyselam_common/errors.hpp"

namespace hyselam_topo {

FitnessParams FitnessParams::equation52() {
  FitnessParams p;
  p.weighting = Weighting::kShares;
  p.vertices = p.areas = p.edges = p.orientations = p.orders = p.numbers = p.relations = 0.25;
  p.parts = p.doors = p.size_words = p.evidence = 0.25;
  p.pieces = 0.0;
  p.absent_share = 1.0;
  p.undescribed_edge_credit = 0.0;
  p.closed_door_credit = 0.3;
  return p;
}

void FitnessParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("weighting", weighting, {{"odds", Weighting::kOdds}, {"shares", Weighting::kShares}},
        "odds: weights are logarithms of odds of one statement; shares: they are divided among the "
        "statements of a type and scaled to a sum of 1 (Eq. 5.2)");
  visit("vertices", vertices, Range::atLeast(0.0), "", "weight gamma_v: a name has no place");
  visit("areas", areas, Range::atLeast(0.0), "", "weight gamma_a: places have the described area");
  visit("edges", edges, Range::atLeast(0.0), "", "weight gamma_e: connected as described");
  visit("orientations", orientations, Range::atLeast(0.0), "",
        "weight gamma_d: on the described side");
  visit("sides", sides, {{"doors", SideRule::kDoors}, {"centers", SideRule::kCenters}},
        "what the side of a place is in the map: the direction through its door, or the bearing of "
        "its center (Eq. 5.7)");
  visit("orders", orders, Range::atLeast(0.0), "", "weight of \"A, then B\"; only with doors");
  visit("numbers", numbers, Range::atLeast(0.0), "",
        "weight of \"the second door on the left\" and of distances; only with doors");
  visit(
      "relations", relations, Range::atLeast(0.0), "",
      "weight of next to, opposite, between, at the end of, inside, after, behind, larger, and of "
      "what is denied");
  visit("parts", parts, Range::atLeast(0.0), "", "weight of described numbers of rooms");
  visit("doors", doors, Range::atLeast(0.0), "", "weight of described numbers of doors");
  visit("size_words", size_words, Range::atLeast(0.0), "", "weight of small and large");
  visit("kinds", kinds, Range::atLeast(0.0), "", "weight of corridor or room");
  visit("evidence", evidence, Range::atLeast(0.0), "", "weight of evidence by objects and images");
  visit("pieces", pieces, Range::atLeast(0.0), "", "weight of each further place of a name");
  visit("absent_share", absent_share, Range::between(0.0, 1.0), "",
        "share of a statement's weight that is lost if one of its names has no place");
  visit("undescribed_edge_credit", undescribed_edge_credit, Range::between(0.0, 1.0), "",
        "C of places that are connected in the map but not in the description");
  visit("closed_door_credit", closed_door_credit, Range::between(0.0, 1.0), "",
        "share of C and D that remains where a described door is missing in the map, but the two "
        "places share a wall");
}

void FitnessParams::validate() const {
  hyselam::checkParameters(*this);
  if (!(vertices + areas + edges + orientations > 0.0))
    throw hyselam::ParameterError("vertices", vertices,
                                  "> 0 if areas, edges and orientations are 0");
}

double fitness(const MatchProblem& problem, const FitnessParams& params,
               const Assignment& assignment, double* heading) {
  const merging::FitnessTerms terms(problem, params);
  return merging::evaluate(terms, merging::verticesOf(problem, assignment), heading);
}

}  // namespace hyselam_topo
