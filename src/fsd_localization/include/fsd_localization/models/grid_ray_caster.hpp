// Expected ranges on a grid map, cell by cell along the ray (2.1.1, the basic beam model's inner
// loop), skipping squares that hold no obstacle by a distance map.
#pragma once

#include <cstdint>
#include <vector>

#include "fsd_localization/density/occupancy_thresholds.hpp"
#include "hyselam_common/occupancy_grid.hpp"

namespace fsd_localization {

class GridRayCaster {
 public:
  explicit GridRayCaster(const hyselam::OccupancyGrid& map,
                         const OccupancyThresholds& thresholds = {});

  /// Distance from a point of the grid's frame, in a direction of it, to where the ray enters the
  /// first occupied cell [m]; 0 if it starts in one; `max_range` if there is none nearer or the ray
  /// leaves the map first.
  double range(double x, double y, double direction, double max_range) const;
  /// The same in the direction of (dx, dy), a unit vector.
  double rangeAlong(double x, double y, double dx, double dy, double max_range) const;

 private:
  int width_;
  int height_;
  double resolution_;
  /// Cells nearer than this in the maximum norm are open; 0 on an obstacle.
  std::vector<std::uint8_t> open_within_;
};

}  // namespace fsd_localization
