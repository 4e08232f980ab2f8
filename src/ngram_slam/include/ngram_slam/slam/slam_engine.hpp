// SLAM: scans and odometry in; poses, graph and loops out. Sees no clock, no thread and no file.
#pragma once

#include <optional>
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

/// Work that needs nothing of the engine: loops to verify, a graph to optimise, or both.
struct SlamJob {
  SlamParams params;
  std::vector<LoopTask> tasks;
  std::optional<hyselam_pose_graph::PoseGraph> graph;
};
struct SlamJobResult {
  std::vector<LoopTask> tasks;  ///< without stretches
  std::vector<LoopAnswer> answers;
  std::optional<hyselam_pose_graph::OptimizeResult> optimised;
};
/// The same job gives the same result, on whatever thread.
SlamJobResult runJob(const SlamJob& job);

/// What a scan brought about.
struct SlamUpdate {
  hyselam::Pose2 base_in_map;
  bool keyframe = false;  ///< it became one
  bool weak = false;      ///< hardly any of it lies on known surfaces: odometry decided
  bool leap = false;      ///< odometry leapt before it: the robot is taken to have stood
  int words = 0;          ///< matches of words told
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
  static constexpr double kMaxStartWindow = 50.0;  ///< of startRun() [m]

  /// @throws hyselam::ParameterError
  explicit SlamEngine(const SlamParams& params = {});
  /// Goes on in a building that is known: what comes next is another run, see startRun().
  /// @throws hyselam::ParameterError; std::invalid_argument for a state whose parts do not fit.
  SlamEngine(const SlamParams& params, SlamState state);

  /// Takes a scan in; `odometry`: base in odom at its time.
  /// @throws hyselam::InputError for a stamp that is not after the last one of the run or not
  /// finite, a pose or geometry that is not finite or absurdly far away; nothing is changed then.
  SlamUpdate add(const hyselam::LaserScan& scan, const hyselam::Pose2& odometry);
  /// Ends the run: its last words are matched. The next scan starts another run.
  void endRun();
  /// Ends the run and tells where the robot stands now; without it a next run is taken to start
  /// where the last one ended. The first scan is matched within `window` [m] and `turn` [rad] of
  /// it. @throws hyselam::ParameterError, before anything is changed, for a pose that is not
  /// finite, a window outside of 0 (excluded) to kMaxStartWindow, a turn outside of 0 to pi.
  void startRun(const hyselam::Pose2& base_in_map, double window = 1.0, double turn = 0.5);

  /// Loops to verify and, if it is time, a graph to optimise; nothing if there is nothing to do or
  /// a job is still out.
  std::optional<SlamJob> takeJob();
  /// The same, but optimises if there is any loop that has not been optimised with.
  std::optional<SlamJob> takeLastJob();
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
  const NgramRecognizer& recogniser() const { return words_.recogniser(); }
  /// Where the observations of the recogniser were made: keyframes.
  const std::vector<std::int32_t>& keyframeOfObservation() const {
    return state_.keyframe_of_observation;
  }
  /// What to save.
  SlamState state() const;

 private:
  bool usesWords() const {
    return params_.loops == SlamLoops::kNgrams || params_.loops == SlamLoops::kAll ||
           params_.loops == SlamLoops::kThesis;
  }
  void startAt(const hyselam::LaserScan& scan, const hyselam::Pose2& odometry);
  hyselam_scan_matching::IcpResult matchLocally(const hyselam_scan_matching::SurfacePoints& points,
                                                const Eigen::Matrix3d& believed,
                                                SlamUpdate* update);
  void addKeyframe(const hyselam::LaserScan& scan,
                   std::shared_ptr<const hyselam_scan_matching::SurfacePoints> points,
                   const hyselam_pose_graph::PoseEdge* edge);
  void rebuildLocalMap();
  void lookAround();
  void takeWords(WordPlaces::Update update);
  void ask(int older, int newer, bool far, LoopSource source, const hyselam::Pose2& guess,
           double window, double turn, std::int64_t match);
  LoopTask::Stretch stretchAround(int keyframe, double half, double not_after) const;
  void relearnWays();
  void takeAnswer(const LoopTask& task, const LoopAnswer& answer);
  void accept(const SlamLoop& loop);
  void takeFar(const SlamLoop& loop);
  int keyframeAt(double stamp) const;
  std::optional<SlamJob> job(bool last);

  SlamParams params_;
  SlamState state_;
  WordPlaces words_;
  GraphWays ways_;
  hyselam_scan_matching::SurfaceMap local_;
  std::vector<LoopTask> tasks_;
  bool run_open_ = false, job_out_ = false;
  int first_of_run_ = 0;
  double last_stamp_ = 0.0;                         // of the run
  hyselam::Pose2 pose_, odometry_;                  // of the last scan
  hyselam::Pose2 matched_pose_, matched_odometry_;  // of the last scan matched
  hyselam::Pose2 smooth_;  // the way as refined, without the leaps of optimisation
  double way_ = 0.0;
  double far_searched_ = 0.0;  // way at the last far search
  struct Start {
    hyselam::Pose2 pose;
    double window, turn;
  };
  std::optional<Start> start_;
  bool dirty_ = false, urgent_ = false;
  int optimised_keyframes_ = 0;
  std::size_t job_odometry_ = 0;  // edges of odometry in the graph that is out
  int revision_ = 0;
};

}  // namespace ngram_slam
