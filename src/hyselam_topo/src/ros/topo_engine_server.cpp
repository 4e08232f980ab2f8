#include "hyselam_topo/ros/topo_engine_server.hpp"

#include <geometry_msgs/PoseArray.h>
#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <nav_msgs/Path.h>
#include <std_msgs/Bool.h>

#include <cstdio>
#include <filesystem>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/ros/conversions.hpp"
#include "hyselam_common/ros/server_setup.hpp"
#include "hyselam_common/ros/transport.hpp"
#include "hyselam_topo/dialogue/dialogue_state.hpp"
#include "hyselam_topo/ros/dialogue_markers.hpp"
#include "hyselam_topological_map/ros/conversions.hpp"

namespace hyselam_topo {
namespace {

constexpr double kPatience = 5.0;     // without a map until diagnostics warn [s]
constexpr double kPlacePeriod = 1.0;  // of the place that does not change [s]
constexpr double kSavePeriod = 2.0;   // at most so often [s]

}  // namespace

TopoEngineServer::TopoEngineServer(ros::NodeHandle nh, const ros::NodeHandle& private_nh)
    : who_(hyselam::logName(private_nh)),
      params_(hyselam::loadAndLogParams(private_nh, loadTopoEngineParams)),
      dialogue_(params_.dialogue),
      tf_listener_(tf_, true, hyselam::tcpNoDelay()),
      driver_(nh) {
  using Self = TopoEngineServer;
  text_publisher_ = nh.advertise<std_msgs::String>("robot_text", 20);
  talk_publisher_ = nh.advertise<std_msgs::String>("conversation", 100);
  place_publisher_ = nh.advertise<hyselam_msgs::PlaceState>("place", 1, true);
  map_publisher_ = nh.advertise<hyselam_msgs::AugmentedTopologicalMap>("named_map", 1, true);
  marker_publisher_ = nh.advertise<visualization_msgs::MarkerArray>("named_markers", 1, true);
  question_publisher_ = nh.advertise<visualization_msgs::MarkerArray>("question_markers", 1, true);
  grid_publisher_ = nh.advertise<nav_msgs::OccupancyGrid>("map_with_glass", 1, true);
  path_publisher_ = nh.advertise<nav_msgs::Path>("goal_path", 1, true);
  poses_publisher_ = nh.advertise<geometry_msgs::PoseArray>("goal_poses", 1, true);
  pose_publisher_ = nh.advertise<geometry_msgs::PoseWithCovarianceStamped>("initialpose", 1);
  follow_publisher_ = nh.advertise<std_msgs::Bool>("follow_person", 1, true);
  names_publisher_ = nh.advertise<std_msgs::String>("known_names", 1, true);
  // What cannot even be looked at is treated as a file that cannot be read.
  std::error_code unseen;
  const bool kept = !params_.state_file.empty() &&
                    (std::filesystem::exists(params_.state_file, unseen) || unseen);
  if (kept) {
    try {
      load(params_.state_file);
    } catch (const std::exception& e) {
      // Neither lost nor in the way: the robot begins afresh.
      file_error_ = e.what();
      const std::string aside = params_.state_file + ".damaged";
      std::error_code failed;
      std::filesystem::rename(params_.state_file, aside, failed);
      ROS_ERROR_STREAM(who_ << " begins without its state: " << e.what()
                            << (failed ? "" : "; the file is kept as " + aside));
      if (failed) params_.state_file.clear();
    }
  }
  // Before the services: a nodelet's queue is served while its constructor still runs.
  objects_.emplace(nh, params_.object_patience,
                   [this](const PassedOn& sentence, const hyselam_msgs::ObjectAnswer* answer) {
                     answered(sentence, answer);
                   });
  services_ = {nh.advertiseService("tell_robot", &Self::onTell, this),
               nh.advertiseService("name_place", &Self::onName, this),
               nh.advertiseService("where_am_i", &Self::onWhere, this),
               nh.advertiseService("word_to_pose", &Self::onPose, this),
               nh.advertiseService("set_initial_place", &Self::onInitialPlace, this),
               nh.advertiseService("add_virtual_place", &Self::onVirtualPlace, this),
               nh.advertiseService("add_glass_wall", &Self::onGlassWall, this),
               nh.advertiseService("save_dialogue", &Self::onSave, this),
               nh.advertiseService("load_dialogue", &Self::onLoad, this)};
  diagnostics_.emplace(nh, private_nh.getNamespace().substr(1) + ": dialogue",
                       params_.diagnostic_period,
                       [this](diagnostic_msgs::DiagnosticStatus& status) { report(status); });
  subscribers_ = {nh.subscribe("topological_map", 1, &Self::onTopologicalMap, this),
                  nh.subscribe("map", 1, &Self::onMap, this),
                  nh.subscribe("human_text", 20, &Self::onText, this)};
  timer_ = nh.createWallTimer(ros::WallDuration(1.0 / params_.rate),
                              [this](const ros::WallTimerEvent&) { onTimer(); });
}

TopoEngineServer::~TopoEngineServer() {
  // No callback may change the dialogue while it is written.
  timer_.stop();
  diagnostics_.reset();
  subscribers_.clear();
  services_.clear();
  objects_.reset();
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
    ++maps_;
    map_error_.clear();
    act(reply);
  } catch (const std::exception& e) {
    ++refused_;
    map_error_ = e.what();
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
    grid_error_.clear();
    publishWalls();
  } catch (const std::exception& e) {
    ++refused_;
    grid_error_ = e.what();
    ROS_ERROR_STREAM(who_ << " this map is not used: " << e.what());
  }
}

