// Gr2To (Maffei 2017, section 4.2): from a grid map to the augmented topological map.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <utility>
#include <vector>

#include "hyselam_common/occupancy_grid.hpp"
#include "hyselam_gr2to/segmentation/segmentation.hpp"
#include "hyselam_topological_map/topological_map.hpp"

namespace hyselam_topo {

struct Gr2ToParams {
  enum class Mode {
    kDefault,  ///< places by segment(): merged, with clutter seen through
    kThesis,   ///< critical points of the Voronoi diagram, as in the thesis
  };
  Mode mode = Mode::kDefault;
  SegmentationParams segmentation;  ///< of the default mode
};

struct Gr2ToResult {
  AugmentedTopologicalMap map;
  cv::Mat labels;  ///< CV_16U as in Segmentation; label n is map place n
  std::vector<DoorLine> doors;
  std::vector<std::pair<std::string, double>> seconds;  ///< wall time of each stage [s], in order
};

/// @throws as segment()
Gr2ToResult gr2to(const hyselam::OccupancyGrid& grid, const Gr2ToParams& params = {});

}  // namespace hyselam_topo
