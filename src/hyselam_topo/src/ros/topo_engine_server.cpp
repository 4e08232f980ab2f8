#include "hyselam_topo/ros/topo_engine_server.hpp"

#include <geometry_msgs/PoseArray.h>
#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <nav_msgs/Path.h>
#include <std_msgs/Bool.h>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/ros/conversions.hpp"
#include "hyselam_common/ros/server_setup.hpp"
#include "hyselam_common/ros/transport.hpp"
#include "hyselam_topo/ros/dialogue_markers.hpp"
#include "hyselam_topological_map/ros/conversions.hpp"

namespace hyselam_topo {
namespace {

constexpr double kPlacePeriod = 1.0;  // of the place that does not change [s]

}  // namespace

TopoEngineServer::TopoEngineServer(ros::NodeHandle nh, const ros::NodeHandle& private_nh)
    : who_(hyselam::logName(private_nh)),
      params_(hyselam::loadAndLogParams(private_nh, loadTopoEngineParams)),
      dialogue_(params_.dialogue),
      tf_listener_(tf_, true, hyselam::tcpNoDelay()),
      driver_(nh) {
  using Self = TopoEngineServer;
  advertise(nh);
  restoreState();
  // Before the services: a nodelet's queue is served while its constructor still runs.
  forwarder_.emplace(
      nh, params_.object_answer_timeout,
      [this](const ForwardedSentence& sentence, const hyselam_msgs::ObjectAnswer* answer) {
        onObjectAnswer(sentence, answer);
      });
  offerServices(nh);
  diagnostics_.emplace(nh, private_nh.getNamespace().substr(1) + ": dialogue",
                       params_.diagnostic_period,
                       [this](diagnostic_msgs::DiagnosticStatus& status) { report(status); });
  subscribers_ = {nh.subscribe("topological_map", 1, &Self::onTopologicalMap, this),
                  nh.subscribe("map", 1, &Self::onMap, this),
                  nh.subscribe("human_text", 20, &Self::onText, this)};
  timer_ = nh.createWallTimer(ros::WallDuration(1.0 / params_.pose_rate),
                              [this](const ros::WallTimerEvent&) { onTimer(); });
}

void TopoEngineServer::advertise(ros::NodeHandle& nh) {
  publishers_.text = nh.advertise<std_msgs::String>("robot_text", 20);
  publishers_.conversation = nh.advertise<std_msgs::String>("conversation", 100);
  publishers_.place = nh.advertise<hyselam_msgs::PlaceState>("place", 1, true);
  publishers_.map = nh.advertise<hyselam_msgs::AugmentedTopologicalMap>("named_map", 1, true);
  publishers_.markers = nh.advertise<visualization_msgs::MarkerArray>("named_markers", 1, true);
  publishers_.question = nh.advertise<visualization_msgs::MarkerArray>("question_markers", 1, true);
  publishers_.grid = nh.advertise<nav_msgs::OccupancyGrid>("map_with_glass", 1, true);
  publishers_.told_walls = nh.advertise<hyselam_msgs::WallArray>("told_walls", 1, true);
  publishers_.path = nh.advertise<nav_msgs::Path>("goal_path", 1, true);
  publishers_.poses = nh.advertise<geometry_msgs::PoseArray>("goal_poses", 1, true);
  publishers_.initial_pose =
      nh.advertise<geometry_msgs::PoseWithCovarianceStamped>("initialpose", 1);
  publishers_.follow = nh.advertise<std_msgs::Bool>("follow_person", 1, true);
  publishers_.names = nh.advertise<std_msgs::String>("known_names", 1, true);
  publishers_.candidates = nh.advertise<std_msgs::String>("name_candidates", 1, true);
  publishers_.open_question.publisher = nh.advertise<std_msgs::String>("open_question", 1, true);
  publishers_.next_undo.publisher = nh.advertise<std_msgs::String>("next_undo", 1, true);
  publishers_.halted_goal.publisher = nh.advertise<std_msgs::String>("halted_goal", 1, true);
}

void TopoEngineServer::offerServices(ros::NodeHandle& nh) {
  using Self = TopoEngineServer;
  services_ = {nh.advertiseService("tell_robot", &Self::onTell, this),
               nh.advertiseService("understands", &Self::onUnderstands, this),
               nh.advertiseService("name_place", &Self::onName, this),
               nh.advertiseService("where_am_i", &Self::onWhere, this),
               nh.advertiseService("word_to_pose", &Self::onPose, this),
               nh.advertiseService("set_initial_place", &Self::onInitialPlace, this),
               nh.advertiseService("add_virtual_place", &Self::onVirtualPlace, this),
               nh.advertiseService("add_glass_wall", &Self::onGlassWall, this),
               nh.advertiseService("remove_wall", &Self::onNoWall, this),
               nh.advertiseService("use_language", &Self::onLanguage, this),
               nh.advertiseService("save_dialogue", &Self::onSave, this),
               nh.advertiseService("load_dialogue", &Self::onLoad, this)};
}

TopoEngineServer::~TopoEngineServer() {
  // No callback may change the dialogue while it is written.
  timer_.stop();
  diagnostics_.reset();
  subscribers_.clear();
  services_.clear();
  forwarder_.reset();
  saved_ = ros::WallTime();
  autosave();
}

const std::string& TopoEngineServer::frame() const {
  return dialogue_.places().hasMap() ? dialogue_.map().frame_id : grid_frame_;
}

// ---- Input ----

void TopoEngineServer::onTopologicalMap(
    const hyselam_msgs::AugmentedTopologicalMap::ConstPtr& msg) {
  try {
    const Reply reply = dialogue_.setMap(fromMsg(*msg, "topological_map"));
    ++input_.maps;
    input_.map_error.clear();
    act(reply);
  } catch (const std::exception& e) {
    ++input_.refused;
    input_.map_error = e.what();
    ROS_ERROR_STREAM(who_ << " this map is not used: " << e.what());
  }
}

void TopoEngineServer::onMap(const nav_msgs::OccupancyGrid::ConstPtr& msg) {
  try {
    const std::uint64_t cells = std::uint64_t{msg->info.width} * msg->info.height;
    if (cells > static_cast<std::uint64_t>(params_.max_map_cells)) {
      throw hyselam::InputError("map", "",
                                "it has " + std::to_string(cells) +
                                    " cells, more than max_map_cells, " +
                                    std::to_string(params_.max_map_cells));
    }
    dialogue_.setGrid(hyselam::fromMsg(*msg, "map"));
    grid_frame_ = frameOf(msg->header.frame_id);
    grid_stamp_ = msg->header.stamp;
    input_.grid_error.clear();
    publishWalls();
  } catch (const std::exception& e) {
    ++input_.refused;
    input_.grid_error = e.what();
    ROS_ERROR_STREAM(who_ << " this map is not used: " << e.what());
  }
}

void TopoEngineServer::onText(const std_msgs::String::ConstPtr& msg) {
  if (msg->data.size() > static_cast<std::size_t>(params_.max_text_bytes)) {
    ++input_.refused;
    input_.text_error = "human_text: it has " + std::to_string(msg->data.size()) +
                        " bytes, more than max_text_bytes, " +
                        std::to_string(params_.max_text_bytes);
    ROS_ERROR_STREAM(who_ << " this text is not used: " << input_.text_error);
    if (const auto obeyed = dialogue_.obeyUrgent(msg->data)) finishHearing(*obeyed);
    return;
  }
  input_.text_error.clear();
  try {
    hear(msg->data);
  } catch (const std::exception& e) {
    refuseText("human_text", e);
  }
}

void TopoEngineServer::refuseText(const std::string& topic, const std::exception& e) {
  ++input_.refused;
  input_.text_error = topic + ": " + e.what();
  ROS_ERROR_STREAM(who_ << " this text is not used: " << input_.text_error);
}

Reply TopoEngineServer::hear(const std::string& text) {
  updatePose();
  publishHumanText(text);
  const Reply reply = shared_.hear(text, forwarder_->hasListeners());
  finishHearing(reply);
  return reply;
}

void TopoEngineServer::finishHearing(const Reply& reply) {
  // What was asked for before must not begin after a stop.
  if (reply.stopped) forwarder_->dropAll();
  if (reply.ends_other_question) forwarder_->endQuestion();
  act(reply);
  // "This is the kitchen. There is a cup": where the robot is may have been told in this very text.
  if (!reply.forwarded.empty()) publishPlace();
  for (const ForwardedSentence& sentence : reply.forwarded) forwarder_->forward(sentence);
}

void TopoEngineServer::onObjectAnswer(const ForwardedSentence& sentence,
                                      const hyselam_msgs::ObjectAnswer* answer) {
  try {
    takeObjectAnswer(sentence, answer);
  } catch (const std::exception& e) {
    refuseText("object_answer", e);
  }
}

void TopoEngineServer::takeObjectAnswer(const ForwardedSentence& sentence,
                                        const hyselam_msgs::ObjectAnswer* answer) {
  if (answer == nullptr) {
    act(shared_.answered(sentence, nullptr));
    return;
  }
  OtherAnswer other;
  other.understood = answer->understood != 0;
  other.about_things = answer->about_things != 0;
  other.reply = answer->reply;
  other.reason = answer->reason;
  other.is_question = answer->is_question != 0;
  other.go_to_place = answer->go_to_place != 0;
  for (std::size_t i = 0; i < answer->places.size(); ++i) {
    other.places.push_back(
        {answer->places[i], i < answer->place_ids.size() ? answer->place_ids[i] : 0});
  }
  act(shared_.answered(sentence, &other));
}

void TopoEngineServer::updatePose() {
  try {
    const auto transform = tf_.lookupTransform(frame(), params_.base_frame, ros::Time(0));
    const double age = (ros::Time::now() - transform.header.stamp).toSec();
    // Transforms that never change have no time.
    if (!transform.header.stamp.isZero() && age > params_.pose_timeout) {
      throw std::runtime_error("the pose is " + std::to_string(age) + " s old");
    }
    const hyselam::Pose2 pose =
        hyselam::fromMsg(transform.transform, "tf " + frame() + " -> " + params_.base_frame);
    const ros::Time stamp =
        transform.header.stamp.isZero() ? ros::Time::now() : transform.header.stamp;
    input_.pose_error.clear();
    act(dialogue_.setPose(stamp.toSec(), pose));
  } catch (const std::exception& e) {
    input_.pose_error = e.what();
    act(dialogue_.losePose(ros::Time::now().toSec()));
  }
}

void TopoEngineServer::onTimer() {
  updatePose();
  forwarder_->dropOverdue();
  const RobotPlace& robot = dialogue_.robot();
  const bool changed = robot.place != last_place_.place || robot.previous != last_place_.previous ||
                       robot.in_doorway != (last_place_.in_doorway != 0);
  const double quiet = (ros::WallTime::now() - place_published_).toSec();
  if (changed || quiet >= kPlacePeriod) publishPlace();
  autosave();
}

}  // namespace hyselam_topo
