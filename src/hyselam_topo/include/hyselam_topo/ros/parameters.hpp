// Parameters of the nodelet Gr2To: names, ranges and meaning are in README.md.
#pragma once

#include <string>

#include "hyselam_common/ros/params.hpp"
#include "hyselam_gr2to/gr2to.hpp"
#include "hyselam_gr2to/octomap/octomap_compression.hpp"
#include "hyselam_topological_map/ros/map_markers.hpp"

namespace hyselam_topo {

struct Gr2ToServerParams {
  Gr2ToParams gr2to;
  bool use_octomap = false;  ///< input from the topic `octomap`, else from `map`
  CompressionParams octomap;
  int partial_updates = 50;      ///< around changes, before everything is looked at
  int max_map_cells = 50000000;  ///< a larger map is refused
  std::string map_file;          ///< a topological map to begin with; empty: none
  MapMarkerParams markers;
  double diagnostic_period = 1.0;  ///< [s]
};

/// @throws hyselam::ParameterError.
Gr2ToServerParams loadGr2ToParams(hyselam::ParamLoader& loader);

}  // namespace hyselam_topo
