#include "hyselam_topo/topomerg/fitness.hpp"

#include "fitness_terms.hpp"
#include "hyselam_common/errors.hpp"

namespace hyselam_topo {

void FitnessParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("vertices", vertices, Range::atLeast(0.0), "", "weight gamma_v: every name has a place");
  visit("areas", areas, Range::atLeast(0.0), "", "weight gamma_a: places have the described area");
  visit("edges", edges, Range::atLeast(0.0), "", "weight gamma_e: connected as described");
  visit("orientations", orientations, Range::atLeast(0.0), "",
        "weight gamma_d: on the described side");
  visit("sides", sides, {{"doors", SideRule::kDoors}, {"centers", SideRule::kCenters}},
        "what the side of a place is in the map: the direction through its door, or the bearing of "
        "its center (Eq. 5.7)");
  visit("orders", orders, Range::atLeast(0.0), "", "weight of \"A, then B\"; only with doors");
  visit("relations", relations, Range::atLeast(0.0), "",
        "weight of next to, opposite, between, at the end of, inside");
  visit("parts", parts, Range::atLeast(0.0), "", "weight of described numbers of rooms");
  visit("kinds", kinds, Range::atLeast(0.0), "", "weight of corridor or room");
  visit("evidence", evidence, Range::atLeast(0.0), "", "weight of evidence by objects and images");
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
