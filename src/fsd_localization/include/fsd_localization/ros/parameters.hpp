// Parameters of the two servers. The names on the parameter server are amcl's where the meaning is
// the same; README.md holds the table.
#pragma once

#include <optional>
#include <string>

#include "fsd_localization/localizer.hpp"
#include "hyselam_common/ros/initial_pose.hpp"
#include "hyselam_common/ros/params.hpp"
#include "hyselam_common/ros/scan_input_params.hpp"

namespace fsd_localization {

struct FsdServerParams {
  hyselam::ScanInputParams input;
  FsdSensorParams sensor;
  double update_min_d = 0.1;       ///< travel between observations [m]; 0: one per scan
  double update_min_a = 0.0;       ///< turn between observations [rad]; 0: turning alone gives none
  double gui_publish_rate = 5.0;   ///< of local_map and fsd_markers [Hz]; -1: no limit
  double diagnostic_period = 1.0;  ///< [s]

  void describe(hyselam::ParameterVisitor& visit);
  void validate() const;  ///< @throws hyselam::ParameterError
};

struct LocalizationServerParams {
  hyselam::ScanInputParams input;
  LocalizerParams localizer;
  std::string global_frame_id = "map";
  bool use_map_topic = false;    ///< map from the topic `map`, else from the service `static_map`
  bool first_map_only = false;   ///< later maps are ignored
  int max_map_cells = 50000000;  ///< a larger map is refused
  std::string cache_dir;         ///< density fields are kept there between runs; empty: nowhere
  bool tf_broadcast = true;
  bool force_update_after_initialpose = false;  ///< the next scan is used without motion
  bool force_update_after_set_map = false;
  bool publish_unconverged_tf = false;  ///< map -> odom before convergence too, as amcl does
  double search_wait = 1.0;  ///< a scan waits at most this long for an answer of the search [s]
  double transform_tolerance = 0.1;  ///< added to the stamp of map -> odom, as in amcl [s]
  double save_pose_rate = 0.5;       ///< of saving the pose on the parameter server [Hz]; -1: never
  double gui_publish_rate = -1.0;  ///< of particlecloud, local_map, fsd_markers [Hz]; -1: no limit
  int max_cloud_particles = 5000;  ///< in particlecloud; of more, a fair sample
  int density_field_kernel = 1;    ///< index into the kernels; -1: density_field is not published
  double diagnostic_period = 1.0;  ///< [s]
  hyselam::InitialPoseParams initial_pose;

  void describe(hyselam::ParameterVisitor& visit);
  void validate() const;  ///< @throws hyselam::ParameterError
};

/// What amcl offers to dynamic_reconfigure and nothing here uses, with amcl's defaults: its tools
/// find the names, and are told.
struct UnusedAmclParams {
  std::string odom_model_type = "diff", laser_model_type = "likelihood_field";
  double odom_alpha5 = 0.2, laser_min_range = -1.0;
  int resample_interval = 2;
  bool do_beamskip = false;
  double beam_skip_distance = 0.5, beam_skip_threshold = 0.3;
  // Of the model `beam` only.
  double laser_z_short = 0.1, laser_z_max = 0.05, laser_lambda_short = 0.1;
  bool restore_defaults = false;

  void describe(hyselam::ParameterVisitor& visit);
};

/// The names that dynamic_reconfigure offers: those of amcl.
std::vector<std::string> dynamicParams();
/// Those of them that are read at the start only.
bool isReadAtStartOnly(const std::string& name);

/// @throws hyselam::ParameterError naming parameter, value and range. Nothing is logged.
FsdServerParams loadFsdParams(hyselam::ParamLoader& loader);
/// As above. Names of amcl that mean nothing here are taken as known; see ignoredAmclParams().
LocalizationServerParams loadLocalizationParams(hyselam::ParamLoader& loader);

/// Parameters of amcl that are set but have no effect here, one sentence each.
std::vector<std::string> ignoredAmclParams(const hyselam::ParamLoader& loader);

}  // namespace fsd_localization
