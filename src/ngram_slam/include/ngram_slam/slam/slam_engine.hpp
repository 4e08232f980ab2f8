// SLAM: computes poses, graph and loop closures from scans and odometry. No clock, threads or file
// I/O.
//
// The engine owns the state (SlamState) and what recognizes places: words (WordPlaces), signatures
// (SignaturePlaces), the drawn maps of other runs (KnownMaps). What is slow (scans of loops to be
// compared, signatures, a search of drawn maps, the graph's optimization) it hands out as SlamJob;
// BackgroundJobs says when results count. Maps are drawn of its values, outside: PresentMap. Terms:
// slam_types.hpp; those of words: ngram_matcher.hpp.
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hyselam_common/laser_scan.hpp"
#include "hyselam_pose_graph/graph_optimizer.hpp"
#include "hyselam_scan_matching/icp.hpp"
#include "hyselam_scan_matching/surface_map.hpp"
#include "ngram_slam/slam/known_maps.hpp"
#include "ngram_slam/slam/loop_candidates.hpp"
#include "ngram_slam/slam/loop_verifier.hpp"
#include "ngram_slam/slam/odometry_doubt.hpp"
#include "ngram_slam/slam/odometry_noise.hpp"
#include "ngram_slam/slam/placed_loops.hpp"
#include "ngram_slam/slam/run_connections.hpp"
#include "ngram_slam/slam/run_graph.hpp"
#include "ngram_slam/slam/signature_places.hpp"
#include "ngram_slam/slam/slam_params.hpp"
#include "ngram_slam/slam/slam_types.hpp"
#include "ngram_slam/slam/word_places.hpp"

namespace ngram_slam {

/// Where in the other maps the last metres of a run fit best.
struct PlaceQuestion {
  int keyframe = 0;               ///< the newest of the scans
  int middle = 0;                 ///< that a loop is made for, of the same run
  std::vector<SubmapScan> scans;  ///< the newest last
  std::shared_ptr<KnownMaps> maps;
};
struct PlaceAnswer {
  int keyframe = 0, middle = 0;  ///< of the question
  std::optional<KnownPlace> place;
};

/// Work that does not access the engine: loops to verify, a graph to optimize, keyframes to be
/// recognized by their signatures. To be run once.
struct SlamJob {
  SlamParams params;
  std::vector<LoopTask> tasks;
  std::optional<hyselam_pose_graph::PoseGraph> graph;
  std::vector<SignatureKeyframe> keyframes;     ///< the next ones
  bool ends_run = false;                        ///< with the last of them
  std::shared_ptr<SignaturePlaces> signatures;  ///< what keyframes are added to; null: none are
  bool ask_each = false;  ///< asks for each of their places: the run is not tied to the map
  std::optional<PlaceQuestion> place;
};
struct SlamJobResult {
  std::vector<LoopTask> tasks;  ///< of the job, without the scans of their path segments
  std::vector<LoopVerification> verifications;
  std::optional<hyselam_pose_graph::OptimizeResult> optimized;
  std::vector<SignatureCandidate> candidates;
  std::optional<PlaceAnswer> place;
};
/// Deterministic; on any thread, but one job of an engine at a time, as they share what is
/// searched.
SlamJobResult runJob(const SlamJob& job);

/// What adding a scan did.
struct SlamUpdate {
  hyselam::Pose2 base_in_map;
  bool keyframe = false;            ///< the scan became a keyframe
  bool weak_match = false;          ///< few points on known surfaces: pose mostly from odometry
  bool odometry_jump = false;       ///< odometry jumped: the robot is assumed stationary
  bool odometry_overruled = false;  ///< the scan told the motion, odometry told another
  /// Neither odometry nor the scan tell how the robot moved. The scan begins another run, which
  /// loops tie to the map again; without loops by scans it stays where odometry has it.
  bool lost = false;
  bool awaited = false;  ///< the scan does not fit, later ones may: it counts for nothing
  int word_matches = 0;  ///< new n-gram matches of words, not yet verified
};

/// How far the pose that a run starts at is to be trusted.
enum class RunTrust {
  kSupposed,  ///< it may be wrong by metres or by half a turn, or be in another building
  kKnown      ///< the robot has not been moved unseen: the first scan is matched near it
};

/// What is known of where the current run lies.
enum class RunPlace {
  kFirst,     ///< there is no other run
  kSupposed,  ///< not tied to an earlier run: its poses are a guess
  kTied,      ///< loops tie it to the map of earlier runs
  kOwnMap     ///< not tied after RunStartParams::own_map_path: a map of its own, until it is
};
/// "first", "supposed", "tied", "own map".
const char* toString(RunPlace place);

/// Usage, on one thread (deterministic: the same calls give the same bytes):
///
///   engine.add(scan, odometry);
///   while (auto job = engine.takeJob()) engine.apply(runJob(*job));
///
/// or with a second thread, which takes a job, runs it without holding any lock, and applies the
/// result: both calls are cheap. At most one job is pending at a time. BackgroundJobs says when, so
/// that the map does not depend on the threads.
class SlamEngine {
 public:
  static constexpr double kMaxStartWindow = 50.0;     ///< limit of startRun() [m]
  static constexpr double kDefaultStartWindow = 1.0;  ///< [m]
  static constexpr double kDefaultStartAngle = 0.5;   ///< [rad]

