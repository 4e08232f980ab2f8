// Parameters of the nodelet NgramSlam; README.md holds the table.
#pragma once

#include <optional>
#include <string>

#include "hyselam_common/occupancy_mapper.hpp"
#include "hyselam_common/ros/initial_pose.hpp"
#include "hyselam_common/ros/params.hpp"
#include "hyselam_common/ros/scan_input_params.hpp"
#include "ngram_slam/semantics/semantic_segmenter.hpp"
#include "ngram_slam/slam/slam_params.hpp"

namespace ngram_slam {

struct SlamServerParams {
  SlamServerParams();

  hyselam::ScanInputParams input;
  std::string global_frame_id = "map";
  SlamParams slam;
  SemanticParams semantic;
  hyselam::OccupancyMapperParams map;
  double loop_wait = 1.0;  ///< a scan waits at most this long for loops that count [s], >= 0
  double map_update_interval = 2.0;  ///< between maps [s] of the data; 0: no map is drawn
  bool tf_broadcast = true;
  double transform_publish_period = 0.05;  ///< of map -> odom [s] of wall time; 0: at scans only
  double transform_tolerance = 0.1;        ///< map -> odom is dated this far into the future [s]
  std::string state;          ///< file gone on with at the start and saved; empty: none
  double save_period = 60.0;  ///< [s] of wall time; 0: only at the end and when asked
  /// A session ends after this path [m]: what it adds nothing by is dropped (ConsolidationParams)
  /// while the robot drives, and another one goes on; 0: only when a map is loaded.
  double session_path = 0.0;
  double start_window = 2.0;  ///< around the pose where a run starts in a known map [m], (0, 50]
  double start_angle = 1.0;   ///< [rad], 0..pi
  std::optional<double> initial_pose_x, initial_pose_y;  ///< [m]
  std::optional<double> initial_pose_a;                  ///< [rad]
  double diagnostic_period = 1.0;                        ///< [s]

  /// Of initial_pose_x, _y, _a: those not set are 0; nothing if none is set.
  std::optional<hyselam::InitialPose> initialPose() const;

  /// All but `input` and `semantic`.
  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError
  void validate() const;
};

/// @throws hyselam::ParameterError naming parameter, value and range. Nothing is logged.
SlamServerParams loadSlamParams(hyselam::ParamLoader& loader);

}  // namespace ngram_slam
