// Localisation on a known map (Maffei 2017, chapter 3): estimates the pose with its covariance from
// scans and odometry, or reports that the robot is not localized yet. Used by the nodelet and by
// the offline tool.
//
// FSD, free-space density: the kernel-weighted share of the cells around the robot that are free
// and connected with it (Alg. 3.1). An FsdSensor keeps a local map of the scans and gives the
// densities of a scan, one per kernel.
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
#include "fsd_localization/search/alarm_watch.hpp"
#include "fsd_localization/search/followed_places.hpp"
#include "fsd_localization/search/place_judge.hpp"
#include "fsd_localization/search/probation.hpp"
#include "fsd_localization/search/rival_watch.hpp"
#include "fsd_localization/search/score_watch.hpp"
#include "fsd_localization/search/short_term_layer.hpp"
#include "fsd_localization/search/standing_watch.hpp"
#include "hyselam_common/parameters.hpp"
#include "hyselam_scan_matching/scan_odometry.hpp"

namespace fsd_localization {

struct LocalizerParams {
  ObservationModelKind model = ObservationModelKind::kHybrid;
  std::uint64_t seed = 1;
  double update_min_d = 0.1;                     ///< travel between updates [m]
  double update_min_a = hyselam::radians(10.0);  ///< or turn between updates [rad]
  /// Hybrid: the motion is refined by matching scans with what was seen last.
  bool refine_odometry = true;
  /// Hybrid: the scans of the last metres are searched on the whole map, and what is found decides
  /// what is believed.
  bool submap_search = true;
  /// With that: while tracking, what the last scans saw again and again where the map has nothing
  /// does not count.
  bool short_term_layer = true;
  double search_latency = 0.5;      ///< an answer counts so long after its question [s]
  double found_probability = 0.98;  ///< a place is believed from this probability on
  double lost_probability = 0.95;   ///< another one says from this on that the robot is lost
  PlaceOdds place_odds;

  FsdMapParams map;  ///< densities of the map: their kernels, what counts as free
  LocalMapParams local_map;
  FsdObservationModelParams fsd;  ///< compares densities of the scan with those of the map
  BeamModelParams beam;
  CosineModelParams cosine;  ///< compares expected and measured scan by the cosine similarity
  LikelihoodFieldParams likelihood;
  FilterParams filter;  ///< particle filter of the search; in single-model modes, the only one

  // When an estimate counts as converged.
  double converged_cluster_weight = 0.9;  ///< share of the weight in the heaviest cluster
  double converged_stddev = 0.75;         ///< of the position, along its widest axis [m]

  // Hybrid only: FSD until places are known, then the likelihood field.
  std::size_t tracking_particles = 1000;  ///< minimum while tracking
  /// While the likelihood field disambiguates the remaining pose hypotheses.
  std::size_t hypothesis_particles = 20000;
  /// Effective number of independent beams of a scan in this state; low, so that weights change
  /// slowly. While tracking: LikelihoodFieldParams::independent_beams.
  double hypothesis_beams = 3.0;
  /// Without submap_search: switch to the likelihood field when the particles occupy at most this
  /// many bins (0.5 m, 15 deg).
  std::size_t max_hypothesis_bins = 4000;
  double inlier_distance = 0.3;  ///< inlier: a return within this distance of a mapped obstacle [m]
  /// Share of inliers among the returns, averaged over about 1 m of travel, that is needed to track
  /// a pose that was told, or a place that the search by submaps alone is not sure of. Without
  /// submap_search: that each hypothesis needs; otherwise the search is repeated.
  double found_inlier_ratio = 0.75;
  /// Below it that average raises an alarm: the map is searched, and the pose is not relied on
  /// until the search confirms it. Without submap_search: lost.
  double lost_inlier_ratio = 0.45;
  /// Below this factor times the average over about 30 m, it also raises an alarm. Without
  /// submap_search: lost.
  double lost_relative_ratio = 0.85;

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError naming the first value out of range.
  void validate() const;

