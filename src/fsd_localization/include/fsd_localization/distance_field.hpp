// Distance of every cell to the nearest obstacle: what the likelihood field and fast ray casting
// use.
#pragma once

#include <vector>

#include "fsd_localization/density_field.hpp"
#include "hyselam_common/occupancy_grid.hpp"

namespace fsd_localization {

struct DistanceField {
  hyselam::GridGeometry geometry;
  std::vector<float> metres;  ///< centre to centre [m], row-major; 0 on obstacles; the map's
                              ///< diagonal where there is no obstacle at all

  float at(hyselam::Cell c) const { return metres[geometry.index(c)]; }
};

/// Euclidean, exact. @throws hyselam::InputError for a grid whose cell count does not fit its size.
DistanceField distanceField(const hyselam::OccupancyGrid& map,
                            const OccupancyThresholds& thresholds = {});

}  // namespace fsd_localization
