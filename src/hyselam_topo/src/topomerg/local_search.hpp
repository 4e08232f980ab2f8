// A quick way to make an assignment better: one vertex or two names changed at a time.
#pragma once

#include "fitness_terms.hpp"
#include "hyselam_topo/topomerg/topomerg.hpp"

namespace hyselam_topo::merging {

/// Changes the assignment while that makes it better: another name, or none, for a vertex; two
/// names exchanged. Ends after `seconds` at the latest.
MatchSolution searchLocally(const MatchProblem& problem, const SolverParams& params,
                            const FitnessTerms& terms, MatchSolution start, double seconds);

}  // namespace hyselam_topo::merging
