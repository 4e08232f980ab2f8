// SLAM: scans and odometry in; poses, graph and loops out. Sees no clock, no thread and no file.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hyselam_common/laser_scan.hpp"
#include "hyselam_pose_graph/graph_optimizer.hpp"
#include "hyselam_scan_matching/icp.hpp"
#include "hyselam_scan_matching/surface_map.hpp"
#include "ngram_slam/slam/loop_candidates.hpp"
#include "ngram_slam/slam/loop_verifier.hpp"
#include "ngram_slam/slam/slam_params.hpp"
#include "ngram_slam/slam/slam_types.hpp"
#include "ngram_slam/slam/word_places.hpp"

namespace ngram_slam {

/// Work that needs nothing of the engine: loops to verify, a graph to optimize, or both.
struct SlamJob {
  SlamParams params;
  std::vector<LoopTask> tasks;
  std::optional<hyselam_pose_graph::PoseGraph> graph;
};
struct SlamJobResult {
  std::vector<LoopTask> tasks;  ///< without segments
  std::vector<LoopVerification> verifications;
  std::optional<hyselam_pose_graph::OptimizeResult> optimized;
};
/// The same job gives the same result, on whatever thread.
SlamJobResult runJob(const SlamJob& job);

/// What adding a scan did.
struct SlamUpdate {
  hyselam::Pose2 base_in_map;
  bool keyframe = false;       ///< the scan became one
  bool weak_match = false;     ///< hardly any of it lies on known surfaces: odometry decided
  bool odometry_jump = false;  ///< odometry jumped before it: the robot is taken to have stood
  int word_matches = 0;        ///< new matches of words
};

/// Usage, on one thread (deterministic: the same calls give the same bytes):
///
///   engine.add(scan, odometry);
///   while (auto job = engine.takeJob()) engine.apply(runJob(*job));
///
/// or with a second thread, which takes a job, runs it without holding any lock, and applies the
/// result: both calls cost little. At most one job is out at a time.
class SlamEngine {
 public:
  static constexpr double kMaxStartWindow = 50.0;     ///< of startRun() [m]
  static constexpr double kDefaultStartWindow = 1.0;  ///< [m]
  static constexpr double kDefaultStartAngle = 0.5;   ///< [rad]

  /// @throws hyselam::ParameterError
  explicit SlamEngine(const SlamParams& params = {});
  /// Goes on in a building that is known: what comes next is another run, see startRun().
  /// @throws hyselam::ParameterError; hyselam::InputError for a state whose parts do not fit.
  SlamEngine(const SlamParams& params, SlamState state);

  /// Adds a scan; `odometry`: base in odom at its time.
  /// @throws hyselam::InputError for a stamp that is not after the last one of the run or not
  /// finite, a pose or geometry that is not finite or absurdly far away; nothing is changed then.
  SlamUpdate add(const hyselam::LaserScan& scan, const hyselam::Pose2& odometry);
  /// Ends the run: its last words are matched. The next scan starts another run.
  void endRun();
  /// Ends the run and sets where the next one starts; without it, it is taken to start where the
  /// last one ended. The first scan is matched within `window` [m] and `angle` [rad] of the pose.
  /// @throws hyselam::ParameterError, before anything is changed, for a pose that is not finite, a
  /// window outside of 0 (excluded) to kMaxStartWindow, an angle outside of 0 to pi.
  void startRun(const hyselam::Pose2& base_in_map, double window = kDefaultStartWindow,
                double angle = kDefaultStartAngle);

  /// Loops to verify and, if it is time, a graph to optimize; nothing if there is nothing to do or
  /// a job is still out.
  std::optional<SlamJob> takeJob();
  /// The same, but optimizes if there is any loop that has not been optimized with.
  std::optional<SlamJob> takeFinalJob();
  void apply(const SlamJobResult& result);

  const SlamParams& params() const { return params_; }
  const std::vector<SlamKeyframe>& keyframes() const { return state_.keyframes; }
  const SlamCounters& counters() const { return state_.counters; }
  const std::vector<SlamLoop>& loops() const { return state_.loops; }
  const std::vector<SlamMatch>& matches() const { return state_.matches; }
  /// Counts up when poses of old keyframes have moved.
  int revision() const { return revision_; }
  /// Base in map; identity before the first scan, which defines the map frame: it is where odometry
  /// has it.
  const hyselam::Pose2& pose() const { return pose_; }
  /// odom in map, after the last scan.
  hyselam::Pose2 odomInMap() const;
  /// Keyframes and edges, odometry first, then loops.
  hyselam_pose_graph::PoseGraph graph() const;
  /// Every scan at its place.
  std::vector<hyselam::StampedPose2> trajectory() const;
  const NgramRecognizer& recognizer() const { return words_.recognizer(); }
  /// Where the observations of the recognizer were made: keyframes.
  const std::vector<std::int32_t>& keyframeOfObservation() const {
    return state_.keyframe_of_observation;
  }
  /// What to save.
  SlamState state() const;

