// Frontiers of free space around one cell (Maffei 2017, 6.3, Alg. 6.1): how many ways lead out of
// the kernel's disc.
#pragma once

#include "fsd_localization/density/free_space_density.hpp"

namespace fsd_localization {

/// Number of frontiers: 8-connected groups of reachable free cells just outside the kernel (d >= h,
/// beside a flooded cell) with more than `min_share` (epsilon_f) of the kernel's perimeter. The rim
/// of a digital disc is connected diagonally, hence 8-connected. 0 where the center is not free.
/// @param min_share 0..1.
int frontierCount(const FreeSpaceDensity& density, const FreeSpaceGrid& space, hyselam::Cell center,
                  double min_share = 0.05);

}  // namespace fsd_localization
