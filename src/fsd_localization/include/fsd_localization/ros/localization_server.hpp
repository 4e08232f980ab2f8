// Localisation on a map, on amcl's interface.
#pragma once

#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <nav_msgs/OccupancyGrid.h>
#include <nav_msgs/SetMap.h>
#include <ros/ros.h>
#include <std_srvs/Empty.h>

#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "fsd_localization/ros/localization_publisher.hpp"
#include "fsd_localization/ros/map_preparation.hpp"
#include "hyselam_common/ros/diagnostics.hpp"
#include "hyselam_common/ros/initial_pose.hpp"
#include "hyselam_common/ros/result_wait.hpp"
#include "hyselam_common/ros/scan_input.hpp"

namespace fsd_localization {

/// Topics, services, parameters and tf: see README.md. All callbacks run on the queue of `nh`, one
/// at a time; a new map is prepared in a thread of its own and taken over between two callbacks.
class LocalizationServer {
 public:
  /// Reads and checks the parameters of `private_nh`, before anything is subscribed.
  /// @throws hyselam::ParameterError.
  LocalizationServer(ros::NodeHandle nh, const ros::NodeHandle& private_nh);

  const LocalizationServerParams& params() const { return params_; }
  /// What concerns the localiser itself makes a new one of the same map, in the background; it goes
  /// on from the last trusted pose. Frames and the source of the map stay what they were.
  /// @param params that have been validated.
  void setParams(const LocalizationServerParams& params);

 private:
  // Maps.
  void onMap(const nav_msgs::OccupancyGrid::ConstPtr& msg);
  bool prepare(const nav_msgs::OccupancyGrid& msg, const std::string& source);
  void requestMap(double pause);
  void startPreparation(MapPreparation::Source source);
  /// @param base_in_odom at the scan that is being handled; none: the newest that tf knows.
  void takeOverMap(const std::optional<hyselam::Pose2>& base_in_odom);
  void refuseMap(const std::string& why);

  // Scans.
  bool isHeldUp(const ros::Time& stamp);
  bool onScan(const hyselam::LaserScan& scan, const hyselam::Pose2& base_in_odom,
              const ros::Time& stamp);
  void noteResult(const LocalizationResult& result, const hyselam::Pose2& base_in_odom);
  void onTimeJump();
  void savePose(const LocalizationResult& result);

  // Poses and commands from outside.
  void onInitialPose(const geometry_msgs::PoseWithCovarianceStamped::ConstPtr& msg);
  bool startAt(const hyselam::InitialPose& pose);
  void forgetPose(const std::string& why);
  bool onSetMap(nav_msgs::SetMap::Request& request, nav_msgs::SetMap::Response& response);

  void report(diagnostic_msgs::DiagnosticStatus& status);

  ros::NodeHandle private_nh_;
  std::string log_name_;
  std::string map_topic_;  // a latched map may come while map_subscriber_ is still being set
  LocalizationServerParams params_;
  LocalizationPublisher publisher_;
  std::atomic<bool> map_seen_{false};   // a map that looks usable has come
  MapPreparation::Source map_service_;  // static_map
  MapPreparation::Source last_source_;  // of the map in use or on its way, for other parameters
  MapPreparation preparation_;          // its thread sets map_seen_: ends before that does
  std::unique_ptr<Localizer> localizer_;
  std::uint64_t fingerprint_ = 0;  // of the newest map that came by topic or set_map
  std::string map_error_;          // of the newest map; empty: it is good
  /// A pose for the map that is being prepared. The robot goes on while it waits.
  struct WaitingPose {
    hyselam::InitialPose pose;
    std::optional<hyselam::Pose2> base_in_odom;  // at that pose; none: tf did not know
  };
  std::optional<WaitingPose> waiting_pose_;
  std::optional<LocalizationResult> last_result_;
  std::optional<hyselam::Pose2> odom_in_map_;  // as published on tf
  bool guided_ = false;  // an initial pose was given, and nothing has converged since
  bool force_update_ = false;
  struct Updates {
    double last_ms = 0.0;
    std::size_t count = 0;
  } updates_;
  ros::WallTime saved_;
  hyselam::ResultWait search_wait_{params_.search_wait};

  hyselam::ScanInput input_;
  ros::WallTime reminded_of_map_ = ros::WallTime::now();
  hyselam::Diagnostics diagnostics_;
  ros::WallTimer map_timer_;
  ros::Subscriber map_subscriber_, initial_pose_subscriber_;
  std::vector<ros::ServiceServer> services_;
};

}  // namespace fsd_localization
