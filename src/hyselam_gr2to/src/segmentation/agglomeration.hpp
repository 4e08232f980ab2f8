// Fourth step of the segmentation: neighbours become one place, the surest first, until no pair is
// more likely one place than two.
#pragma once

#include <functional>
#include <opencv2/core.hpp>

#include "free_space.hpp"
#include "region_adjacency_graph.hpp"

namespace hyselam_topo {

/// Log-odds that two neighbours with an open border are one place.
using OnePlace = std::function<double(const RegionAdjacencyGraph&, int a, int b)>;

/// Ties go to the pair with the smaller numbers; the smaller number is kept.
void agglomerate(RegionAdjacencyGraph& graph, const OnePlace& odds);

/// What the segmentation starts from.
struct PreparedPlaces {
  FreeSpace space;
  cv::Mat clearance;  ///< CV_32F [cells]
  Basins basins;
  BorderContext context;  ///< empty with kBasinsAlone
};
/// The border model is trained on basins alone: ray fans and corridors are left as they are.
enum class Preparation { kBasinsAlone, kFull };
PreparedPlaces preparePlaces(const hyselam::OccupancyGrid& grid, const SegmentationParams& params,
                             Preparation preparation);

}  // namespace hyselam_topo