void TopoEngineServer::onText(const std_msgs::String::ConstPtr& msg) {
  if (msg->data.size() > static_cast<std::size_t>(params_.max_text_bytes)) {
    ++refused_;
    text_error_ = "human_text: it has " + std::to_string(msg->data.size()) +
                  " bytes, more than max_text_bytes, " + std::to_string(params_.max_text_bytes);
    ROS_ERROR_STREAM(who_ << " this text is not used: " << text_error_);
    return;
  }
  text_error_.clear();
  hear(msg->data);
}

Reply TopoEngineServer::hear(const std::string& text) {
  lookForRobot();
  heard(text);
  HearOptions options;
  options.pass_on = objects_->isThere();
  options.of_things = of_things_;
  options.others_asked = objects_asked_;
  Reply reply = dialogue_.hear(text, options);
  if (dialogue_.question().kind != Question::Kind::kNone && !reply.sentences.empty()) {
    objects_asked_ = false;
  }
  if (reply.passed_on.empty()) of_things_ = false;
  act(reply);
  for (const PassedOn& sentence : reply.passed_on) objects_->pass(sentence);
  return reply;
}

void TopoEngineServer::answered(const PassedOn& sentence,
                                const hyselam_msgs::ObjectAnswer* answer) {
  if (answer != nullptr && answer->understood) {
    of_things_ = true;
    objects_asked_ = answer->is_question != 0;
    say(answer->reply);
    if (answer->go_to_place == 0) return;
    std::vector<Id> goals;
    for (std::size_t i = 0; i < answer->places.size(); ++i) {
      const Id id = i < answer->place_ids.size() ? answer->place_ids[i] : 0;
      if (id != 0 && dialogue_.map().findPlace(id) != nullptr) {
        goals.push_back(id);
      } else {
        const std::vector<Id> named = dialogue_.places().find(answer->places[i]);
        goals.insert(goals.end(), named.begin(), named.end());
      }
    }
    const std::string name = answer->places.empty() ? "" : answer->places.front();
    if (goals.empty() && name.empty()) return;  // the reply has told why
    act(dialogue_.goTo(name, goals));
    return;
  }
  if (sentence.refusal.empty()) {
    act(dialogue_.hear(sentence.text));
  } else {
    say(answer != nullptr && sentence.of_a_thing ? answer->reply : sentence.refusal);
  }
  if (answer == nullptr) say(dialogue_.nobodyAnswers());
}

