// Where am I on this map? Scans and odometry in, pose with covariance out, or the plain word that
// it is not known yet. One object for the nodelet and the offline tool alike.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "fsd_localization/fsd_model.hpp"
#include "fsd_localization/particle_filter.hpp"
#include "fsd_localization/pose_estimate.hpp"
#include "fsd_localization/range_models.hpp"

namespace fsd_localization {

enum class Model {
  kFsd,         ///< free-space density (chapter 3)
  kBeam,        ///< ray casting, "bb"
  kCosine,      ///< "fcs"
  kLikelihood,  ///< likelihood field
  kHybrid,      ///< FSD until few places are left, then the likelihood field (3.5)
};
/// "fsd", "beam", "cosine", "likelihood", "hybrid". @throws hyselam::ParameterError for other
/// names.
Model modelFromName(const std::string& name);
const char* toString(Model model);

struct LocalizerParams {
  Model model = Model::kHybrid;
  std::uint64_t seed = 1;
  double update_min_d = 0.1;                     ///< travel between updates [m]
  double update_min_a = hyselam::radians(10.0);  ///< or turn [rad]

  FsdMapParams map;  ///< kernels of the FSD model
  LocalMapParams local_map;
  FsdModelParams fsd;
  BeamModelParams beam;
  CosineModelParams cosine;
  LikelihoodFieldParams likelihood;
  FilterParams filter;  ///< of the search; of everything in the modes with one model

  // When an estimate is believed.
  double converged_share = 0.9;    ///< of the weight in the heaviest cluster
  double converged_stddev = 0.75;  ///< of the position, along its widest axis [m]

  // Hybrid only.
  std::size_t tracking_particles = 2000;    ///< once converged
  std::size_t candidate_particles = 20000;  ///< while the likelihood field chooses among places
  double candidate_beams = 3.0;             ///< its independent_beams then: no haste to choose
  std::size_t max_candidate_bins =
      4000;                          ///< it does when FSD leaves this many bins of 0.5 m, 15 deg
  double explained_tolerance = 0.3;  ///< a return this near to a mapped obstacle is explained [m]
  double found_above = 0.75;  ///< a place is believed only if it explains this share, averaged
                              ///< over about 1 m of travel; else the search goes on
  double lost_below = 0.45;   ///< lost when the explained share of the returns, averaged
                              ///< over about 1 m of travel, is lower than this ...
  double lost_ratio = 0.85;   ///< ... or than this times its long-term average

  /// @throws hyselam::ParameterError naming the first value out of range.
  void validate() const;
};

enum class Phase {
  kGlobal,    ///< not found yet
  kTracking,  ///< found
  kLost,      ///< was found, is being searched for again
};
const char* toString(Phase phase);

struct LocalizationResult {
  double stamp = 0.0;                                    ///< of the scan [s]
  hyselam::Pose2 base_in_map;                            ///< mean of the heaviest cluster
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< of it, in the map frame [m, m, rad]
  bool converged = false;  ///< false: the pose is only the best of several guesses
  Phase phase = Phase::kGlobal;
  double cluster_share = 0.0;
  std::size_t particles = 0;
  double effective_size = 0.0;
  std::optional<double>
      explained;           ///< share of the returns that the estimate explains; hybrid only
  double travelled = 0.0;  ///< since the start or the last reset [m]
};

class Localizer {
 public:
  /// Prepares the map (see FsdMap::cached for `cache_path`; empty: no cache) and spreads particles.
  /// @throws hyselam::InputError, hyselam::ParameterError.
  Localizer(const hyselam::OccupancyGrid& map, const LocalizerParams& params,
            const std::string& cache_path = {}, const std::function<void(double)>& progress = {});
  ~Localizer();

  /// Looks whether the constructor could use this map, in a small part of its time.
  /// @throws hyselam::InputError if it has no free cell, hyselam::ParameterError if its cells are
  ///   too large or too small for a kernel.
  static void checkMap(const hyselam::OccupancyGrid& map, const LocalizerParams& params);

  /// Takes a scan with the odometry of its moment. Runs the filter when the robot has moved enough,
  /// or when `force` is set; returns its result then.
  /// @throws hyselam::InputError for a scan or pose that cannot be used, or a stamp that is not
  /// later
  ///   than the last one; the state is unchanged.
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
  /// Of the hybrid model; the others stay in the search.
  enum class Stage {
    kSearch,  ///< free-space density, everywhere
    kChoice,  ///< likelihood field, among the places that are left
    kTrack,   ///< likelihood field, one place
  };
  bool usesFsd() const { return params_.model == Model::kFsd || searching(); }
  bool searching() const { return params_.model == Model::kHybrid && stage_ == Stage::kSearch; }
  const ObservationModel& activeModel() const;
  void startSearch();
  void startChoice(Particles particles);
  void startTracking();
  void searchAgain();
  void continueWith(Particles particles, std::size_t min_particles, double independent_beams);
  /// @param motion since the last update [m]: travel and, while tracking, turn as such.
  void supervise(const PoseEstimate& estimate, double motion, LocalizationResult& result);

  LocalizerParams params_;
  bool map_was_cached_ = false;
  std::string map_cache_problem_;
  std::shared_ptr<const FsdMap> map_;
  std::unique_ptr<ObservationModel> model_;        // of the search, or the only one
  std::unique_ptr<LikelihoodFieldModel> tracker_;  // hybrid only
  FsdSensor sensor_;
  ParticleFilter filter_;
  Observation observation_;
  Stage stage_ = Stage::kSearch;
  Phase phase_ = Phase::kGlobal;
  std::optional<double> last_stamp_;
  std::optional<hyselam::Pose2> last_odom_;     // of the last scan
  std::optional<hyselam::Pose2> updated_odom_;  // of the last update
  double travelled_ = 0.0;
  std::optional<double> explained_fast_;  // averages since the likelihood field took over
  std::optional<double> explained_slow_;
  double judged_ = 0.0;  // [m] of motion since then
};

}  // namespace fsd_localization
