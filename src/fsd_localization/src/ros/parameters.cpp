#include "fsd_localization/ros/parameters.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <cmath>

#include "hyselam_common/ros/rate_limit.hpp"

namespace fsd_localization {

using hyselam::kPi;
using hyselam::ParameterError;
using hyselam::ParamLoader;
using hyselam::Range;

namespace {

constexpr const char* kIgnoredOfAmcl[] = {"odom_model_type",
                                          "odom_alpha5",
                                          "laser_model_type",
                                          "laser_min_range",
                                          "resample_interval",
                                          "selective_resampling",
                                          "do_beamskip",
                                          "beam_skip_distance",
                                          "beam_skip_threshold",
                                          "beam_skip_error_threshold",
                                          "bag_scan_period",
                                          "std_warn_level_x",
                                          "std_warn_level_y",
                                          "std_warn_level_yaw",
                                          "force_update_after_initialpose",
                                          "force_update_after_set_map",
                                          "restore_defaults"};

void getCount(ParamLoader& loader, const std::string& name, std::size_t& value, double low,
              double high, const std::string& meaning) {
  int number = static_cast<int>(value);
  loader.get(name, number, Range::between(low, high), meaning);
  value = static_cast<std::size_t>(number);
}

void loadLocalMap(ParamLoader& loader, LocalMapParams& p) {
  loader.get("local_map_radius", p.radius, Range::between(0.5, 100.0), "[m]");
  loader.get("local_map_resolution", p.resolution, Range::between(0.01, 1.0), "[m/cell]");
  loader.get("local_map_usable_range", p.usable_range, Range::atLeast(0.0),
             "[m] beams say nothing beyond it; 0: min(range_max, radius)");
  loader.get("local_map_obstacle_depth", p.obstacle_depth, {0.0, 10.0, true, false}, "[cells]");
  loader.get("local_map_free_below", p.free_below, Range::between(1, 8), "HIMM value");
  loader.get("local_map_occupied_above", p.occupied_above, Range::between(8, 14), "HIMM value");
  loader.get("local_map_footprint_radius", p.footprint_radius, Range::atLeast(0.0),
             "[m] free around the robot; 0: only what the laser sees");
}

void loadKernels(ParamLoader& loader, std::vector<KernelSpec>& kernels, GradientParams& gradient) {
  KernelProfile profile = kernels.front().profile;
  loader.getEnum<KernelProfile>("kernel", profile,
                                {{"uniform", KernelProfile::kUniform},
                                 {"gaussian", KernelProfile::kGaussian},
                                 {"inverted", KernelProfile::kInverted}},
                                "profile of the density kernels");
  std::vector<double> bandwidths;
  bandwidths.reserve(kernels.size());
  for (const KernelSpec& k : kernels) bandwidths.push_back(k.bandwidth);
  loader.get("bandwidths", bandwidths, Range::above(0.0), 1, "[m] one kernel each, 1 to 8");
  kernels.clear();
  for (double h : bandwidths) kernels.push_back({profile, h});
  loader.get("gradient_max_spread", gradient.max_direction_spread, {0.0, kPi, true, false},
             "[rad] a steadier gradient has a direction");
  loader.get("gradient_min_slope", gradient.min_slope, Range::atLeast(0.0),
             "[1/m] a flatter field has no direction");
}

void loadFsdModel(ParamLoader& loader, FsdModelParams& p) {
  using Undefined = FsdModelParams::Undefined;
  loader.get("fsd_epsilon_d", p.epsilon_d, {0.0, 1.0, true, false}, "tolerance of densities");
  loader.get("fsd_epsilon_theta", p.epsilon_theta, {0.0, kPi, true, false},
             "[rad] tolerance of directions");
  loader.get("fsd_penalty", p.penalty, {0.0, 1.0, true, true}, "factor beyond a tolerance");
  loader.get("fsd_occupied_penalty", p.occupied_penalty, {0.0, 1.0, true, false},
             "factor where the map is not free");
  using Profile = FsdModelParams::Profile;
  loader.getEnum<Profile>("fsd_profile", p.profile,
                          {{"step", Profile::kStep}, {"gaussian", Profile::kGaussian}},
                          "how the factor falls to the penalty within the tolerance");
  loader.getEnum<Undefined>("fsd_undefined", p.undefined,
                            {{"neutral", Undefined::kNeutral}, {"bounds", Undefined::kBounds}},
                            "what a density without a hard value tells");
}

/// amcl's laser_* go to the model that looks at beams.
void loadBeams(ParamLoader& loader, LocalizerParams& p) {
  for (const char* name : {"laser_max_beams", "laser_max_range", "laser_z_hit", "laser_z_rand",
                           "laser_z_short", "laser_z_max", "laser_lambda_short", "laser_sigma_hit",
                           "laser_likelihood_max_dist", "laser_independent_beams",
                           "laser_occupied_penalty", "laser_surface_offset", "cosine_exponent"})
    loader.know(name);
  const Range share = Range::between(0.0, 1.0), some = Range::between(1e-6, 1.0);
  const Range length = Range::between(1e-3, 10.0);
  const auto common = [&](int& beams, double& range) {
    loader.get("laser_max_beams", beams, Range::between(1, 10000), "beams used of a scan");
    double limit = range;
    loader.get("laser_max_range", limit, Range::between(-1.0, 1000.0),
               "[m] -1: the model's default");
    if (limit != -1.0 && limit < 0.1)
      throw ParameterError("laser_max_range", limit, "-1, or in [0.1, 1000] m");
    if (limit > 0.0) range = limit;
  };
  if (p.model == Model::kBeam) {
    common(p.beam.max_beams, p.beam.max_range);
    loader.get("laser_z_hit", p.beam.z_hit, share, "share of returns from mapped obstacles");
    loader.get("laser_z_short", p.beam.z_short, share, "from something nearer");
    loader.get("laser_z_max", p.beam.z_max, share, "without return");
    loader.get("laser_z_rand", p.beam.z_rand, some, "from anywhere");
    loader.get("laser_sigma_hit", p.beam.sigma_hit, length, "[m]");
    loader.get("laser_lambda_short", p.beam.lambda_short, Range::between(1e-3, 100.0), "[1/m]");
  } else if (p.model == Model::kCosine) {
    common(p.cosine.max_beams, p.cosine.max_range);
    loader.get("cosine_exponent", p.cosine.exponent, Range::between(0.1, 1000.0), "Eq. 3.8");
  } else if (p.model != Model::kFsd) {
    LikelihoodFieldParams& f = p.likelihood;
    common(f.max_beams, f.max_range);
    loader.get("laser_z_hit", f.z_hit, some, "share of returns from mapped obstacles");
    loader.get("laser_z_rand", f.z_rand, some, "from anywhere");
    loader.get("laser_sigma_hit", f.sigma_hit, length, "[m]");
    loader.get("laser_likelihood_max_dist", f.max_distance, Range::between(0.01, 100.0),
               "[m] beyond it an obstacle is not there");
    loader.get("laser_independent_beams", f.independent_beams, Range::between(0.1, 1e4),
               "what the beams of a scan count as");
    loader.get("laser_occupied_penalty", f.occupied_penalty, Range::between(1e-9, 1.0),
               "factor where the map is not free");
    loader.get("laser_surface_offset", f.surface_offset, Range::between(0.0, 0.5),
               "[cells] from the centre of a wall's outermost cell to its surface");
  }
}

void loadFilter(ParamLoader& loader, FilterParams& p) {
  getCount(loader, "max_particles", p.max_particles, 1, 1e7, "size of a global search");
  if (!loader.isSet("min_particles")) p.min_particles = std::min(p.min_particles, p.max_particles);
  getCount(loader, "min_particles", p.min_particles, 1, 1e7, "smallest adaptive size");
  loader.get("adaptive_size", p.adaptive_size, "KLD sampling; off: always max_particles");
  loader.get("kld_err", p.kld_error, {0.0, 1.0, true, true}, "Kullback-Leibler distance allowed");
  loader.get("kld_z", p.kld_z, {0.0, 10.0, true, true}, "quantile (2.33: 99 %)");
  loader.get("resample_below", p.resample_below, {0.0, 1.0, true, false},
             "resample when the effective size falls below this share");
  loader.get("recovery_alpha_slow", p.recovery_alpha_slow, {0.0, 1.0, false, true},
             "decay of the slow average; 0: no random particles");
  loader.get("recovery_alpha_fast", p.recovery_alpha_fast, {0.0, 1.0, false, true},
             "decay of the fast average");
  loader.get("recovery_slack", p.recovery_slack, {1.0, 100.0, false, true},
             "how far fast may fall below slow");
  const std::string unit[] = {"rotation from rotation", "[rad^2/m^2] rotation from translation",
                              "translation from translation",
                              "[m^2/rad^2] translation from rotation"};
  double* const alphas[] = {&p.motion.alpha1, &p.motion.alpha2, &p.motion.alpha3, &p.motion.alpha4};
  for (std::size_t i = 0; i < 4; ++i)
    loader.get("odom_alpha" + std::to_string(i + 1), *alphas[i], Range::atLeast(0.0), unit[i]);
}

void loadLocalizer(ParamLoader& loader, LocalizerParams& p) {
  loader.getEnum<Model>("model", p.model,
                        {{"fsd", Model::kFsd},
                         {"beam", Model::kBeam},
                         {"cosine", Model::kCosine},
                         {"likelihood", Model::kLikelihood},
                         {"hybrid", Model::kHybrid}},
                        "observation model");
  int seed = static_cast<int>(p.seed);
  loader.get("seed", seed, Range::atLeast(0), "equal seeds and input give equal results");
  p.seed = static_cast<std::uint64_t>(seed);
  loader.get("update_min_d", p.update_min_d, Range::atLeast(0.0), "[m] travel between updates");
  loader.get("update_min_a", p.update_min_a, Range::atLeast(0.0), "[rad] or turn");
  loadFilter(loader, p.filter);
  loader.get("converged_share", p.converged_share, {0.0, 1.0, true, false},
             "of the weight in the heaviest cluster, to be believed");
  loader.get("converged_stddev", p.converged_stddev, Range::above(0.0), "[m] and of its position");
  getCount(loader, "tracking_particles", p.tracking_particles, 1, 1e7, "hybrid, once converged");
  getCount(loader, "candidate_particles", p.candidate_particles, 1, 1e7,
           "hybrid, while the likelihood field chooses among places");
  loader.get("candidate_beams", p.candidate_beams, {0.0, 1e4, true, false},
             "hybrid, beams taken as independent meanwhile");
  getCount(loader, "max_candidate_bins", p.max_candidate_bins, 1, 1e7,
           "hybrid, which it does at this many places left");
  loader.get("explained_tolerance", p.explained_tolerance, Range::above(0.0),
             "[m] a return this near to a mapped obstacle is explained");
  loader.get("found_above", p.found_above, {0.0, 1.0, false, true},
             "hybrid, a place must explain this share to be believed");
  loader.get("lost_below", p.lost_below, {0.0, 1.0, false, true},
             "hybrid, lost below this explained share");
  loader.get("lost_ratio", p.lost_ratio, {0.0, 1.0, false, true},
             "or below this times its average");
  loadKernels(loader, p.map.kernels, p.map.gradient);
  loader.get("map_free_below", p.map.thresholds.free_below, Range::between(1, 100), "map value");
  loader.get("map_occupied_from", p.map.thresholds.occupied_from, Range::between(1, 100),
             "map value");
  loadFsdModel(loader, p.fsd);
  loadLocalMap(loader, p.local_map);
  loadBeams(loader, p);
}

void loadInitialPose(ParamLoader& loader, LocalizationServerParams& p) {
  hyselam::Pose2 mean, variance{0.25, 0.25, (kPi / 12.0) * (kPi / 12.0)};  // as amcl
  const bool given = loader.isSet("initial_pose_x") || loader.isSet("initial_pose_y") ||
                     loader.isSet("initial_pose_a");
  const Range finite = Range::between(-1e8, 1e8);
  for (const char* name : {"initial_pose_x", "initial_pose_y", "initial_pose_a"}) loader.know(name);
  if (given) {
    loader.get("initial_pose_x", mean.x, finite, "[m]");
    loader.get("initial_pose_y", mean.y, finite, "[m]");
    loader.get("initial_pose_a", mean.theta, finite, "[rad]");
  }
  loader.get("initial_cov_xx", variance.x, {0.0, 1e8, true, false}, "[m^2]");
  loader.get("initial_cov_yy", variance.y, {0.0, 1e8, true, false}, "[m^2]");
  loader.get("initial_cov_aa", variance.theta, {0.0, 1e8, true, false}, "[rad^2]");
  if (given)
    p.initial_pose = {{mean.x, mean.y, hyselam::normalizeAngle(mean.theta)},
                      {std::sqrt(variance.x), std::sqrt(variance.y), std::sqrt(variance.theta)}};
}

}  // namespace

FsdServerParams loadFsdParams(ParamLoader& loader) {
  FsdServerParams p;
  hyselam::loadScanInputParams(loader, p.input);
  loader.get("update_min_d", p.update_min_d, Range::atLeast(0.0),
             "[m] travel between observations; 0: one per scan");
  loader.get("update_min_a", p.update_min_a, Range::atLeast(0.0),
             "[rad] or turn; 0: turning alone gives none");
  loadKernels(loader, p.sensor.kernels, p.sensor.gradient);
  loader.get("min_frontier_share", p.sensor.min_frontier_share, Range::between(0.0, 1.0),
             "of the kernel's perimeter, to be a frontier");
  loadLocalMap(loader, p.sensor.local_map);
  hyselam::loadRate(loader, "gui_publish_rate", p.gui_publish_rate,
                    "[Hz] of local_map and fsd_markers; -1: no limit");
  loader.get("diagnostic_period", p.diagnostic_period, Range::between(0.05, 60.0), "[s]");
  p.sensor.validate();
  return p;
}

LocalizationServerParams loadLocalizationParams(ParamLoader& loader) {
  LocalizationServerParams p;
  for (const char* name : kIgnoredOfAmcl) loader.know(name);
  hyselam::loadScanInputParams(loader, p.input);
  hyselam::loadFrame(loader, "global_frame_id", p.global_frame_id, "frame of the map");
  if (p.global_frame_id == p.input.odom_frame_id || p.global_frame_id == p.input.base_frame_id)
    throw ParameterError("global_frame_id", p.global_frame_id,
                         "another frame than odom_frame_id and base_frame_id");
  loader.get("use_map_topic", p.use_map_topic, "map from the topic, else from static_map");
  loader.get("first_map_only", p.first_map_only, "later maps are ignored");
  loader.get("max_map_cells", p.max_map_cells, Range::between(1, 1e9), "a larger map is refused");
  loader.get("cache_dir", p.cache_dir, "folder for density fields; empty: none are kept");
  struct stat info {};
  if (!p.cache_dir.empty() && (::stat(p.cache_dir.c_str(), &info) != 0 || !S_ISDIR(info.st_mode)))
    throw ParameterError("cache_dir", p.cache_dir, "an existing folder");
  loader.get("tf_broadcast", p.tf_broadcast, "publish global_frame_id -> odom_frame_id");
  loader.get("publish_unconverged_tf", p.publish_unconverged_tf, "from guesses too, as amcl");
  loader.get("transform_tolerance", p.transform_tolerance, Range::between(0.0, 60.0),
             "[s] tf is dated this far ahead");
  hyselam::loadRate(loader, "save_pose_rate", p.save_pose_rate, "[Hz] -1: never");
  hyselam::loadRate(loader, "gui_publish_rate", p.gui_publish_rate,
                    "[Hz] of particlecloud, local_map, fsd_markers; -1: no limit");
  loader.get("max_cloud_particles", p.max_cloud_particles, Range::between(1, 1e7),
             "in particlecloud; of more, a fair sample");
  loader.get("diagnostic_period", p.diagnostic_period, Range::between(0.05, 60.0), "[s]");
  loadInitialPose(loader, p);
  loadLocalizer(loader, p.localizer);
  const double kernels = static_cast<double>(p.localizer.map.kernels.size());
  p.density_field_kernel = std::min(p.density_field_kernel, static_cast<int>(kernels) - 1);
  loader.get("density_field_kernel", p.density_field_kernel, Range::between(-1, kernels - 1),
             "index into bandwidths; -1: density_field is not published");
  p.localizer.validate();
  return p;
}

std::vector<std::string> ignoredAmclParams(const ParamLoader& loader) {
  std::vector<std::string> sentences;
  for (const char* name : kIgnoredOfAmcl)
    if (loader.isSet(name))
      sentences.push_back(std::string("parameter '") + name +
                          "' of amcl has no effect here (see README)");
  return sentences;
}

}  // namespace fsd_localization
