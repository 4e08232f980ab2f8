// A name that is being given vertices one by one.
#pragma once

#include "angles.hpp"
#include "fitness_terms.hpp"

namespace hyselam_topo::merging {

/// The vertices that the name has, and those that it may still get.
struct PartialSet {
  int name = -1;
  VertexSet has;
  PlaceSet open;
  // Its center will lie in this circle.
  double x = 0.0, y = 0.0, radius = 0.0;
};

/// In which directions a place sees the center of a partial set.
struct BearingInterval {
  double bearing = 0.0;  ///< to the middle of the circle
  double slack = kPi;    ///< either way to its rim
};

/// What a set of vertices has to do with a partial set.
struct PartialSetView {
  bool touches = false;
  bool may_touch = false;
  bool may_share_wall = false;
  bool has_position = false;  ///< the set has
  BearingInterval seen;
  PlaceSet members;  ///< of the set
};

/// Drops open vertices that cannot be connected with what the set has.
void keepReachable(const MatchProblem& problem, PartialSet& partial);

/// Computes the circle of possible centers.
void boundCenter(const MatchProblem& problem, PartialSet& partial);

/// The circle of centers as seen from a point.
BearingInterval bearingTo(double from_x, double from_y, const PartialSet& partial);

}  // namespace hyselam_topo::merging
