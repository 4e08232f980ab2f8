// SLAM of a live robot: scans and tf in; map, map -> odom, words, loops and the topological graph
// out.
#pragma once

#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <hyselam_msgs/SlamGraph.h>
#include <hyselam_msgs/StatePath.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <std_srvs/Trigger.h>
#include <tf2_ros/transform_broadcaster.h>

#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "hyselam_common/ros/diagnostics.hpp"
#include "hyselam_common/ros/rate_limit.hpp"
#include "hyselam_common/ros/result_wait.hpp"
#include "hyselam_common/ros/scan_input.hpp"
#include "ngram_slam/ros/slam_parameters.hpp"
#include "ngram_slam/ros/slam_publisher.hpp"
#include "ngram_slam/slam/background_jobs.hpp"
#include "ngram_slam/slam/present_map.hpp"
#include "ngram_slam/slam/region_graph.hpp"
#include "ngram_slam/slam/slam_engine.hpp"

namespace ngram_slam {

/// Topics: in `scan`, tf, `initialpose`; out `map`, `map_metadata`, `map_certainty`, `map_changes`,
/// `map_change_markers`, `region_graph`, `localization_status` (latched), `words`, `word_matches`,
/// `semantic_regions`, `path`, `slam_markers`, tf map -> odom, /diagnostics. Services:
/// `dynamic_map`, `slam_graph`, `~save`, `~load`, `~pause`, `~resume`.
///
/// Scans come on the queue of `nh`, which must serve one callback at a time. Loops are verified and
/// poses optimized on one thread, maps drawn, saved and consolidated on another, services answered
/// on a third: none of them delays a scan by more than it takes to copy what it needs, but where a
/// loop that counts is not there yet (SlamServerParams::loop_wait).
class SlamServer {
 public:
  /// Reads and checks the parameters of `private_nh` and the state, before anything is subscribed.
  /// A state that cannot be used is renamed (hyselam::putAside()), told of, and a new map begun.
  /// @throws hyselam::ParameterError
  SlamServer(ros::NodeHandle nh, const ros::NodeHandle& private_nh);
  /// Saves the state.
  ~SlamServer();
  SlamServer(const SlamServer&) = delete;
  SlamServer& operator=(const SlamServer&) = delete;

 private:
  /// An engine with what has been published of it.
  struct Mapping {
    explicit Mapping(const SlamServerParams& params, SlamState state = {});
    /// Segments the observations that came since; returns their regions.
    std::vector<SemanticRegion> segmentNew();

    const std::string name;  // another one for each, of all processes
    SlamEngine engine;
    BackgroundJobs jobs;
    SemanticSegmenter segmenter;
    std::vector<SemanticRegion> regions;
    std::uint32_t segmented = 0;  // observations
    std::size_t published_words = 0, published_matches = 0;
    int requantizations = 0;
    double session_end;  // [m] of path
    std::uint64_t saved_scans = 0;
    bool localized = false;  // a scan has come: odomInMap() means something
  };
  /// For the diagnostics.
  struct Status {
    std::string job_error, map_error, save_error;
    std::string session_error;
    std::string put_aside;  // why a state was, until people save or load one
    double scan_ms = 0.0, max_scan_ms = 0.0, job_ms = 0.0, map_ms = 0.0, save_ms = 0.0;
    double session_ms = 0.0;
    std::size_t paused_scans = 0, weak_matches = 0, sessions_ended = 0;
    std::string changes;  // since the last session; nothing before a map is drawn
  };
  /// What a map is drawn from, copied from the engine.
  struct MapRequest {
    std::vector<SlamKeyframe> keyframes;
    std::vector<SlamLoop> loops;
    RegionGraph graph;
    std::vector<bool> shown;  // runs
    SettledMap settled;
    std::uint32_t session = 0;  // its first run
    bool knows_changes = false;
    std_msgs::Header header;
    long revision = 0, epoch = -1;
  };
  /// Their own queue and thread.
  struct Services {
    ros::CallbackQueue queue;
    ros::ServiceServer save, load, pause, resume, map, graph;
    std::unique_ptr<ros::AsyncSpinner> spinner;
  };
  struct OdomInMapBroadcaster {
    tf2_ros::TransformBroadcaster tf;
    ros::Time last;  // stamp of the last transform
    ros::WallTimer timer;
  };
  /// Where a run begins, and how far around that is searched.
  struct RunStart {
    hyselam::Pose2 base_in_map;
    double window, angle;
    RunTrust trust;
  };
  struct LastScan {
    ros::Time stamp;
    hyselam::Pose2 odometry;
  };
  struct LaterScan {
    hyselam::LaserScan scan;
    hyselam::Pose2 odometry;
  };
  enum class NextScan { kGoesOn, kAfterPause, kAfterJump };

