// Basins cut along the sides of straight corridors. Where a room stands open to a corridor over
// nearly its whole width, the distance map has no narrowing: the line of the walls is what parts
// the two.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "basins.hpp"
#include "straight_corridors.hpp"

namespace hyselam_topo {

struct CorridorBasins {
  std::vector<StraightCorridor> corridors;
  cv::Mat of_cell;  ///< CV_16U, 1 + the corridor of each cell; 0: of none. Empty without corridors
  cv::Mat before;   ///< CV_16U, the basins as they were
};

/// Every piece of a corridor becomes one basin, what is left of the others keeps its own. Scraps
/// are part of the corridor.
CorridorBasins cutAlongCorridors(std::vector<StraightCorridor> corridors, const cv::Mat& clearance,
                                 double resolution, Basins& basins);

}  // namespace hyselam_topo
