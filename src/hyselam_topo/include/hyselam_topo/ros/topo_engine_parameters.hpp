// Parameters of the nodelet TopoEngine: names, ranges and meaning are in docs/parameters.md and
// config/topo_engine.yaml.
#pragma once

#include <string>

#include "hyselam_common/ros/params.hpp"
#include "hyselam_topo/dialogue/dialogue.hpp"
#include "hyselam_topological_map/ros/map_markers.hpp"

namespace hyselam_topo {

struct TopoEngineParams {
  DialogueParams dialogue;
  std::string base_frame = "base_link";
  double pose_rate = 5.0;              ///< at which the robot's pose is looked up [Hz]
  double pose_timeout = 1.0;           ///< an older pose is none [s]
  std::string state_file;              ///< kept across restarts; empty: nothing is kept
  bool use_move_base = true;           ///< drive by the action `move_base`, where it is there
  int max_map_cells = 50000000;        ///< a larger map is refused
  int max_text_bytes = 65536;          ///< a longer text is refused
  double object_answer_timeout = 3.0;  ///< to a sentence about objects [s]
  MapMarkerParams markers;
  double diagnostic_period = 1.0;  ///< [s]

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError.
  void validate() const;
};

/// @throws hyselam::ParameterError.
TopoEngineParams loadTopoEngineParams(hyselam::ParamLoader& loader);

}  // namespace hyselam_topo
