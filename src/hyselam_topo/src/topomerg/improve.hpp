// A quick way to make an answer better: one vertex or two names changed at a time.
#pragma once

#include "hyselam_topo/topomerg/topomerg.hpp"
#include "merge_terms.hpp"

namespace hyselam_topo::merging {

/// Changes the answer while that makes it better: another name, or none, for a vertex; two names
/// exchanged. Ends after `seconds` at the latest.
MatchSolution improved(const MatchProblem& problem, const MatchParams& params, const Terms& terms,
                       MatchSolution start, double seconds);

}  // namespace hyselam_topo::merging