void TopoEngineServer::lookForRobot() {
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
    pose_error_.clear();
    act(dialogue_.setPose(stamp.toSec(), pose));
  } catch (const std::exception& e) {
    pose_error_ = e.what();
    act(dialogue_.poseLost(ros::Time::now().toSec()));
  }
}

void TopoEngineServer::onTimer() {
  lookForRobot();
  objects_->giveUp();
  const RobotPlace& robot = dialogue_.robot();
  const bool changed = robot.place != last_place_.place || robot.previous != last_place_.previous ||
                       robot.in_doorway != (last_place_.in_doorway != 0);
  const double quiet = (ros::WallTime::now() - place_published_).toSec();
  if (changed || quiet >= kPlacePeriod) publishPlace();
  autosave();
}

// ---- Output ----

void TopoEngineServer::say(const std::string& sentence) {
  std_msgs::String msg;
  msg.data = sentence;
  text_publisher_.publish(msg);
  msg.data = "robot: " + sentence;
  talk_publisher_.publish(msg);
  ROS_INFO_STREAM(who_ << " says: " << sentence);
}

void TopoEngineServer::heard(const std::string& text) {
  ++texts_;
  std_msgs::String msg;
  msg.data = "human: " + text;
  talk_publisher_.publish(msg);
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
        follow_publisher_.publish(msg);
        break;
      }
      case Kind::kTurn:
        turn(action.angle);
        break;
    }
  }
  if (map) publishMap();
  if (!reply.actions.empty() || !reply.sentences.empty()) {
    changed_ = true;
    publishQuestion();
  }
  for (const std::string& sentence : reply.sentences) say(sentence);
}

void TopoEngineServer::halt() {
  driver_.stop();
  std_msgs::Bool follow;
  follow_publisher_.publish(follow);
  nav_msgs::Path path;
  path.header.frame_id = frame();
  path_publisher_.publish(path);
  geometry_msgs::PoseArray poses;
  poses.header.frame_id = frame();
  poses_publisher_.publish(poses);
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
  follow_publisher_.publish(follow);
  path_publisher_.publish(path);
  poses_publisher_.publish(poses);
  if (params_.use_move_base) driver_.drive(std::move(goals), frame());
}

void TopoEngineServer::turn(double angle) {
  if (!dialogue_.robot().has_pose) return;
  RouteLeg leg;
  leg.waypoints = leg.path = {dialogue_.robot().pose * hyselam::Pose2{0.0, 0.0, angle}};
  go({leg});
}

void TopoEngineServer::publishMap() {
  if (!dialogue_.places().hasMap()) return;
  try {
    map_publisher_.publish(toMsg(dialogue_.map()));
    marker_publisher_.publish(namedMapMarkers(dialogue_.map(), params_.markers));
  } catch (const std::exception& e) {
    map_error_ = e.what();
    ROS_ERROR_STREAM(who_ << " the map is not published: " << e.what());
  }
  std_msgs::String names;
  for (const std::string& name : dialogue_.knownNames()) names.data += name + "\n";
  names_publisher_.publish(names);
}

void TopoEngineServer::publishWalls() {
  const auto grid = dialogue_.gridWithWalls();
  if (grid) grid_publisher_.publish(hyselam::toMsg(*grid, grid_frame_, grid_stamp_));
}

void TopoEngineServer::publishQuestion() {
  question_publisher_.publish(questionMarkers(dialogue_.question(), frame()));
}

void TopoEngineServer::publishPlace() {
  const RobotPlace& robot = dialogue_.robot();
  hyselam_msgs::PlaceState msg;
  msg.header.frame_id = frame();
  msg.header.stamp = robot.stamp > 0.0 ? ros::Time(robot.stamp) : ros::Time::now();
  msg.place = robot.place;
  msg.previous = robot.previous;
  msg.in_doorway = robot.in_doorway;
  if (robot.has_pose) {
    msg.pose.x = robot.pose.x;
    msg.pose.y = robot.pose.y;
    msg.pose.theta = robot.pose.theta;
  }
  if (const Place* place = dialogue_.map().findPlace(robot.place)) {
    const auto names = namesOf(*place);
    if (!names.empty()) msg.name = names.front();
    msg.confirmed = nameStateOf(*place) == NameState::kConfirmed;
    for (const Word& word : place->words) {
      msg.words.emplace_back();
      msg.words.back().text = word.text;
      msg.words.back().confirmed = word.confirmed;
    }
  }
  last_place_ = msg;
  place_published_ = ros::WallTime::now();
  place_publisher_.publish(msg);
}

