// Parameters of the nodelet Gr2To.
#pragma once

#include <string>

#include "hyselam_common/ros/params.hpp"
#include "hyselam_gr2to/gr2to.hpp"
#include "hyselam_gr2to/octomap/octomap_compression.hpp"
#include "hyselam_topological_map/ros/map_markers.hpp"

namespace hyselam_topo {

struct Gr2ToServerParams {
  Gr2ToParams gr2to;
  /// File of the border model of mode default; empty: the shipped one.
  std::string border_model;
  bool use_octomap = false;  ///< input from the topic `octomap`, else from `map`
  CompressionParams octomap;
  int partial_updates = 50;      ///< around changes, until the whole map is segmented again
  int max_map_cells = 50000000;  ///< a larger map is refused
  std::string map_file;          ///< a topological map to begin with; empty: none
  MapMarkerParams markers;
  double diagnostic_period = 1.0;  ///< [s]

  void describe(hyselam::ParameterVisitor& visit);
  void validate() const;  ///< @throws hyselam::ParameterError
};

/// With the border model loaded.
/// @throws hyselam::ParameterError; hyselam::InputError for the file `border_model`.
Gr2ToServerParams loadGr2ToParams(hyselam::ParamLoader& loader);

}  // namespace hyselam_topo
