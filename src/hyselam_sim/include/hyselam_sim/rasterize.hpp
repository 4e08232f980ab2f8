// The grid map that a perfect mapping run through a floor plan would give.
#pragma once

#include "hyselam_common/occupancy_grid.hpp"
#include "hyselam_common/parameters.hpp"
#include "hyselam_sim/floor_plan.hpp"

namespace hyselam_sim {

struct RasterOptions {
  double resolution = 0.1;     ///< [m/cell], 0.005 .. 10
  double time = 0.0;           ///< at which the doors are drawn [s]
  bool with_furniture = true;  ///< false: the floor under it is free

  void describe(hyselam::ParameterVisitor& visit);
  void validate() const;  ///< @throws hyselam::ParameterError
};

/// Cells that contain solid matter are occupied; cells of the interior (what is reached from the
/// places and `inside` points without crossing a wall, doors counting as passages) are free; the
/// rest is unknown. The grid's origin is the plan's origin, unrotated; its frame is the plan frame.
/// @throws hyselam::InputError if the interior leaks out of the drawing (a gap in the outer walls)
/// or the plan names no interior point, hyselam::ParameterError for a bad resolution.
hyselam::OccupancyGrid rasterize(const FloorPlan& plan, const RasterOptions& options = {});

/// As above with the common arguments spelled out.
hyselam::OccupancyGrid rasterize(const FloorPlan& plan, double resolution, double time);

}  // namespace hyselam_sim
