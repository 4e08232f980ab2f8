// Image of a topological map drawn over its grid map, as for figures in papers.
#pragma once

#include <opencv2/core.hpp>

#include "hyselam_common/occupancy_grid.hpp"
#include "hyselam_common/parameters.hpp"
#include "hyselam_gr2to/gr2to.hpp"

namespace hyselam_topo {

struct OverviewOptions {
  int side = 2000;  ///< [pixel] of the longer side, about; 200 .. 10000
  bool graph = true;
  bool walls = true;

  void describe(hyselam::ParameterVisitor& visit);
  void validate() const;  ///< @throws hyselam::ParameterError
};

/// BGR, 8 bit, y up: places colored and numbered with their words if they have any, walls thick
/// (solid) or dashed (limits without a wall), doors green or, open borders, dashed orange, the
/// graph of places through its doors, a scale bar and a legend. Cropped to the known part
/// of the map.
/// @throws hyselam::ParameterError for an option out of range
cv::Mat drawOverview(const hyselam::OccupancyGrid& grid, const Gr2ToResult& result,
                     const OverviewOptions& options = {});

}  // namespace hyselam_topo