 private:
  void describeHybrid(hyselam::ParameterVisitor& visit);
};

struct LocalizationResult {
  double stamp = 0.0;          ///< of the scan [s]
  hyselam::Pose2 base_in_map;  ///< mean of the heaviest cluster
  /// Of the pose, in the map frame [m, m, rad]. With the search by submaps and not converged: 1 m
  /// along each axis at least, and while tracking about the spread of the places that the search
  /// thinks possible.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  bool converged = false;        ///< false: the pose is only the best of several hypotheses, or
                                 ///< in doubt
  Phase phase = Phase::kGlobal;  ///< kGlobal: not localized yet, by search or among hypotheses
  double cluster_weight = 0.0;   ///< share of the weight in the heaviest cluster, 0..1
  std::size_t particles = 0;
  double effective_size = 0.0;
  std::optional<double> inlier_ratio;  ///< share of inliers among the returns; hybrid only
  /// The robot stands, and for some seconds its scans have hardly fitted the map, or worse than
  /// usual and another place better: was it carried?
  bool misfits_standing = false;
  double travelled = 0.0;  ///< since the start or the last reset [m]
  /// Of the last search: how sure its best place is, 0..1, and how many places are not much worse.
  /// 0 places: the map does not explain what is seen.
  std::optional<double> place_probability;
  int places = 0;
};

class Localizer {
 public:
  /// Prepares the map (see FsdMap::cached for `cache_path`; empty: no cache) and spreads particles.
  /// `progress` is called with the fraction done, 0..1, while the densities of the map are
  /// computed.
  /// @throws hyselam::InputError, hyselam::ParameterError.
  Localizer(const hyselam::OccupancyGrid& map, const LocalizerParams& params,
            const std::string& cache_path = {}, const std::function<void(double)>& progress = {});
  ~Localizer();

  /// Checks that the constructor accepts this map; much faster than constructing.
  /// @throws hyselam::InputError if it has no free cell, hyselam::ParameterError if its cells are
  ///   too large or too small for a kernel.
  static void checkMap(const hyselam::OccupancyGrid& map, const LocalizerParams& params);

  /// Integrates a scan with the odometry pose at its stamp. Runs the filter and returns its result
  /// when the robot has moved enough, an answer of the search is due, or `force` is set.
  /// @throws hyselam::InputError for a scan or pose that cannot be used, or a stamp that is not
  ///   later than the last one; the state is unchanged.
  std::optional<LocalizationResult> update(const hyselam::LaserScan& scan,
                                           const hyselam::Pose2& base_in_odom, bool force = false);

  /// Restarts the global search: uniform particles, local map cleared.
  void relocalizeGlobally();
  /// Restarts around a pose in the map frame. Standard deviations [m, m, rad].
  /// @throws hyselam::InputError if a value is not finite, a standard deviation negative,
  ///   the position more than 1000 km from the map's origin, or the standard deviation of the
  ///   position larger than 1000 km; the state is unchanged.
  void setInitialPose(const hyselam::Pose2& base_in_map, const hyselam::Pose2& stddev);
  /// Resets stamp, odometry reference and local map (clock jumped back, bag loops); keeps the
  /// particles.
  void restartClock();

  /// Whether update() waits for an answer that is due (the default: equal runs give equal poses),
  /// or takes it up later. Whoever does not want to be held up asks isSearchLate() first.
  void waitForSearch(bool wait) { wait_for_search_ = wait; }
  /// Whether update() with a scan of this stamp needs an answer of the search that is not there
  /// yet.
  bool isSearchLate(double stamp) const {
    return search_.background && search_.background->isLate(stamp);
  }

  /// Whether localMap() is kept while no densities are read too (the default). What is not asked
  /// for costs time; a map that is asked for again begins anew. Poses do not depend on it.
  void keepLocalMap(bool keep) { keeps_local_map_ = keep; }
  bool keepsLocalMap() const { return keeps_local_map_; }

  const LocalizerParams& params() const { return params_; }
  const FsdMap& map() const { return *map_; }
  const LocalMap& localMap() const { return sensor_.localMap(); }
  /// What only the present has, of the last 20 m: points in the map frame, if the base is there.
  std::vector<hyselam::Point2> shortTermPoints(const hyselam::Pose2& base_in_map) const;
  const Particles& particles() const { return filter_.particles(); }
  /// Densities of the last update; empty before the first update and while FSD is not used.
  const FsdObservation& lastObservation() const { return observation_.fsd; }
  bool mapWasCached() const { return map_was_cached_; }
  /// Why the cache could not be written; empty if it could, or if there is none.
  const std::string& mapCacheProblem() const { return map_cache_problem_; }

 private:
  bool isHybrid() const { return params_.model == ObservationModelKind::kHybrid; }
  bool usesFsd() const {
    return params_.model == ObservationModelKind::kFsd || (isHybrid() && isSearching(state_));
  }
  bool refinesOdometry() const { return params_.refine_odometry && isHybrid(); }
  hyselam::Pose2 addScan(const hyselam::LaserScan& scan, const hyselam::Pose2& base_in_odom);
  const ObservationModel& activeModel() const;
  LocalizationResult resultOf(const PoseEstimate& estimate, double effective_size) const;

