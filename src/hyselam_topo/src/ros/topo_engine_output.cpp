// What TopoEngine says, publishes and drives.
#include <geometry_msgs/PoseArray.h>
#include <nav_msgs/Path.h>
#include <std_msgs/Bool.h>

#include "hyselam_common/ros/conversions.hpp"
#include "hyselam_topo/ros/dialogue_markers.hpp"
#include "hyselam_topo/ros/topo_engine_server.hpp"
#include "hyselam_topological_map/map_geometry.hpp"
#include "hyselam_topological_map/ros/conversions.hpp"

namespace hyselam_topo {

void TopoEngineServer::say(const std::string& sentence) {
  publishers_.text.publish(hyselam::toStringMsg(sentence));
  publishers_.conversation.publish(hyselam::toStringMsg("robot: " + sentence));
  ROS_INFO_STREAM(who_ << " says: " << sentence);
}

void TopoEngineServer::publishHumanText(const std::string& text) {
  ++input_.texts;
  publishers_.conversation.publish(hyselam::toStringMsg("human: " + text));
}

void TopoEngineServer::act(const Reply& reply) {
  bool map = false;
  using Kind = DialogueAction::Kind;
  for (const DialogueAction& action : reply.actions) {
    switch (action.kind) {
      case Kind::kMap:
        map = true;
        break;
      case Kind::kWalls:
        publishWalls();
        break;
      case Kind::kGo:
        go(action.legs);
        break;
      case Kind::kStop:
        halt();
        break;
      case Kind::kFollow: {
        halt();
        std_msgs::Bool msg;
        msg.data = 1;
        publishers_.follow.publish(msg);
        break;
      }
      case Kind::kTurn:
        turn(action.angle);
        break;
      case Kind::kPose:
        if (action.pose) publishers_.initial_pose.publish(poseMsg(*action.pose));
        break;
    }
  }
  if (map) publishMap();
  if (!reply.actions.empty() || !reply.sentences.empty()) {
    changed_ = true;
    publishQuestion();
  }
  publishOpen();
  // An answer promises that what was told is kept.
  if (!reply.sentences.empty()) saveChanges();
  for (const std::string& sentence : reply.sentences) say(sentence);
}

void TopoEngineServer::halt() {
  driver_.stop();
  std_msgs::Bool follow;
  publishers_.follow.publish(follow);
  nav_msgs::Path path;
  path.header.frame_id = frame();
  publishers_.path.publish(path);
  geometry_msgs::PoseArray poses;
  poses.header.frame_id = frame();
  publishers_.poses.publish(poses);
}

void TopoEngineServer::go(const std::vector<RouteLeg>& legs) {
  nav_msgs::Path path;
  geometry_msgs::PoseArray poses;
  path.header.frame_id = poses.header.frame_id = frame();
  path.header.stamp = poses.header.stamp = ros::Time::now();
  std::vector<hyselam::Pose2> goals;
  for (const RouteLeg& leg : legs) {
    for (const hyselam::Pose2& pose : leg.path) {
      geometry_msgs::PoseStamped stamped;
      stamped.header = path.header;
      stamped.pose = hyselam::toPoseMsg(pose);
      path.poses.push_back(stamped);
    }
    for (const hyselam::Pose2& pose : leg.waypoints) {
      poses.poses.push_back(hyselam::toPoseMsg(pose));
      goals.push_back(pose);
    }
  }
  std_msgs::Bool follow;
  publishers_.follow.publish(follow);
  publishers_.path.publish(path);
  publishers_.poses.publish(poses);
  if (params_.use_move_base) driver_.drive(std::move(goals), frame());
}

void TopoEngineServer::turn(double angle) {
  if (!dialogue_.robot().has_pose) return;
  RouteLeg leg;
  leg.waypoints = leg.path = {dialogue_.robot().pose * hyselam::Pose2{0.0, 0.0, angle}};
  go({leg});
}

geometry_msgs::PoseWithCovarianceStamped TopoEngineServer::poseMsg(const PlacePose& at) const {
  geometry_msgs::PoseWithCovarianceStamped msg;
  msg.header.frame_id = frame();
  msg.header.stamp = ros::Time::now();
  msg.pose.pose = hyselam::toPoseMsg(at.pose);
  // Rows and columns x, y, yaw of (x, y, z, roll, pitch, yaw).
  constexpr std::size_t kRows[] = {0, 1, 5};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      msg.pose.covariance[6 * kRows[i] + kRows[j]] = at.covariance[3 * i + j];
    }
  }
  return msg;
}

