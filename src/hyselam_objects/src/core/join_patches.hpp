// Which patches belong to one thing.
#pragma once

#include <vector>

#include "patches.hpp"

namespace hyselam_objects {

/// The object of each pixel, numbered from 0 in the order of their distance from the camera;
/// Patches::kNone for none.
std::vector<int> joinPatches(const SurfaceGrid& grid, const Patches& patches,
                             const SegmentParams& params);

}  // namespace hyselam_objects
