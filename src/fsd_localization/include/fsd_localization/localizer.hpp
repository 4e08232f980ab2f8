// Localisation on a known map (Maffei 2017, chapter 3): scans and odometry in, pose with covariance
// out, or that it is not known yet. One object for the nodelet and the offline tool alike.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "fsd_localization/filter/inlier_monitor.hpp"
#include "fsd_localization/filter/particle_filter.hpp"
#include "fsd_localization/filter/pose_estimate.hpp"
#include "fsd_localization/localizer_state.hpp"
#include "fsd_localization/models/beam_model.hpp"
#include "fsd_localization/models/cosine_model.hpp"
#include "fsd_localization/models/fsd_observation_model.hpp"
#include "fsd_localization/models/likelihood_field_model.hpp"
#include "hyselam_common/parameters.hpp"

namespace fsd_localization {

struct LocalizerParams {
  ObservationModelKind model = ObservationModelKind::kHybrid;
  std::uint64_t seed = 1;
  double update_min_d = 0.1;                     ///< travel between updates [m]
  double update_min_a = hyselam::radians(10.0);  ///< or turn [rad]

  FsdMapParams map;  ///< kernels of the FSD model
  LocalMapParams local_map;
  FsdObservationModelParams fsd;
  BeamModelParams beam;
  CosineModelParams cosine;
  LikelihoodFieldParams likelihood;
  FilterParams filter;  ///< of the search; of everything in the modes with one model

  // When an estimate counts as converged.
  double converged_cluster_weight = 0.9;  ///< share of the weight in the heaviest cluster
  double converged_stddev = 0.75;         ///< of the position, along its widest axis [m]

  // Hybrid only.
  std::size_t tracking_particles = 2000;     ///< once converged
  std::size_t hypothesis_particles = 20000;  ///< while the likelihood field chooses among places
  double hypothesis_beams = 3.0;  ///< its independent_beams then: few, so that it chooses slowly
  std::size_t max_hypothesis_bins =
      4000;                           ///< it does when FSD leaves this many bins of 0.5 m, 15 deg
  double inlier_distance = 0.3;       ///< a return this near to a mapped obstacle is an inlier [m]
  double found_inlier_ratio = 0.75;   ///< a place is accepted only with this share of inliers among
                                      ///< the returns, averaged over about 1 m of travel; else the
                                      ///< search goes on
  double lost_inlier_ratio = 0.45;    ///< lost when that average is lower than this ...
  double lost_relative_ratio = 0.85;  ///< ... or than this times the average over about 30 m

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError naming the first value out of range.
  void validate() const;

 private:
  void describeHybrid(hyselam::ParameterVisitor& visit);
};

struct LocalizationResult {
  double stamp = 0.0;                                    ///< of the scan [s]
  hyselam::Pose2 base_in_map;                            ///< mean of the heaviest cluster
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< of it, in the map frame [m, m, rad]
  bool converged = false;  ///< false: the pose is only the best of several hypotheses
  Phase phase = Phase::kGlobal;
  double cluster_weight = 0.0;  ///< share of the weight in the heaviest cluster, 0..1
  std::size_t particles = 0;
  double effective_size = 0.0;
  std::optional<double> inlier_ratio;  ///< share of inliers among the returns; hybrid only
  double travelled = 0.0;              ///< since the start or the last reset [m]
};

class Localizer {
 public:
  /// Prepares the map (see FsdMap::cached for `cache_path`; empty: no cache) and spreads particles.
  /// @throws hyselam::InputError, hyselam::ParameterError.
  Localizer(const hyselam::OccupancyGrid& map, const LocalizerParams& params,
            const std::string& cache_path = {}, const std::function<void(double)>& progress = {});
  ~Localizer();

  /// Whether the constructor could use this map, in a small part of its time.
  /// @throws hyselam::InputError if it has no free cell, hyselam::ParameterError if its cells are
  ///   too large or too small for a kernel.
  static void checkMap(const hyselam::OccupancyGrid& map, const LocalizerParams& params);

  /// Integrates a scan with the odometry of its moment. Runs the filter when the robot has moved
  /// enough, or when `force` is set; returns its result then.
  /// @throws hyselam::InputError for a scan or pose that cannot be used, or a stamp that is not
  ///   later than the last one; the state is unchanged.
  std::optional<LocalizationResult> update(const hyselam::LaserScan& scan,
                                           const hyselam::Pose2& base_in_odom, bool force = false);

  /// Starts over, knowing nothing: particles everywhere, surroundings forgotten.
  void relocalizeGlobally();
  /// Starts over around a pose of the map frame. Standard deviations [m, m, rad].
  /// @throws hyselam::InputError if a value is not finite, a deviation negative, or either more
  ///   than 1000 km off the map; the state is unchanged.
  void setInitialPose(const hyselam::Pose2& base_in_map, const hyselam::Pose2& stddev);
  /// Forgets time, odometry and surroundings (time went back, a bag starts again), keeps the
  /// particles.
  void restartClock();

  const LocalizerParams& params() const { return params_; }
  const FsdMap& map() const { return *map_; }
  const LocalMap& localMap() const { return sensor_.localMap(); }
  const Particles& particles() const { return filter_.particles(); }
  /// Of the last update; without readings before it or in modes that do not use FSD.
  const FsdObservation& lastObservation() const { return observation_.fsd; }
  bool mapWasCached() const { return map_was_cached_; }
  /// Why the cache could not be written; empty if it could, or if there is none.
  const std::string& mapCacheProblem() const { return map_cache_problem_; }

 private:
  bool isHybrid() const { return params_.model == ObservationModelKind::kHybrid; }
  bool usesFsd() const {
    return params_.model == ObservationModelKind::kFsd || (isHybrid() && isSearching(state_));
  }
  const ObservationModel& activeModel() const;
  LocalizationResult resultOf(const PoseEstimate& estimate, double effective_size) const;

  // Transitions between the states of the hybrid model.
  void startHypotheses(Particles particles);
  void startTracking();
  void searchAgain();
  /// @param motion since the last update [m]: travel and, while tracking, turn as such.
  void updateState(const PoseEstimate& estimate, double motion, LocalizationResult& result);
  void startTracker(Particles particles, std::size_t min_particles, double independent_beams);

  LocalizerParams params_;
  bool map_was_cached_ = false;
  std::string map_cache_problem_;
  std::shared_ptr<const FsdMap> map_;
  std::unique_ptr<ObservationModel> model_;        // of the search, or the only one
  std::unique_ptr<LikelihoodFieldModel> tracker_;  // hybrid only
  FsdSensor sensor_;
  ParticleFilter filter_;
  Observation observation_;
  LocalizerState state_ = LocalizerState::kGlobalSearch;
  std::optional<double> last_stamp_;
  std::optional<hyselam::Pose2> last_odom_;     // of the last scan
  std::optional<hyselam::Pose2> updated_odom_;  // of the last update
  double travelled_ = 0.0;
  InlierMonitor inliers_;  // since the likelihood field took over
};

}  // namespace fsd_localization
