// What the region adjacency graph is made of: the first two steps of the segmentation in a row,
// free space and basins, with the basins cut along straight corridors.
#pragma once

#include <opencv2/core.hpp>

#include "basins.hpp"
#include "free_space.hpp"
#include "hyselam_common/occupancy_grid.hpp"
#include "hyselam_gr2to/segmentation/place_segmentation.hpp"
#include "region_adjacency_graph.hpp"

namespace hyselam_topo {

struct PreparedBasins {
  FreeSpace space;    ///< all else is empty where it has no free cell
  cv::Mat clearance;  ///< CV_32F, of each cell of `space` [cells]; 0 where it is not free
  Basins basins;
  BorderContext context;  ///< empty with kBasinsAlone
};

/// The border model is trained on basins alone: ray fans and corridors are left as they are.
enum class Preparation { kBasinsAlone, kFull };
PreparedBasins prepareBasins(const hyselam::OccupancyGrid& grid, const SegmentationParams& params,
                             Preparation preparation);

}  // namespace hyselam_topo
