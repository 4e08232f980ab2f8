// Parameters of the nodelet SharedMap; README.md holds the table.
#pragma once

#include <string>
#include <vector>

#include "hyselam_common/occupancy_mapper.hpp"
#include "hyselam_common/ros/params.hpp"
#include "ngram_slam/slam/shared_map.hpp"

namespace ngram_slam {

struct SharedMapServerParams {
  SharedMapServerParams();

  std::string robots = "robot1 robot2";  ///< namespaces, separated by spaces
  std::string global_frame_id = "map";
  double poll_period = 1.0;     ///< between questions to a robot [s] of wall time
  double answer_timeout = 5.0;  ///< then a robot that was asked does not answer [s] of wall time
  double map_update_interval = 2.0;  ///< between maps [s] of wall time
  double merge_interval = 10.0;      ///< from the end of a merging to the next one [s], at least
  double max_load = 0.25;  ///< part of one core that merging takes on average, and drawing
  double transform_publish_period = 0.1;  ///< [s] of wall time
  double diagnostic_period = 1.0;         ///< [s]
  hyselam::OccupancyMapperParams map;
  SharedMapParams shared;

  /// The names in `robots`.
  std::vector<std::string> names() const;
  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError
  void validate() const;
};

/// @throws hyselam::ParameterError naming parameter, value and range. Nothing is logged.
SharedMapServerParams loadSharedMapParams(hyselam::ParamLoader& loader);

}  // namespace ngram_slam
