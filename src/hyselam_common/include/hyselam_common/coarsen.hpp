// The same map with larger cells.
#pragma once

#include "hyselam_common/occupancy_grid.hpp"

namespace hyselam {

/// Joins blocks of factor x factor cells, from the origin on; a last block may reach over the edge.
/// A block holds the largest of its known values, so that a thin wall stays one; unknown if it has
/// none. @throws hyselam::ParameterError if factor < 1.
OccupancyGrid coarsen(const OccupancyGrid& map, int factor);

/// How many cells of `resolution` [m] fit into one of `wanted` [m]; at least 1.
int coarseningFactor(double resolution, double wanted);

}  // namespace hyselam
