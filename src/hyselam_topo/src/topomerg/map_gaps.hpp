// Where rooms may be that the robot has not seen.
#pragma once

#include "hyselam_topo/topomerg/topomerg_problem.hpp"

namespace hyselam_topo::merging {

/// Fills `out->gaps`: the stretches of the walls of `map`, wide enough for a room, with no place of
/// the map behind them. A long stretch gives several, a room apart.
void addGaps(const AugmentedTopologicalMap& map, MatchProblem* out);

}  // namespace hyselam_topo::merging
