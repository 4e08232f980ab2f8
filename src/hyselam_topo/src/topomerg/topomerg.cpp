#include "hyselam_topo/topomerg/topomerg.hpp"

#include <limits>

#include "exact_search.hpp"

namespace hyselam_topo {

void SolverParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit.group("weight_", fitness);
  visit("dummy", dummy, "places of the map may stay without a name (k_s of Eq. 5.5)");
  visit("connected", connected, "the places of one name are connected in the map");
  visit("time_limit", time_limit, Range::atLeast(0.0), "s",
        "the search stops after this much processor time and returns the best assignment so far");
  visit("max_solutions", max_solutions, Range::atLeast(1.0), "", "equally good assignments kept");
  visit("keep_within", keep_within, Range::between(0.0, 1.0), "",
        "assignments with a fitness lower by up to this are kept too");
}

void SolverParams::validate() const {
  fitness.validate();
  hyselam::checkParameters(*this);
}

PlaceAssignment solveExact(const MatchProblem& problem, const SolverParams& params) {
  params.validate();
  const merging::FitnessTerms terms(problem, params.fitness);
  return merging::ExactSearch(problem, params, terms).run();
}

}  // namespace hyselam_topo
