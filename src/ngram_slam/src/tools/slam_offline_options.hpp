// The options of slam_offline, and the parameters of SLAM that they come to.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>

#include "degrade.hpp"
#include "hyselam_common/occupancy_mapper.hpp"
#include "hyselam_common/pose2.hpp"
#include "hyselam_common/ros/bag_tool.hpp"
#include "ngram_slam/slam/slam_params.hpp"

namespace ngram_slam {

struct SlamOfflineOptions {
  std::string bag, carmen, out, parameters, reference, loops = "all", state, save_state, start;
  int levels = 3;
  std::uint64_t seed = 1;
  double noise = 0.0, resolution = 0.05, loop_latency = SlamParams{}.loop_latency;
  bool loops_given = false;  ///< on the command line
  bool side_by_side = false, raw_odometry = false, keep_all = false, correct_laser = false;
  Degradation degradation;
  hyselam::BagOptions bag_options;
  /// Of the map that is written.
  hyselam::OccupancyMapperParams map;
  /// Without --parameters the defaults; else those of the file.
  SlamParams slam;
};

/// All options, in the order of --help.
void addOptions(CLI::App& app, SlamOfflineOptions* o);

/// To be called when the command line was read: the parameters of the node, from the file of
/// --parameters if there is one. Options on the command line win over them.
/// @throws hyselam::InputError, hyselam::ParameterError
void loadParameters(const CLI::App& app, SlamOfflineOptions* o);

/// Refuses before the work what would be refused after it.
/// @throws hyselam::InputError, hyselam::ParameterError
void checkOptions(const SlamOfflineOptions& o);

/// @throws hyselam::ParameterError
SlamParams slamParamsOf(const SlamOfflineOptions& o, LoopClosureMode loops);

hyselam::OccupancyMapperParams mapParamsOf(const SlamOfflineOptions& o);

/// Where the robot of a recording stands at its beginning in a saved map: "X,Y,THETA" [m, rad].
/// @throws hyselam::InputError
hyselam::Pose2 parseStart(const std::string& text);

}  // namespace ngram_slam
