// Maps, poses and human text in; names, places, answers and ways out.
#pragma once

#include <hyselam_msgs/AddGlassWall.h>
#include <hyselam_msgs/AddVirtualPlace.h>
#include <hyselam_msgs/AugmentedTopologicalMap.h>
#include <hyselam_msgs/NamePlace.h>
#include <hyselam_msgs/PlaceState.h>
#include <hyselam_msgs/StatePath.h>
#include <hyselam_msgs/TellRobot.h>
#include <hyselam_msgs/WhereAmI.h>
#include <hyselam_msgs/WordToPose.h>
#include <nav_msgs/OccupancyGrid.h>
#include <ros/ros.h>
#include <std_msgs/String.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>

#include <optional>
#include <string>
#include <vector>

#include "hyselam_common/ros/diagnostics.hpp"
#include "hyselam_topo/dialogue/dialogue.hpp"
#include "hyselam_topo/ros/goal_driver.hpp"
#include "hyselam_topo/ros/object_talk.hpp"
#include "hyselam_topo/ros/topo_engine_parameters.hpp"

namespace hyselam_topo {

/// Topics, services and parameters: see README.md. All callbacks run on the queue of `nh`, one at a
/// time.
class TopoEngineServer {
 public:
  /// Reads and checks the parameters of `private_nh`, before anything is subscribed.
  /// @throws hyselam::ParameterError.
  TopoEngineServer(ros::NodeHandle nh, const ros::NodeHandle& private_nh);
  ~TopoEngineServer();

 private:
  void onTopologicalMap(const hyselam_msgs::AugmentedTopologicalMap::ConstPtr& msg);
  void onMap(const nav_msgs::OccupancyGrid::ConstPtr& msg);
  void onText(const std_msgs::String::ConstPtr& msg);
  void onTimer();
  void lookForRobot();

  /// Any text of a person: answers what it is for, passes on what is for others.
  Reply hear(const std::string& text);
  void answered(const PassedOn& sentence, const hyselam_msgs::ObjectAnswer* answer);
  /// Says what is to be said and does what is to be done.
  void act(const Reply& reply);
  void say(const std::string& sentence);
  /// Takes down what a person has said, in the order with what the robot says.
  void heard(const std::string& text);
  void go(const std::vector<RouteLeg>& legs);
  void turn(double angle);
  void halt();
  void publishMap();
  void publishWalls();
  void publishPlace();
  void publishQuestion();

  void load(const std::string& path);
  void save(const std::string& path);
  void autosave();

  /// A point of a request in the frame of the map; the robot's where none is given. Throws
  /// hyselam::InputError.
  hyselam::Point2 pointOf(const geometry_msgs::PointStamped& point) const;
  const std::string& frame() const;

  bool onTell(hyselam_msgs::TellRobot::Request& request,
              hyselam_msgs::TellRobot::Response& response);
  bool onName(hyselam_msgs::NamePlace::Request& request,
              hyselam_msgs::NamePlace::Response& response);
  bool onWhere(hyselam_msgs::WhereAmI::Request& request,
               hyselam_msgs::WhereAmI::Response& response);
  bool onPose(hyselam_msgs::WordToPose::Request& request,
              hyselam_msgs::WordToPose::Response& response);
  bool onInitialPlace(hyselam_msgs::WordToPose::Request& request,
                      hyselam_msgs::WordToPose::Response& response);
  bool onVirtualPlace(hyselam_msgs::AddVirtualPlace::Request& request,
                      hyselam_msgs::AddVirtualPlace::Response& response);
  bool onGlassWall(hyselam_msgs::AddGlassWall::Request& request,
                   hyselam_msgs::AddGlassWall::Response& response);
  bool onSave(hyselam_msgs::StatePath::Request& request,
              hyselam_msgs::StatePath::Response& response);
  bool onLoad(hyselam_msgs::StatePath::Request& request,
              hyselam_msgs::StatePath::Response& response);
  void report(diagnostic_msgs::DiagnosticStatus& status);

  std::string who_;
  TopoEngineParams params_;
  Dialogue dialogue_;
  std::string grid_frame_ = "map";
  ros::Time grid_stamp_;
  bool changed_ = false;  // since the state was saved

  std::size_t maps_ = 0, texts_ = 0, refused_ = 0;
  // Of the last input of a topic that was refused; empty: the last one was used.
  std::string map_error_, grid_error_, text_error_;
  std::string file_error_;  // of the state file
  std::string pose_error_;
  ros::WallTime begun_ = ros::WallTime::now();
  ros::WallTime place_published_, saved_;
  hyselam_msgs::PlaceState last_place_;

  tf2_ros::Buffer tf_;
  tf2_ros::TransformListener tf_listener_;
  GoalDriver driver_;
  std::optional<ObjectTalk> objects_;
  bool of_things_ = false;      // objects were spoken of last
  bool objects_asked_ = false;  // and the last question was about them
  ros::Publisher text_publisher_, talk_publisher_, place_publisher_, map_publisher_,
      marker_publisher_, question_publisher_, grid_publisher_, path_publisher_, poses_publisher_,
      pose_publisher_, follow_publisher_, names_publisher_;
  std::vector<ros::Subscriber> subscribers_;
  std::vector<ros::ServiceServer> services_;
  ros::WallTimer timer_;
  std::optional<hyselam::Diagnostics> diagnostics_;
};

}  // namespace hyselam_topo