 private:
  using Points = std::shared_ptr<const hyselam_scan_matching::SurfacePoints>;
  /// How the base moved since the last scan that was matched.
  struct Motion {
    hyselam::Pose2 pose;          // by odometry
    Eigen::Matrix3d information;  // of it
    bool jump;
  };
  struct RunStart {
    hyselam::Pose2 pose;
    double window, angle;
  };
  /// A keyframe and a pose of another one relative to it, with the window to search.
  struct LoopGuess {
    int older, newer;
    bool far;
    LoopSource source;
    hyselam::Pose2 newer_in_older;
    double window, angle;
    std::int64_t match;  // of SlamState::matches, or kNoMatch
  };
  static constexpr std::int64_t kNoMatch = -1;
  /// The loops requested for one new word.
  struct WordSearch {
    int newer = -1;                    // keyframe
    std::vector<double> path_lengths;  // from it
    std::vector<double> requested;     // path lengths of the older keyframes of far loops
  };

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
  Eigen::Matrix3d matchScan(const hyselam_scan_matching::SurfacePoints& points,
                            const Motion& motion, SlamUpdate* update);
  hyselam_scan_matching::IcpResult matchLocalMap(const hyselam_scan_matching::SurfacePoints& points,
                                               const Eigen::Matrix3d& odometry_information,
                                               SlamUpdate* update);
  bool needsKeyframe(const Motion& motion) const;
  hyselam_pose_graph::PoseEdge odometryEdge(const Motion& motion,
                                            const Eigen::Matrix3d& scan_information) const;
  void placeScan(double stamp);
  void addKeyframe(const hyselam::LaserScan& scan, Points points,
                   const hyselam_pose_graph::PoseEdge* edge);
  int addWords(const hyselam::LaserScan& scan);
  void rebuildLocalMap();

  // The start of a run, in slam_runs.cpp.
  void beginRun(const hyselam::LaserScan& scan, const hyselam::Pose2& odometry);
  void beginRunInKnownMap(const hyselam::LaserScan& scan, Points points);
  hyselam_scan_matching::SurfaceMap mapAround(const RunStart& start) const;

  // Loops, in slam_loops.cpp.
  void searchLoopClosures();
  void searchNearLoops();
  void searchFarLoops();
  void addWordMatches(WordPlaces::Update update);
  void addThesisLoop(SlamMatch* match);
  void searchWordLoop(std::int64_t match, WordSearch* search);
  void requestVerification(const LoopGuess& guess);
  LoopTask::Segment segmentAround(int keyframe, double half_length, double max_path_length) const;
  void applyVerification(const LoopTask& task, const LoopVerification& answer);
  void addFarLoop(const SlamLoop& loop);
  void acceptFarLoop(const SlamLoop& loop);
  void addLoopEdge(const SlamLoop& loop);
  void rebuildPathLengths();
  int keyframeAt(double stamp) const;

  std::optional<SlamJob> makeJob(bool final);

  SlamParams params_;
  SlamState state_;
  WordPlaces words_;
  GraphPathLengths path_lengths_;
  hyselam_scan_matching::SurfaceMap local_map_;
  std::vector<LoopTask> tasks_;
  bool run_open_ = false, job_out_ = false;
  int first_of_run_ = 0;                            // keyframe
  double last_stamp_ = 0.0;                         // of the run
  hyselam::Pose2 pose_, odometry_;                  // of the last scan
  hyselam::Pose2 matched_pose_, matched_odometry_;  // of the last scan matched
  hyselam::Pose2 smooth_pose_;  // odometry as refined, without the corrections of optimization
  double path_length_ = 0.0;    // [m] driven over all runs
  double far_search_path_length_ = 0.0;  // path_length_ at the last far search
  std::optional<RunStart> start_;
  bool loops_changed_ = false, optimize_now_ = false;
  int optimized_keyframes_ = 0;
  std::size_t job_odometry_edges_ = 0;  // in the graph that is out
  int revision_ = 0;
};

}  // namespace ngram_slam