// ---- Files ----

void TopoEngineServer::load(const std::string& path) {
  dialogue_.restore(loadDialogueState(path));
  changed_ = false;
  // What was shown before is gone, also if the state has no map and no question.
  if (!dialogue_.places().hasMap())
    marker_publisher_.publish(namedMapMarkers(dialogue_.map(), params_.markers));
  publishMap();
  publishWalls();
  publishQuestion();
  publishPlace();
  ROS_INFO_STREAM(who_ << " goes on with " << dialogue_.map().places.size() << " places of "
                       << path);
}

void TopoEngineServer::save(const std::string& path) {
  saveDialogueState(path, dialogue_.state());
}

void TopoEngineServer::autosave() {
  if (!changed_ || params_.state_file.empty()) return;
  if ((ros::WallTime::now() - saved_).toSec() < kSavePeriod) return;
  saved_ = ros::WallTime::now();
  try {
    save(params_.state_file);
    changed_ = false;
    file_error_.clear();
  } catch (const std::exception& e) {
    if (file_error_.empty()) ROS_ERROR_STREAM(who_ << " the state is not saved: " << e.what());
    file_error_ = e.what();
  }
}

// ---- Diagnostics ----

void TopoEngineServer::report(diagnostic_msgs::DiagnosticStatus& status) {
  using diagnostic_msgs::DiagnosticStatus;
  using hyselam::addRemark;
  using hyselam::addValue;
  for (const std::string* error : {&map_error_, &grid_error_, &text_error_, &file_error_}) {
    if (!error->empty()) addRemark(status, DiagnosticStatus::ERROR, *error);
  }
  const bool long_ago = (ros::WallTime::now() - begun_).toSec() > kPatience;
  std::size_t confirmed = 0, guessed = 0;
  for (const Place& place : dialogue_.map().places) {
    const NameState state = nameStateOf(place);
    confirmed += state == NameState::kConfirmed ? 1 : 0;
    guessed += state == NameState::kUnconfirmed ? 1 : 0;
  }
  if (!dialogue_.places().hasMap()) {
    addRemark(status, long_ago ? DiagnosticStatus::WARN : DiagnosticStatus::OK,
              "no topological map has come");
  } else if (!pose_error_.empty()) {
    addRemark(status, DiagnosticStatus::WARN, "no pose: " + pose_error_);
  } else {
    addRemark(status, DiagnosticStatus::OK,
              std::to_string(dialogue_.map().places.size()) + " places, " +
                  std::to_string(confirmed) + " named");
  }
  addValue(status, "maps", maps_);
  addValue(status, "texts", texts_);
  addValue(status, "refused", refused_);
  addValue(status, "places", dialogue_.map().places.size());
  addValue(status, "names confirmed", confirmed);
  addValue(status, "names guessed", guessed);
  addValue(status, "told walls", dialogue_.places().walls().size());
  addValue(status, "place", dialogue_.robot().place);
  addValue(status, "in doorway", dialogue_.robot().in_doorway);
  addValue(status, "waits for an answer", dialogue_.question().kind != Question::Kind::kNone);
  addValue(status, "driving", driver_.status());
  if (dialogue_.match() && dialogue_.match()->found()) {
    addValue(status, "fitness", dialogue_.match()->best().fitness);
    addValue(status, "equally good", dialogue_.match()->equal);
    addValue(status, "matching [us]", dialogue_.match()->microseconds);
  }
}

}  // namespace hyselam_topo
