// Walls from contours that are known already.
#pragma once

#include <vector>

#include "contours.hpp"
#include "hyselam_gr2to/map_builder/walls.hpp"

namespace hyselam_topo {

/// As extractWalls(); `contours` are those of `labels`.
std::vector<PlaceWalls> wallsAlong(const std::vector<Contour>& contours,
                                   const hyselam::OccupancyGrid& grid, const cv::Mat& labels,
                                   const WallParams& params);

/// Whether what stands in a place is too small to be a wall.
bool isIsland(const Contour& contour, double resolution, const WallParams& params);

}  // namespace hyselam_topo