  /// @throws hyselam::ParameterError
  explicit SlamEngine(const SlamParams& params = {});
  /// Continues a saved map: the next scan begins another run, see startRun().
  /// @throws hyselam::ParameterError; hyselam::InputError for a state that is inconsistent.
  SlamEngine(const SlamParams& params, SlamState state);
  /// No copies: jobs change what is recognised. Another engine is made of state().
  SlamEngine(const SlamEngine&) = delete;
  SlamEngine& operator=(const SlamEngine&) = delete;
  SlamEngine(SlamEngine&&) = default;
  SlamEngine& operator=(SlamEngine&&) = default;
  ~SlamEngine() = default;

  /// Adds a scan; `odometry`: base in odom at its stamp.
  /// @throws hyselam::InputError for a stamp that is not finite or not after the last one of the
  /// run, a pose that is not finite or has |x| or |y| above 9900 km, a scan geometry that is not
  /// finite, a zero angle increment, a laser more than 5 m from the base; the state is unchanged.
  SlamUpdate add(const hyselam::LaserScan& scan, const hyselam::Pose2& odometry);
  /// Ends the run: its pending words are matched. The next scan starts another run.
  void endRun();
  /// Ends the run and sets where the next one starts; otherwise it is supposed to start where
  /// the last one ended. A pose that is supposed is searched around first, the whole map later; one
  /// that is known is refined by matching the first scan within `window` [m] and `angle` [rad].
  /// @throws hyselam::ParameterError, before anything is changed, for a pose that is not finite, a
  /// window outside of 0 (excluded) to kMaxStartWindow, an angle outside of 0 to pi.
  void startRun(const hyselam::Pose2& base_in_map, double window = kDefaultStartWindow,
                double angle = kDefaultStartAngle, RunTrust trust = RunTrust::kSupposed);
  /// The same where odometry has gone on since the last keyframe of the map, which there must be:
  /// a known place.
  void startRunByOdometry(const hyselam::Pose2& base_in_odom);
  /// The same without any idea where: the whole map is searched.
  void startRunAnywhere();

  /// Loops to verify; if there are none, a graph to optimize when that is due. Empty if there is
  /// nothing to do or a job is pending.
  std::optional<SlamJob> takeJob();
  /// As takeJob(), but optimization is due as soon as there is a loop not optimized yet.
  std::optional<SlamJob> takeFinalJob();
  /// All that takeJob() would give one after the other, at once, as far as it is known now: for
  /// results that count later, so that none waits behind the others. Its steps are checked against
  /// the path as it is now: none sees what another one changes.
  std::optional<SlamJob> takeAllWork();
  void apply(const SlamJobResult& result);

