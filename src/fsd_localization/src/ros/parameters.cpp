#include "fsd_localization/ros/parameters.hpp"

#include <sys/stat.h>

#include <algorithm>

#include "hyselam_common/ros/rate_limit.hpp"

namespace fsd_localization {

using hyselam::ParameterError;
using hyselam::ParamLoader;
using hyselam::Range;

namespace {

constexpr const char* kIgnoredOfAmcl[] = {"odom_model_type",     "odom_alpha5",
                                          "laser_model_type",    "laser_min_range",
                                          "resample_interval",   "selective_resampling",
                                          "do_beamskip",         "beam_skip_distance",
                                          "beam_skip_threshold", "beam_skip_error_threshold",
                                          "bag_scan_period",     "std_warn_level_x",
                                          "std_warn_level_y",    "std_warn_level_yaw",
                                          "restore_defaults"};

/// The beams' parameters of the models that are not in use.
constexpr const char* kBeamParams[] = {"laser_max_beams",
                                       "laser_max_range",
                                       "laser_z_hit",
                                       "laser_z_rand",
                                       "laser_z_short",
                                       "laser_z_max",
                                       "laser_lambda_short",
                                       "laser_sigma_hit",
                                       "laser_likelihood_max_dist",
                                       "laser_independent_beams",
                                       "laser_occupied_penalty",
                                       "laser_surface_offset",
                                       "cosine_exponent"};

const Range kDiagnosticPeriod = Range::between(0.05, 60.0);

}  // namespace

void UnusedAmclParams::describe(hyselam::ParameterVisitor& visit) {
  const std::string unused = "amcl's; has no effect here";
  const std::string beam_only = "amcl's; of the model 'beam' only";
  const Range any = Range::any();
  visit("odom_model_type", odom_model_type, unused);
  visit("odom_alpha5", odom_alpha5, any, "", unused);
  visit("laser_model_type", laser_model_type, unused + ", see 'model'");
  visit("laser_min_range", laser_min_range, any, "m", unused);
  visit("resample_interval", resample_interval, any, "", unused);
  visit("do_beamskip", do_beamskip, unused);
  visit("beam_skip_distance", beam_skip_distance, any, "m", unused);
  visit("beam_skip_threshold", beam_skip_threshold, any, "", unused);
  visit("laser_z_short", laser_z_short, Range::between(0.0, 1.0), "", beam_only);
  visit("laser_z_max", laser_z_max, Range::between(0.0, 1.0), "", beam_only);
  visit("laser_lambda_short", laser_lambda_short, Range::between(0.001, 100.0), "1/m", beam_only);
  visit("restore_defaults", restore_defaults, "back to the values of the start");
}

std::vector<std::string> dynamicParams() {
  return {"min_particles",
          "max_particles",
          "kld_err",
          "kld_z",
          "update_min_d",
          "update_min_a",
          "resample_interval",
          "transform_tolerance",
          "recovery_alpha_slow",
          "recovery_alpha_fast",
          "do_beamskip",
          "beam_skip_distance",
          "beam_skip_threshold",
          "tf_broadcast",
          "force_update_after_initialpose",
          "force_update_after_set_map",
          "gui_publish_rate",
          "save_pose_rate",
          "use_map_topic",
          "first_map_only",
          "laser_min_range",
          "laser_max_range",
          "laser_max_beams",
          "laser_z_hit",
          "laser_z_short",
          "laser_z_max",
          "laser_z_rand",
          "laser_sigma_hit",
          "laser_lambda_short",
          "laser_likelihood_max_dist",
          "laser_model_type",
          "odom_model_type",
          "odom_alpha1",
          "odom_alpha2",
          "odom_alpha3",
          "odom_alpha4",
          "odom_alpha5",
          "odom_frame_id",
          "base_frame_id",
          "global_frame_id",
          "restore_defaults"};
}

bool isReadAtStartOnly(const std::string& name) {
  return name == "use_map_topic" || name == "odom_frame_id" || name == "base_frame_id" ||
         name == "global_frame_id";
}

void FsdServerParams::describe(hyselam::ParameterVisitor& visit) {
  visit.group("", input);
  visit("update_min_d", update_min_d, Range::atLeast(0.0), "m",
        "travel between observations; 0: one per scan");
  visit("update_min_a", update_min_a, Range::atLeast(0.0), "rad",
        "or turn; 0: turning alone gives none");
  visit.group("", sensor);
  visit("gui_publish_rate", gui_publish_rate, hyselam::rateRange(), "Hz",
        "of local_map and fsd_markers; -1: no limit");
  visit("diagnostic_period", diagnostic_period, kDiagnosticPeriod, "s", "between diagnostics");
}

void FsdServerParams::validate() const {
  input.validate();
  sensor.validate();
  hyselam::checkParameters(*this);
}

FsdServerParams loadFsdParams(ParamLoader& loader) {
  FsdServerParams p;
  loader.group("", p);
  p.validate();
  return p;
}

void LocalizationServerParams::describe(hyselam::ParameterVisitor& visit) {
  visit.group("", input);
  hyselam::describeFrame(visit, "global_frame_id", global_frame_id, "frame of the map");
  visit("use_map_topic", use_map_topic, "map from the topic map, else from the service static_map");
  visit("first_map_only", first_map_only, "later maps are ignored");
  visit("max_map_cells", max_map_cells, Range::between(1, 1e9), "", "a larger map is refused");
  visit("cache_dir", cache_dir,
        "existing folder that keeps density fields between runs; empty: none are kept");
  visit("tf_broadcast", tf_broadcast, "publish global_frame_id -> odom_frame_id");
  visit("force_update_after_initialpose", force_update_after_initialpose,
        "after a pose on initialpose the next scan gives an update without motion");
  visit("force_update_after_set_map", force_update_after_set_map,
        "after the service set_map likewise");
  visit("publish_unconverged_tf", publish_unconverged_tf,
        "also from estimates that have not converged, as amcl does");
  visit("search_wait", search_wait, Range::between(0.0, 3600.0), "s",
        "wall time that scans wait for an answer of the search that is due; one that takes longer "
        "counts when it comes");
  visit("transform_tolerance", transform_tolerance, Range::between(0.0, 60.0), "s",
        "the transform is dated this far ahead");
  visit("save_pose_rate", save_pose_rate, hyselam::rateRange(), "Hz",
        "of saving a converged pose on the parameter server; -1: never");
  visit("gui_publish_rate", gui_publish_rate, hyselam::rateRange(), "Hz",
        "of particlecloud, local_map, fsd_markers; -1: with each update");
  visit("max_cloud_particles", max_cloud_particles, Range::between(1, 1e7), "",
        "in particlecloud; of more, a fair sample");
  visit("diagnostic_period", diagnostic_period, kDiagnosticPeriod, "s", "between diagnostics");
  visit.group("", initial_pose);
  visit.group("", localizer);
  const int last_kernel = static_cast<int>(localizer.map.kernels.size()) - 1;
  density_field_kernel = std::min(density_field_kernel, last_kernel);
  visit("density_field_kernel", density_field_kernel, Range::between(-1, last_kernel), "",
        "index into bandwidths; -1: density_field is not published");
}

void LocalizationServerParams::validate() const {
  input.validate();
  hyselam::checkFrame("global_frame_id", global_frame_id);
  if (global_frame_id == input.odom_frame_id || global_frame_id == input.base_frame_id) {
    throw ParameterError("global_frame_id", global_frame_id,
                         "another frame than odom_frame_id and base_frame_id");
  }
  struct stat info {};
  if (!cache_dir.empty() && (::stat(cache_dir.c_str(), &info) != 0 || !S_ISDIR(info.st_mode))) {
    throw ParameterError("cache_dir", cache_dir, "an existing folder");
  }
  localizer.validate();
  hyselam::checkParameters(*this);
}

LocalizationServerParams loadLocalizationParams(ParamLoader& loader) {
  for (const char* name : kIgnoredOfAmcl) loader.know(name);
  for (const char* name : kBeamParams) loader.know(name);
  LocalizationServerParams p;
  loader.group("", p);
  p.validate();
  return p;
}

std::vector<std::string> ignoredAmclParams(const ParamLoader& loader) {
  std::vector<std::string> sentences;
  for (const char* name : kIgnoredOfAmcl) {
    if (loader.isSet(name)) {
      sentences.push_back(
          std::string("parameter '") + name +
          "' of amcl has no effect here (see \"Replacing amcl\" in fsd_localization/README.md)");
    }
  }
  return sentences;
}

}  // namespace fsd_localization