  /// The decisions of the search by submaps; see localizer_search.cpp.
  void updateBySearch(const PoseEstimate& estimate, double motion, LocalizationResult& result);
  void watchForAlarms(const PoseEstimate& estimate, LocalizationResult& result);
  bool watchStanding(bool stands, const hyselam::LaserScan& scan, const hyselam::Pose2& delta);
  bool isInDoubt() const;
  void widen(LocalizationResult& result) const;
  bool fitsWorse(const PoseEstimate& estimate);
  void askSearch(const PoseEstimate& estimate);
  bool needsOwnScans() const;
  bool wantsSearch();
  double lengthOfAlarm() const;
  void takeAnswer(const PoseEstimate& estimate, LocalizationResult& result);
  void decide(const SearchAnswer& answer, const Verdict& verdict, const PoseEstimate& estimate,
              LocalizationResult& result);
  bool isAgreed(const Verdict& verdict, const PoseEstimate& estimate) const;
  void confirmPose(const Verdict& verdict);
  bool isBeaten(const SearchAnswer& answer, const Verdict& verdict) const;
  bool isContradicted(const SearchAnswer& answer, const Verdict& verdict);
  void trackAt(const hyselam::Pose2& base_in_grid, LocalizationResult& result);
  void followPlaces(const std::vector<Place>& places, const hyselam::Pose2& motion,
                    const PoseEstimate& estimate);
  void forgetSearch();
  void learnShortTerm(const hyselam::Pose2& base_in_grid);

  // Transitions between the states of the hybrid model, see localizer_state.hpp.
  void startHypotheses(Particles particles);
  void startTracking();
  void searchAgain();
  /// Without the search by submaps.
  /// @param motion since the last update [m]: distance; while tracking, plus 0.5 m/rad * |turn|.
  void updateByInliers(const PoseEstimate& estimate, double motion, LocalizationResult& result);
  /// Replaces the filter by one that weighs `particles` by the likelihood field.
  void startLikelihoodFilter(Particles particles, std::size_t min_particles,
                             double independent_beams);

  LocalizerParams params_;
  bool map_was_cached_ = false;
  std::string map_cache_problem_;
  std::shared_ptr<const FsdMap> map_;
  std::unique_ptr<ObservationModel> model_;  // of the search; in single-model modes, the only one
  std::unique_ptr<LikelihoodFieldModel> likelihood_model_;  // hybrid only, after the search
  FsdSensor sensor_;
  bool keeps_local_map_ = true;
  bool local_map_is_old_ = false;  // scans were left out
  ParticleFilter filter_;
  Observation observation_;
  LocalizerState state_ = LocalizerState::kGlobalSearch;
  std::optional<double> last_stamp_;
  std::optional<hyselam::Pose2> last_odom_;     // of the last scan, as it came
  std::optional<hyselam::Pose2> updated_odom_;  // of the last update, refined
  hyselam_scan_matching::ScanOdometry scan_odometry_;
  bool by_wheels_ = false;  // since the last update a scan left the motion to the wheels
  double travelled_ = 0.0;
  InlierMonitor inliers_;  // since the likelihood field became active

  /// The search by submaps; hybrid only.
  struct Search {
    SubmapBuilder submap;
    ShortTermLayer short_term;
    std::unique_ptr<BackgroundSearch> background;
    double way = 0.0;                  // [m] of motion, turns counted
    double asked_at = 0.0;             // on that way, when it was asked last
    std::optional<double> waits_from;  // where the step to the next question begins; none: at once
    AlarmWatch alarm;
    AlarmWatch::Signs signs;            // since the last update
    std::optional<double> usual_match;  // average inlier ratio of scans with those before
    ScoreWatch score;                   // of the tracked pose with the scans of the last metres
    RivalWatch rivals;                  // what was better than the tracked pose
    FollowedPlaces followed;            // while the robot is not found
    Probation probation;                // of a place found lately
    double tracked_from = 0.0, next_check = 0.0;
    bool guided = false;             // a pose was told, and nothing found since
    std::optional<Verdict> verdict;  // the last one
    /// Where its question was asked, in the smooth frame; nothing: it says nothing about the alarm.
    std::optional<hyselam::Pose2> judged_at;
    StandingWatch standing;      // whether hardly anything fits the map
    StandingWatch odd_standing;  // whether less does than usual
    /// An answer about one that stands has found a better place, and none has denied it since.
    bool elsewhere = false;
    bool doubted_standing = false;  // and not told since that a search has confirmed the pose
    std::optional<hyselam::Pose2> tracked;  // pose of the last update, in the grid's frame
  };
  Search search_;
  bool wait_for_search_ = true;
};

}  // namespace fsd_localization