  const SlamParams& params() const { return params_; }
  const std::vector<SlamKeyframe>& keyframes() const { return state_.keyframes; }
  /// Statistics since the start of the map: scans, matches, loops tried, verified and accepted.
  const SlamCounters& counters() const { return state_.counters; }
  /// Accepted loop closures: the loop edges of graph().
  const std::vector<SlamLoop>& loops() const { return state_.loops; }
  /// The other edges of graph().
  const std::vector<hyselam_pose_graph::PoseEdge>& odometry() const { return state_.odometry; }
  /// N-gram matches between words of the path, verified or not.
  const std::vector<SlamMatch>& matches() const { return state_.matches; }
  /// Incremented by every optimization, which moves poses of keyframes.
  int revision() const { return revision_; }
  /// Base in map; identity before the first scan of a new map. The map frame equals odom at the
  /// first scan, unless startRun() set its pose.
  const hyselam::Pose2& pose() const { return pose_; }
  /// odom in map, after the last scan.
  hyselam::Pose2 odomInMap() const;
  /// Keyframes as nodes; odometry edges, followed by loop edges.
  hyselam_pose_graph::PoseGraph graph() const;
  std::size_t scans() const { return state_.scans.size(); }  ///< whose poses are remembered
  /// Pose of every scan.
  std::vector<hyselam::StampedPose2> trajectory() const;
  /// Segments the path into words and finds their n-gram matches.
  const NgramRecognizer& recognizer() const { return words_.recognizer(); }
  /// Index of the keyframe at which each observation (a density every 0.1 m of path) was made.
  const std::vector<std::int32_t>& keyframeOfObservation() const {
    return state_.keyframe_of_observation;
  }
  RunPlace runPlace() const;
  /// Length of the current run [m].
  double pathOfRun() const { return path_length_ - run_.begin; }
  /// How much of it was driven when it was tied to an earlier one [m]; nothing if it is not.
  std::optional<double> pathUntilTied() const;
  /// How often loops contradicted the ties of a run so much that these were given up, since the
  /// process began.
  int tiesWithdrawn() const { return ties_withdrawn_; }
  const RunConnections& connections() const { return connections_; }
  /// What is known of the map besides the keyframes.
  const SettledMap& settled() const { return state_.settled; }
  /// The first run that is not of the saved map the engine was made with.
  std::uint32_t firstRunOfSession() const { return session_; }
  /// Whether it can be told what changed since the sessions before: there were none, or the run is
  /// tied to the map of an earlier one.
  bool knowsChanges() const;
  /// By run, whether it belongs to the map that the pose refers to. While the run's place is only
  /// supposed that is the map it was supposed in, without the run.
  std::vector<bool> shownRuns() const;
  /// Trouble with odometry and missing scans since the process began: not saved.
  const RoughRoad& roughRoad() const { return doubt_.road; }
  /// What the scans taught about the odometry since the process began: not saved.
  const OdometryNoiseLearner& odometryNoise() const { return odometry_noise_; }
  /// State for serialization.
  SlamState state() const;

 private:
  using Points = std::shared_ptr<const hyselam_scan_matching::SurfacePoints>;
  /// How the base moved since the last scan that was matched.
  struct Motion {
    hyselam::Pose2 pose;          // by odometry
    Eigen::Matrix3d information;  // of the motion
    bool jump;
    double seconds = 0.0;  // since the last scan that was matched
    bool unseen = false;   // odometry tells hardly any, the scan is another one than then
  };
  /// What tells that odometry fails.
  struct Doubt {
    hyselam::LaserScan matched;         // the last scan that was
    std::optional<double> unfit_since;  // [s]: scans that do not fit are awaited to
    bool since_keyframe = false;        // odometry was overruled since the last keyframe
    double stamp_of_keyframe = 0.0;     // [s]
    bool searched = false;              // a scan, as odometry left much open, since the keyframe
    std::deque<int> steps;              // keyframes whose step is to be asked again
    RoughRoad road;
  };
  struct RunStart {
    hyselam::Pose2 pose;
    double window, angle;
    RunTrust trust;
    bool anywhere;  // the pose says nothing
  };
  /// The current run, all in [m] of path.
  struct Run {
    double begin = 0.0;
    double searched = 0.0, searched_map = 0.0;  // last, for a place in another map
    double drawn = 0.0;                         // last, for the drawn other maps
    std::optional<double> tied;
    bool known = false;                     // RunTrust::kKnown
    bool anywhere = false;                  // nothing is supposed of where it begins
    std::uint32_t supposed_in = 0;          // map
    std::shared_ptr<KnownMaps> other_maps;  // used by jobs only
    std::vector<PlacedLoop> placed;         // in them, while the run is not tied
  };
  /// A keyframe and a pose of another one relative to it, with the window to search.
  struct LoopGuess {
    int older, newer;
    bool far;
    LoopSource source;
    hyselam::Pose2 newer_in_older;
    double window, angle;
    std::int64_t match;  // of SlamState::matches, or kNoMatch
    bool any_heading = false;
    double place_probability = 0.0;
  };
  static constexpr std::int64_t kNoMatch = -1;
  /// The loop verifications requested for one new word.
  struct WordSearch {
    int newer = -1;                    // keyframe
    std::vector<double> path_lengths;  // from it
    std::vector<double> requested;     // path lengths of the older keyframes of far loops
  };

