// Which patches belong to one object.
#pragma once

#include <vector>

#include "patches.hpp"
#include "relation_model.hpp"

namespace hyselam_objects {

/// The object of each pixel, numbered from 0 by distance from the camera; Patches::kNone for none.
/// By the odds of a learnt model.
std::vector<int> mergePatches(const SurfaceGrid& grid, const Patches& patches,
                              const SegmentParams& params,
                              const RelationModel& model = RelationModel::shipped());

/// The same as joinByRules() has it.
std::vector<int> mergePatchesByRules(const SurfaceGrid& grid, const Patches& patches,
                                     const SegmentParams& params);

}  // namespace hyselam_objects
