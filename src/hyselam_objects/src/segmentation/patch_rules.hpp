// Which patches belong to one object by fixed rules, for things that stand apart: in rooms these
// find lamps, plants and bins whole, which the model learnt from piles on tables takes apart.
#pragma once

#include "hyselam_common/union_find.hpp"
#include "patches.hpp"

namespace hyselam_objects {

/// Joins patches that meet convexly, the inside of a cup or bowl with its outside, and what goes on
/// behind something nearer.
void joinByRules(const SurfaceGrid& grid, const Patches& patches, const SegmentParams& params,
                 hyselam::UnionFind& sets);

}  // namespace hyselam_objects