  bool usesSignatures() const {
    return params_.loops == LoopClosureMode::kSignatures || params_.loops == LoopClosureMode::kAll;
  }
  bool usesWords() const {
    return params_.loops == LoopClosureMode::kNgrams || params_.loops == LoopClosureMode::kAll ||
           params_.loops == LoopClosureMode::kThesis;
  }
  const SlamKeyframe& keyframe(int k) const {
    return state_.keyframes[static_cast<std::size_t>(k)];
  }
  int lastKeyframe() const { return static_cast<int>(state_.keyframes.size()) - 1; }

  // The steps of add(), in slam_engine.cpp.
  Motion advanceOdometry(const hyselam::Pose2& odometry);
  bool isNearLastMatch(const Motion& motion) const;
  bool mayStand(const hyselam::LaserScan& scan, Motion* motion) const;
  Eigen::Matrix3d matchScan(const hyselam_scan_matching::SurfacePoints& points,
                            const Motion& motion, SlamUpdate* update);
  hyselam_scan_matching::IcpResult matchLocalMap(const hyselam_scan_matching::SurfacePoints& points,
                                                 const Motion& motion, SlamUpdate* update);
  bool isBeyondRefinement(const hyselam_scan_matching::SurfacePoints& points,
                          const Motion& motion) const;
  std::optional<hyselam_scan_matching::IcpResult> searchByLikelihood(
      const hyselam_scan_matching::SurfacePoints& points, const Motion& motion,
      const hyselam_scan_matching::IcpResult& best) const;
  std::optional<hyselam_scan_matching::IcpResult> searchByInliers(
      const hyselam_scan_matching::SurfacePoints& points, const Motion& motion,
      const hyselam_scan_matching::IcpResult& best) const;
  // Where odometry is not to be believed, in slam_doubt.cpp.
  void doubtOdometry(const hyselam_scan_matching::SurfacePoints& points, const Motion& motion,
                     hyselam_scan_matching::IcpResult* best, SlamUpdate* update);
  std::optional<hyselam_scan_matching::IcpResult> searchWide(
      const hyselam_scan_matching::SurfacePoints& points, const Motion& motion) const;
  void searchAfterJump(const hyselam_scan_matching::SurfacePoints& points, const Motion& motion,
                       hyselam_scan_matching::IcpResult* best);
  bool tellsNothing(const Motion& motion, const SlamUpdate& update) const;
  bool awaitsMore(const Motion& motion);
  bool splitsRuns() const;
  void splitRun(const hyselam::LaserScan& scan, const hyselam::Pose2& by_odometry);
  void noteMatched(const hyselam::LaserScan& scan);
  // Steps of the path that are asked again, in slam_steps.cpp.
  void noteStep(const Motion& motion);
  std::optional<LoopTask> stepToCheck();
  void applyStep(const LoopTask& task, const LoopVerification& answer);

  bool needsKeyframe(const Motion& motion) const;
  hyselam_pose_graph::PoseEdge odometryEdge(const Motion& motion,
                                            const Eigen::Matrix3d& scan_information) const;
  void learnOdometryNoise(const Motion& motion, const Eigen::Matrix3d& scan_information);
  void recordScanPose(double stamp);
  void addKeyframe(const hyselam::LaserScan& scan, Points points,
                   const hyselam_pose_graph::PoseEdge* edge);
  int addWords(const hyselam::LaserScan& scan);
  void rebuildLocalMap();

  // The start of a run, in slam_runs.cpp.
  void beginRun(const hyselam::LaserScan& scan, const hyselam::Pose2& odometry);
  void beginRunInKnownMap(const hyselam::LaserScan& scan, Points points, const RunStart& start);
  void beginRunSomewhere(const hyselam::LaserScan& scan, Points points, const RunStart& start);
  std::optional<hyselam_scan_matching::IcpResult> matchAround(
      const RunStart& start, const hyselam_scan_matching::SurfacePoints& points) const;
  hyselam_scan_matching::SurfaceMap mapAround(const RunStart& start) const;

