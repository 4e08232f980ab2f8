// Distance of every cell to the nearest obstacle: what the likelihood field and fast ray casting
// use.
#pragma once

#include <vector>

#include "fsd_localization/density/occupancy_thresholds.hpp"
#include "hyselam_common/occupancy_grid.hpp"

namespace fsd_localization {

/// Distances between cell centres [m], row-major; the map's diagonal where there is no such cell at
/// all.
struct DistanceField {
  hyselam::GridGeometry geometry;
  std::vector<float> to_occupied;  ///< 0 on occupied cells
  std::vector<float> to_open;      ///< to the nearest cell that is not occupied; 0 on all but these
};

/// Euclidean, exact. @throws hyselam::InputError for a grid whose cell count does not fit its size.
DistanceField distanceField(const hyselam::OccupancyGrid& map,
                            const OccupancyThresholds& thresholds = {});

}  // namespace fsd_localization