  bool onScan(const hyselam::LaserScan& scan, const hyselam::Pose2& base_in_odom,
              const ros::Time& stamp);
  bool isHeldUp(const ros::Time& stamp);
  bool takeIn(double stamp);
  bool takeInNow();
  void noteJobError(const std::string& error);
  bool isIdle() const;
  void addScan(const hyselam::LaserScan& scan, const hyselam::Pose2& base_in_odom);
  RunStart runStart(const hyselam::Pose2& base_in_odom) const;
  void startRun(const hyselam::Pose2& base_in_odom);
  void onTimeJump();
  void onInitialPose(const geometry_msgs::PoseWithCovarianceStamped::ConstPtr& msg);
  void publishStatus();
  void publishNewWords();
  void publishNewRegions();
  void broadcast(const ros::Time& stamp);
  void advertiseServices(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh);
  bool onSave(hyselam_msgs::StatePath::Request& request, hyselam_msgs::StatePath::Response& out);
  bool onLoad(hyselam_msgs::StatePath::Request& request, hyselam_msgs::StatePath::Response& out);
  bool onGraph(hyselam_msgs::SlamGraph::Request& request, hyselam_msgs::SlamGraph::Response& out);
  bool onPause(bool pause, std_srvs::Trigger::Response& out);
  bool drawsMaps() const { return params_.map_update_interval > 0.0; }
  void runJobs();
  void runMapper();
  std::optional<MapRequest> awaitMapRequest();
  void drawMap(const MapRequest& request, PresentMap* mapper);
  bool isSessionOver() const;
  std::unique_ptr<Mapping> nextSession(SlamState state) const;
  bool goOnWith(std::unique_ptr<Mapping>* next);
  void changeSession();
  SlamState storedState();
  std::string saveState(const std::string& path);
  void saveIfChanged(const char* when);
  std::string pathOrDefault(const std::string& path) const;
  void report(diagnostic_msgs::DiagnosticStatus& status);
  std_msgs::Header header(const std::string& frame) const;

  const std::string log_name_;
  SlamServerParams params_;  // constant once the state was looked at

  std::mutex mutex_;  // guards what follows, up to the next mutex
  std::condition_variable work_;
  std::unique_ptr<Mapping> mapping_;
  long epoch_ = 0;  // counts mappings: results for an earlier one are void
  bool ending_ = false, map_due_ = false, paused_ = false;
  LastScan last_scan_;
  ros::WallTime last_scan_came_;  // 0: none did
  hyselam::ResultWait result_wait_{params_.loop_wait};
  NextScan next_scan_ = NextScan::kGoesOn;
  /// Those that came since the session's map was copied to be consolidated; nothing: it was not, or
  /// the copy is void.
  std::optional<std::vector<LaterScan>> later_scans_;
  std::optional<hyselam::InitialPose> initial_pose_;  // not yet used
  Status status_;
  std::pair<RunPlace, int> published_place_{RunPlace::kFirst, -1};  // with ties withdrawn
  OdomInMapBroadcaster broadcaster_;

  std::mutex save_mutex_;  // one saving at a time

  hyselam::RateLimit status_rate_, map_rate_;
  SlamPublisher publisher_;
  Services services_;
  std::unique_ptr<hyselam::ScanInput> input_;
  ros::Subscriber initial_pose_subscriber_;
  std::unique_ptr<hyselam::Diagnostics> diagnostics_;
  std::thread job_thread_, map_thread_;
};

}  // namespace ngram_slam
