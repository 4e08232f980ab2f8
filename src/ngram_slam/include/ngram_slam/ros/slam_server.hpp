// SLAM of a live robot: scans and tf in; map, map -> odom, words, loops and the topological graph
// out.
#pragma once

#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <hyselam_msgs/StatePath.h>
#include <nav_msgs/GetMap.h>
#include <nav_msgs/OccupancyGrid.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <std_srvs/Trigger.h>
#include <tf2_ros/transform_broadcaster.h>

#include <atomic>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "hyselam_common/ros/diagnostics.hpp"
#include "hyselam_common/ros/rate_limit.hpp"
#include "hyselam_common/ros/scan_input.hpp"
#include "ngram_slam/ros/slam_parameters.hpp"
#include "ngram_slam/slam/keyframe_mapper.hpp"
#include "ngram_slam/slam/region_graph.hpp"
#include "ngram_slam/slam/slam_engine.hpp"

namespace ngram_slam {

/// Topics: in `scan`, tf, `initialpose`; out `map`, `map_metadata`, `region_graph` (latched),
/// `words`, `word_matches`, `semantic_regions`, `path`, `slam_markers`, tf map -> odom,
/// /diagnostics. Services: `dynamic_map`, `~save`, `~load`, `~pause`, `~resume`.
///
/// Scans come on the queue of `nh`, which must serve one callback at a time. Loops are verified and
/// poses optimised on one thread, maps drawn and saved on another, services answered on a third:
/// none of them keeps a scan waiting for longer than it takes to copy what it needs.
class SlamServer {
 public:
  /// Reads and checks the parameters of `private_nh` and the state, before anything is subscribed.
  /// @throws hyselam::ParameterError, hyselam::InputError for a state that cannot be used.
  SlamServer(ros::NodeHandle nh, const ros::NodeHandle& private_nh);
  /// Saves the state.
  ~SlamServer();
  SlamServer(const SlamServer&) = delete;
  SlamServer& operator=(const SlamServer&) = delete;

 private:
  /// An engine with all that is told about it.
  struct Mapping {
    explicit Mapping(const SlamServerParams& params, SlamState state = {});
    /// Regions of observations that came since.
    std::vector<SemanticRegion> segment();

    SlamEngine engine;
    SemanticSegmenter segmenter;
    std::vector<SemanticRegion> regions;
    std::uint32_t segmented = 0;  // observations
    std::size_t told_words = 0, told_matches = 0;
    int requantisations = 0;
    std::uint64_t saved_scans = 0;
    bool localised = false;  // a scan has come: odomInMap() means something
  };

  bool onScan(const hyselam::LaserScan& scan, const hyselam::Pose2& base_in_odom,
              const ros::Time& stamp);
  void startRun(const hyselam::Pose2& base_in_odom);
  void onTimeBack();
  void onInitialPose(const geometry_msgs::PoseWithCovarianceStamped::ConstPtr& msg);
  void tell();
  void broadcast(const ros::Time& stamp);
  bool onSave(hyselam_msgs::StatePath::Request& request, hyselam_msgs::StatePath::Response& out);
  bool onLoad(hyselam_msgs::StatePath::Request& request, hyselam_msgs::StatePath::Response& out);
  bool onPause(bool pause, std_srvs::Trigger::Response& out);
  bool onMap(nav_msgs::GetMap::Response& out);
  bool drawsMaps() const { return params_.map_update_interval > 0.0; }
  void optimise();
  void draw();
  void publish(const hyselam::OccupancyGrid& grid, const std::vector<SlamKeyframe>& keyframes,
               const std::vector<SlamLoop>& loops, const RegionGraph& graph,
               const std_msgs::Header& in_map);
  std::string save(const std::string& path);
  void saveNow(const char* when);
  std::string pathOr(const std::string& given) const;
  void report(diagnostic_msgs::DiagnosticStatus& status);
  std_msgs::Header header(const std::string& frame) const;

  const std::string who_;
  const SlamServerParams params_;

  std::mutex mutex_;  // guards what follows, up to the next mutex
  std::condition_variable work_;
  std::unique_ptr<Mapping> mapping_;
  long epoch_ = 0;  // counts mappings: what was worked out for another one is void
  bool ending_ = false, map_due_ = false, paused_ = false;
  ros::Time stamp_;  // of the last scan
  enum class Next { kGoOn, kAfterPause, kAfterJump };
  Next next_ = Next::kGoOn;  // what the next scan is
  std::optional<hyselam::InitialPose> pending_;
  hyselam::Pose2 last_odometry_;
  std::string job_error_, map_error_, save_error_;
  double scan_ms_ = 0.0, worst_scan_ms_ = 0.0, job_ms_ = 0.0, map_ms_ = 0.0, save_ms_ = 0.0;
  std::size_t paused_scans_ = 0, weak_ = 0;

  std::mutex map_mutex_;
  std::optional<nav_msgs::OccupancyGrid> map_;
  std::mutex save_mutex_;  // one saving at a time

  ros::Time told_tf_;
  hyselam::RateLimit map_rate_;
  tf2_ros::TransformBroadcaster tf_;
  ros::Publisher map_publisher_, metadata_publisher_, word_publisher_, match_publisher_,
      region_publisher_, graph_publisher_, path_publisher_, marker_publisher_;
  ros::CallbackQueue service_queue_;
  ros::ServiceServer save_service_, load_service_, pause_service_, resume_service_, map_service_;
  std::unique_ptr<hyselam::ScanInput> input_;
  ros::Subscriber initial_pose_subscriber_;
  ros::WallTimer tf_timer_;
  std::unique_ptr<hyselam::Diagnostics> diagnostics_;
  std::unique_ptr<ros::AsyncSpinner> service_spinner_;
  std::thread optimiser_, drawer_;
};

}  // namespace ngram_slam
