// One map of several robots under one master.
#pragma once

#include <geometry_msgs/TransformStamped.h>
#include <hyselam_msgs/SlamGraph.h>
#include <hyselam_msgs/StatePath.h>
#include <nav_msgs/GetMap.h>
#include <nav_msgs/OccupancyGrid.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <tf2_ros/transform_broadcaster.h>

#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "hyselam_common/ros/diagnostics.hpp"
#include "ngram_slam/ros/shared_map_messages.hpp"
#include "ngram_slam/ros/shared_map_parameters.hpp"
#include "ngram_slam/slam/shared_map.hpp"

namespace ngram_slam {

/// Asks the SLAM of each robot (service ROBOT/slam_graph of NgramSlam) for what is new. Out: `map`,
/// `map_metadata`, `map_certainty`, `shared_map_markers`, `shared_map_status` (latched), tf from
/// `global_frame_id` to the map frames of the robots in it, /diagnostics. Services: `dynamic_map`,
/// `~save`.
///
/// A thread asks each robot: one that does not answer keeps nobody waiting. One thread merges, one
/// draws.
class SharedMapServer {
 public:
  /// @throws hyselam::ParameterError
  SharedMapServer(ros::NodeHandle nh, const ros::NodeHandle& private_nh);
  ~SharedMapServer();
  SharedMapServer(const SharedMapServer&) = delete;
  SharedMapServer& operator=(const SharedMapServer&) = delete;

 private:
  struct Publishers {
    ros::Publisher map, metadata, certainty, markers, status;
  };
  struct Services {
    ros::CallbackQueue queue;
    ros::ServiceServer save, map;
    std::unique_ptr<ros::AsyncSpinner> spinner;
  };
  /// For the diagnostics.
  struct Times {
    std::string merge_error, map_error;
    double merge_s = 0.0, map_ms = 0.0;
  };

  void advertise(ros::NodeHandle nh, const ros::NodeHandle& private_nh);
  void poll(std::size_t robot);
  bool ask(std::size_t robot, ros::ServiceClient* client);
  void take(std::size_t robot, const hyselam_msgs::SlamGraph::Response& answer);
  bool waitFor(double seconds);
  void runMerging();
  void runDrawing();
  void draw();
  void broadcast();
  bool onSave(hyselam_msgs::StatePath::Request& request, hyselam_msgs::StatePath::Response& out);
  bool onMap(nav_msgs::GetMap::Response& out);
  void report(diagnostic_msgs::DiagnosticStatus& status);
  std_msgs::Header header() const;

  const std::string log_name_;
  const SharedMapServerParams params_;
  const std::vector<std::string> names_;

  std::mutex mutex_;  // guards what follows, up to the publishers
  std::condition_variable end_;
  bool ending_ = false;
  SharedMap shared_;
  std::vector<RobotAnswers> answers_;
  std::vector<std::optional<ros::WallTime>> asked_since_;  // what is not answered yet, by robot
  bool drawn_ = true;                                      // nothing is new since
  std::optional<nav_msgs::OccupancyGrid> newest_map_;
  std::string told_;  // status
  Times times_;

  Publishers publish_;
  Services services_;
  tf2_ros::TransformBroadcaster tf_;
  ros::NodeHandle nh_;
  ros::WallTimer tf_timer_;
  std::vector<geometry_msgs::TransformStamped> sent_;  // last, by its callback
  ros::Time sent_at_, sent_stamp_;
  std::unique_ptr<hyselam::Diagnostics> diagnostics_;
  std::vector<std::thread> threads_;
};

}  // namespace ngram_slam