  // Where a run lies in other maps, in slam_run_places.cpp.
  std::uint32_t currentRun() const { return state_.keyframes.back().run; }
  bool isUntied() const;
  bool mayBeDoubted() const;
  std::uint32_t largestMapBut(std::uint32_t run) const;
  std::vector<int> placesOfOtherMaps(int keyframe) const;
  void searchOtherMaps();
  void askForPlace();
  void forgetPlaces();
  void applyPlace(const PlaceAnswer& answer);
  void addPlacedLoop(const SlamLoop& loop, double place_probability);
  void placeRun(const SlamLoop& tie);
  void doubtTies(const SlamLoop& loop);
  std::vector<std::uint32_t> mapsOfRuns() const;
  void refreshConnections();

  // Loops, in slam_loops.cpp.
  void searchLoopClosures();
  std::vector<double> pathLengthsInReach(int keyframe) const;
  int middleOfNewSegment() const;
  void searchNearLoops();
  void searchFarLoops();
  void addWordMatches(WordPlaces::Update update);
  void addUnverifiedLoop(SlamMatch* match);  // of LoopClosureMode::kThesis
  void searchWordLoop(std::int64_t match, WordSearch* search);
  void queueSavedKeyframes();
  void queueKeyframe(int keyframe, const hyselam::Pose2* motion);
  void searchSignatureLoops(const std::vector<SignatureCandidate>& candidates);
  void requestVerification(const LoopGuess& guess);
  SlamCounters::Loops& counterOf(LoopSource source, bool far);
  void applyVerification(const LoopTask& task, const LoopVerification& answer);
  bool isWhereSupposed(const SlamLoop& loop) const;
  void addFarLoop(const SlamLoop& loop);
  std::vector<SlamLoop> usedFarLoops() const;
  void acceptFarLoop(const SlamLoop& loop);
  void addLoopEdge(const SlamLoop& loop);
  void rebuildPathLengths();
  int keyframeAt(double stamp) const;

  // Work for another thread, in slam_jobs.cpp.
  std::optional<SlamJob> makeJob(bool final);
  bool mustSign(bool final) const;
  void addKeyframesTo(SlamJob* job);
  bool mustOptimize(bool final) const;
  void addGraphTo(SlamJob* job, bool final);
  std::optional<SlamJob> sendOut(SlamJob job);
  void applyOptimized(const hyselam_pose_graph::OptimizeResult& optimized);

  SlamParams params_;
  SlamState state_;
  OdometryNoiseLearner odometry_noise_;
  WordPlaces words_;                             // the words of the path and their n-gram matches
  std::shared_ptr<SignaturePlaces> signatures_;  // used by jobs only
  std::vector<SignatureKeyframe> keyframes_to_sign_;  // for the next job
  bool run_to_end_ = false;                           // behind them
  GraphPathLengths path_lengths_;
  RunConnections connections_;  // by the loops
  hyselam_scan_matching::SurfaceMap local_map_;
  std::vector<LoopTask> tasks_;
  std::optional<PlaceQuestion> place_question_;  // for the next job
  bool run_open_ = false, job_pending_ = false;
  int first_of_run_ = 0;                            // keyframe
  double last_stamp_ = 0.0;                         // of the run
  hyselam::Pose2 pose_, odometry_;                  // of the last scan
  hyselam::Pose2 matched_pose_, matched_odometry_;  // of the last scan matched
  hyselam::Pose2 smooth_pose_;  // odometry as refined, without the corrections of optimization
  double path_length_ = 0.0;    // [m] driven over all runs
  double far_search_path_length_ = 0.0;  // path_length_ at the last far search
  std::optional<RunStart> start_;
  Run run_;
  std::vector<SlamLoop> doubts_;  // verified far loops that contradict the ties of the run
  Doubt doubt_;
  std::uint32_t session_ = 0;
  int ties_withdrawn_ = 0;
  bool loops_changed_ = false, optimize_now_ = false;
  int optimized_keyframes_ = 0;
  RunGraph job_graph_;  // of the pending job, which has its poses and edges
  int revision_ = 0;
};

}  // namespace ngram_slam