void TopoEngineServer::publishMap() {
  if (!dialogue_.places().hasMap()) return;
  try {
    publishers_.map.publish(toMsg(dialogue_.map()));
    publishers_.markers.publish(namedMapMarkers(dialogue_.map(), params_.markers));
  } catch (const std::exception& e) {
    input_.map_error = e.what();
    ROS_ERROR_STREAM(who_ << " the map is not published: " << e.what());
  }
  std_msgs::String names;
  for (const std::string& name : dialogue_.knownNames()) names.data += name + "\n";
  publishers_.names.publish(names);
  std_msgs::String candidates;
  for (const auto& [name, places] : dialogue_.whereMayBe()) {
    candidates.data += name;
    for (const Id id : places) {
      const Place* place = dialogue_.map().findPlace(id);
      if (place != nullptr) candidates.data += "\t" + codeOf(*place);
    }
    candidates.data += "\n";
  }
  publishers_.candidates.publish(candidates);
}

void TopoEngineServer::publishWalls() {
  const auto grid = dialogue_.gridWithWalls();
  if (grid) publishers_.grid.publish(hyselam::toMsg(*grid, grid_frame_, grid_stamp_));
  hyselam_msgs::WallArray told;
  told.header.frame_id = frame();
  told.header.stamp = ros::Time::now();
  for (const DescribedWall& described : dialogue_.places().walls()) {
    Wall wall = straightWall(described.line.a, described.line.b);
    wall.kind = described.kind;
    wall.id = static_cast<Id>(told.walls.size() + 1);
    told.walls.push_back(toMsg(wall));
  }
  publishers_.told_walls.publish(told);
}

void TopoEngineServer::publishQuestion() {
  publishers_.question.publish(questionMarkers(dialogue_.question(), frame()));
}

void TopoEngineServer::publishOpen() {
  const bool asks = dialogue_.question().kind != Question::Kind::kNone;
  const auto publish = [](const std::string& text, Told& told) {
    if (told.text && *told.text == text) return;
    told.text = text;
    told.publisher.publish(hyselam::toStringMsg(text));
  };
  publish(asks ? dialogue_.openQuestion() : "", publishers_.open_question);
  publish(dialogue_.nextUndo(), publishers_.next_undo);
  publish(dialogue_.haltedGoal(), publishers_.halted_goal);
}

void TopoEngineServer::publishPlace() {
  const RobotPlace& robot = dialogue_.robot();
  hyselam_msgs::PlaceState msg;
  msg.header.frame_id = frame();
  msg.header.stamp = robot.stamp > 0.0 ? ros::Time(robot.stamp) : ros::Time::now();
  msg.place = robot.place;
  msg.previous = robot.previous;
  msg.in_doorway = robot.in_doorway;
  if (robot.has_pose) msg.pose = hyselam::toPose2dMsg(robot.pose);
  if (const Place* place = dialogue_.map().findPlace(robot.place)) {
    const auto names = namesOf(*place);
    if (!names.empty()) msg.name = names.front();
    msg.confirmed = nameStateOf(*place) == NameState::kConfirmed;
    for (const PlaceTerm& word : place->words) {
      msg.words.emplace_back();
      msg.words.back().text = word.text;
      msg.words.back().confirmed = word.confirmed;
    }
  }
  last_place_ = msg;
  place_published_ = ros::WallTime::now();
  publishers_.place.publish(msg);
}

}  // namespace hyselam_topo
