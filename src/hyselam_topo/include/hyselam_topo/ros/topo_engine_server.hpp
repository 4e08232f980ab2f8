// ROS interface of the dialogue: maps, poses and human text in; names, places, answers and paths
// out.
#pragma once

#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <hyselam_msgs/AddGlassWall.h>
#include <hyselam_msgs/AddVirtualPlace.h>
#include <hyselam_msgs/AugmentedTopologicalMap.h>
#include <hyselam_msgs/NamePlace.h>
#include <hyselam_msgs/PlaceState.h>
#include <hyselam_msgs/StatePath.h>
#include <hyselam_msgs/TellRobot.h>
#include <hyselam_msgs/UseLanguage.h>
#include <hyselam_msgs/WallArray.h>
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
#include "hyselam_topo/dialogue/shared_dialogue.hpp"
#include "hyselam_topo/ros/goal_driver.hpp"
#include "hyselam_topo/ros/sentence_forwarder.hpp"
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
  void updatePose();

  /// Any text of a person: answers it, or forwards sentences that are for other nodes.
  Reply hear(const std::string& text);
  /// Carries a reply out, and passes on what is for other nodes.
  void finishHearing(const Reply& reply);
  void onObjectAnswer(const ForwardedSentence& sentence, const hyselam_msgs::ObjectAnswer* answer);
  void takeObjectAnswer(const ForwardedSentence& sentence,
                        const hyselam_msgs::ObjectAnswer* answer);
  /// Nothing that a text leads to may end the node.
  void refuseText(const std::string& topic, const std::exception& e);
  /// Publishes the sentences of a reply and carries its actions out.
  void act(const Reply& reply);
  void say(const std::string& sentence);
  /// Publishes a person's text on `conversation`, in order with the robot's sentences.
  void publishHumanText(const std::string& text);
  void go(const std::vector<RouteLeg>& legs);
  void turn(double angle);
  /// In the frame of the map, now.
  geometry_msgs::PoseWithCovarianceStamped poseMsg(const PlacePose& at) const;
  void halt();
  void publishMap();
  void publishWalls();
  void publishPlace();
  void publishQuestion();
  /// Where it has changed.
  void publishOpen();

  void advertise(ros::NodeHandle& nh);
  void offerServices(ros::NodeHandle& nh);

  /// Loads the state file if there is one; a damaged one is renamed.
  void restoreState();
  void load(const std::string& path);
  void save(const std::string& path);
  /// At most every two seconds.
  void autosave();
  /// Writes the state if it has changed; an error is told, and tried again.
  void saveChanges();

  /// A point of a request in the frame of the map; the robot's where none is given. Throws
  /// hyselam::InputError.
  hyselam::Point2 pointOf(const geometry_msgs::PointStamped& point) const;
  const std::string& frame() const;

  bool onTell(hyselam_msgs::TellRobot::Request& request,
              hyselam_msgs::TellRobot::Response& response);
  bool onUnderstands(hyselam_msgs::TellRobot::Request& request,
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
  bool onNoWall(hyselam_msgs::AddGlassWall::Request& request,
                hyselam_msgs::AddGlassWall::Response& response);
  bool changeWalls(bool removes, const hyselam_msgs::AddGlassWall::Request& request,
                   hyselam_msgs::AddGlassWall::Response& response);
  bool onLanguage(hyselam_msgs::UseLanguage::Request& request,
                  hyselam_msgs::UseLanguage::Response& response);
  bool onSave(hyselam_msgs::StatePath::Request& request,
              hyselam_msgs::StatePath::Response& response);
  bool onLoad(hyselam_msgs::StatePath::Request& request,
              hyselam_msgs::StatePath::Response& response);
  void report(diagnostic_msgs::DiagnosticStatus& status);

  std::string who_;
  TopoEngineParams params_;
  Dialogue dialogue_;
  SharedDialogue shared_{dialogue_};  // with the node that handles objects
  std::string grid_frame_ = "map";
  ros::Time grid_stamp_;
  bool changed_ = false;  // since the state was saved

  struct InputStatus {
    std::size_t maps = 0, texts = 0, refused = 0;
    // Of the last input of a topic that was refused; empty: the last one was used.
    std::string map_error, grid_error, text_error;
    std::string file_error;  ///< of the state file
    std::string put_aside;   ///< why a damaged state was put aside, until people save or load one
    std::string pose_error;
  } input_;
  ros::WallTime started_ = ros::WallTime::now();
  ros::WallTime place_published_, saved_;
  hyselam_msgs::PlaceState last_place_;

  tf2_ros::Buffer tf_;
  tf2_ros::TransformListener tf_listener_;
  GoalDriver driver_;
  std::optional<SentenceForwarder> forwarder_;
  /// Published when it changes.
  struct Told {
    ros::Publisher publisher;
    std::optional<std::string> text;
  };
  struct Publishers {
    ros::Publisher text, conversation, place, map, markers, question, grid, told_walls, path, poses,
        initial_pose, follow, names, candidates;
    Told open_question, next_undo, halted_goal;
  } publishers_;
  std::vector<ros::Subscriber> subscribers_;
  std::vector<ros::ServiceServer> services_;
  ros::WallTimer timer_;
  std::optional<hyselam::Diagnostics> diagnostics_;
};

}  // namespace hyselam_topo
