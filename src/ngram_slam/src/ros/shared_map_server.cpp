#include "ngram_slam/ros/shared_map_server.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/ros/conversions.hpp"
#include "hyselam_common/ros/server_setup.hpp"
#include "ngram_slam/ros/slam_graph_messages.hpp"
#include "ngram_slam/slam/present_map.hpp"
#include "ngram_slam/slam/slam_state_io.hpp"
#include "wall_milliseconds.hpp"

namespace ngram_slam {

using hyselam::addRemark;
using hyselam::addValue;
using Lock = std::unique_lock<std::mutex>;
using DiagnosticStatus = diagnostic_msgs::DiagnosticStatus;

namespace {

constexpr std::uint32_t kKeyframesAtOnce = 200;  // some hundred kB
const char* const kNoAnswer = "its SLAM does not answer";

/// Ends a merging of which nobody waits for the result.
struct Ending {};

bool isSame(const geometry_msgs::Transform& a, const geometry_msgs::Transform& b) {
  return a.translation.x == b.translation.x && a.translation.y == b.translation.y &&
         a.rotation.z == b.rotation.z && a.rotation.w == b.rotation.w;
}

}  // namespace

SharedMapServer::SharedMapServer(ros::NodeHandle nh, const ros::NodeHandle& private_nh)
    : log_name_(hyselam::logName(private_nh)),
      params_(hyselam::loadAndLogParams(private_nh, loadSharedMapParams)),
      names_(params_.names()),
      shared_(names_, params_.shared),
      nh_(nh) {
  for (const std::string& name : names_) answers_.push_back({name, "", kNoAnswer});
  asked_since_.resize(names_.size());
  advertise(nh, private_nh);
  for (std::size_t robot = 0; robot < names_.size(); ++robot) {
    threads_.emplace_back([this, robot] { poll(robot); });
  }
  threads_.emplace_back([this] { runMerging(); });
  threads_.emplace_back([this] { runDrawing(); });
}

SharedMapServer::~SharedMapServer() {
  diagnostics_.reset();
  tf_timer_.stop();
  services_.spinner->stop();
  {
    const Lock lock(mutex_);
    ending_ = true;
  }
  end_.notify_all();
  for (std::thread& t : threads_) t.join();
}

void SharedMapServer::advertise(ros::NodeHandle nh, const ros::NodeHandle& private_nh) {
  publish_.map = nh.advertise<nav_msgs::OccupancyGrid>("map", 1, true);
  publish_.metadata = nh.advertise<nav_msgs::MapMetaData>("map_metadata", 1, true);
  publish_.certainty = nh.advertise<nav_msgs::OccupancyGrid>("map_certainty", 1, true);
  publish_.markers = nh.advertise<visualization_msgs::MarkerArray>("shared_map_markers", 1, true);
  publish_.status = nh.advertise<hyselam_msgs::SharedMapStatus>("shared_map_status", 1, true);
  ros::NodeHandle public_services(nh), private_services(private_nh);
  public_services.setCallbackQueue(&services_.queue);
  private_services.setCallbackQueue(&services_.queue);
  services_.save = private_services.advertiseService("save", &SharedMapServer::onSave, this);
  using nav_msgs::GetMap;
  services_.map = public_services.advertiseService<GetMap::Request, GetMap::Response>(
      "dynamic_map", [this](GetMap::Request&, GetMap::Response& out) { return onMap(out); });
  services_.spinner = std::make_unique<ros::AsyncSpinner>(1, &services_.queue);
  services_.spinner->start();
  tf_timer_ = nh.createWallTimer(ros::WallDuration(params_.transform_publish_period),
                                 [this](const ros::WallTimerEvent&) { broadcast(); });
  diagnostics_ = std::make_unique<hyselam::Diagnostics>(
      nh, private_nh.getNamespace().substr(1) + ": shared map", params_.diagnostic_period,
      [this](DiagnosticStatus& status) { report(status); });
}

/// False when the server ends.
bool SharedMapServer::waitFor(double seconds) {
  Lock lock(mutex_);
  end_.wait_for(lock, std::chrono::duration<double>(seconds), [this] { return ending_; });
  return !ending_;
}

std_msgs::Header SharedMapServer::header() const {
  std_msgs::Header h;
  h.stamp = ros::Time::now();
  h.frame_id = params_.global_frame_id;
  return h;
}

// ---- what the robots tell

void SharedMapServer::poll(std::size_t robot) {
  // Not persistent: it connects anew for each call, also after the robot has left and come back.
  ros::ServiceClient client =
      nh_.serviceClient<hyselam_msgs::SlamGraph>(nh_.resolveName(names_[robot] + "/slam_graph"));
  do {
    while (ask(robot, &client)) {
    }
  } while (waitFor(params_.poll_period));
}

/// Whether there is more to be asked for at once.
bool SharedMapServer::ask(std::size_t robot, ros::ServiceClient* client) {
  hyselam_msgs::SlamGraph srv;
  {
    const Lock lock(mutex_);
    if (ending_) return false;
    asked_since_[robot] = ros::WallTime::now();
    toMsg(shared_.question(robot, kKeyframesAtOnce), &srv.request);
  }
  const bool answered = client->exists() && client->call(srv);
  std::string reason = answered ? "" : kNoAnswer;
  bool more = false;
  if (answered) {
    try {
      take(robot, srv.response);
      more = srv.response.complete == 0 && !srv.response.new_keyframes.empty();
    } catch (const std::exception& e) {
      reason = e.what();
    }
  }
  const Lock lock(mutex_);
  asked_since_[robot].reset();
  if (answers_[robot].reason != reason) {
    if (reason.empty()) {
      ROS_INFO_STREAM(log_name_ << ' ' << names_[robot] << " answers");
    } else {
      ROS_WARN_STREAM(log_name_ << ' ' << names_[robot] << ": " << reason
                                << "; what is known of its map stays");
    }
    answers_[robot].reason = reason;
  }
  return more;
}

/// @throws hyselam::InputError
void SharedMapServer::take(std::size_t robot, const hyselam_msgs::SlamGraph::Response& answer) {
  const auto isFrameOf = [&](const RobotAnswers& other) { return other.frame == answer.frame; };
  GraphPart part = fromMsg(answer, names_[robot]);
  const Lock lock(mutex_);
  if (answer.frame.empty() || answer.frame == params_.global_frame_id) {
    throw hyselam::InputError(
        names_[robot], "frame",
        "its map has the frame '" + answer.frame + "' instead of one of its own");
  }
  for (std::size_t other = 0; other < answers_.size(); ++other) {
    if (other != robot && isFrameOf(answers_[other])) {
      throw hyselam::InputError(
          names_[robot], "frame",
          "its map has the frame of that of " + names_[other] + ", '" + answer.frame + "'");
    }
  }
  answers_[robot].frame = answer.frame;
  if (shared_.add(robot, std::move(part))) drawn_ = false;
}

// ---- merging

void SharedMapServer::runMerging() {
  double pause = params_.poll_period;
  int failures = 0;  // without a success since
  while (waitFor(pause)) {
    pause = params_.poll_period;
    std::optional<SharedMap::Work> work;
    {
      const Lock lock(mutex_);
      work = shared_.takeWork();
    }
    if (!work) continue;
    const ros::WallTime begin = ros::WallTime::now();
    std::string error;
    try {
      const MergedMaps merged = SharedMap::merge(&*work, shared_.params().merging,
                                                 [&](const std::string&, std::size_t, std::size_t) {
                                                   const Lock lock(mutex_);
                                                   if (ending_) throw Ending{};
                                                 });
      const Lock lock(mutex_);
      shared_.apply(*work, merged);
      drawn_ = false;
    } catch (const Ending&) {
      return;
    } catch (const std::exception& e) {
      error = e.what();
      const Lock lock(mutex_);
      if (error != times_.merge_error) {
        ROS_ERROR_STREAM(log_name_ << " the maps are not merged: " << error);
      }
      shared_.giveBack();
    }
    const double seconds = (ros::WallTime::now() - begin).toSec();
    {
      const Lock lock(mutex_);
      times_.merge_s = seconds;
      times_.merge_error = error;
    }
    failures = error.empty() ? 0 : std::min(failures + 1, 6);
    const int threads = shared_.params().merging.threads;
    // What failed by its own is tried again, less and less often.
    pause = std::max(std::ldexp(params_.merge_interval, failures),
                     seconds * (threads / params_.max_load - 1.0));
  }
}

// ---- what is shown

void SharedMapServer::runDrawing() {
  double pause = params_.map_update_interval;
  while (waitFor(pause)) {
    pause = params_.map_update_interval;
    {
      const Lock lock(mutex_);
      if (drawn_) continue;
      drawn_ = true;
    }
    const ros::WallTime begin = ros::WallTime::now();
    std::string error;
    try {
      draw();
    } catch (const std::exception& e) {
      error = e.what();
      ROS_ERROR_STREAM_THROTTLE(10.0, log_name_ << " the map is not complete: " << error);
    }
    const Lock lock(mutex_);
    times_.map_error = error;
    times_.map_ms = millisecondsSince(begin);
    pause = std::max(pause, 1e-3 * times_.map_ms * (1.0 / params_.max_load - 1.0));
  }
}

void SharedMapServer::draw() {
  SharedMapState shared;
  {
    const Lock lock(mutex_);
    shared = shared_.state();
  }
  if (shared.state.keyframes.empty()) return;
  const std_msgs::Header h = header();
  publish_.markers.publish(sharedMapMarkers(shared, names_, h));
  PresentMap map(params_.map);
  const auto runs = static_cast<std::uint32_t>(shared.robot_of_run.size());
  map.update(
      {shared.state.keyframes, shared.state.settled, std::vector<bool>(runs, true), runs, 0});
  const PresentMap::Drawn drawn = map.draw();
  nav_msgs::OccupancyGrid grid = hyselam::toMsg(drawn.grid, h.frame_id, h.stamp);
  grid.info.map_load_time = h.stamp;
  publish_.map.publish(grid);
  publish_.metadata.publish(grid.info);
  publish_.certainty.publish(hyselam::toMsg(drawn.probabilities, h.frame_id, h.stamp));
  const Lock lock(mutex_);
  newest_map_ = std::move(grid);
}

void SharedMapServer::broadcast() {
  const ros::Time now = ros::Time::now();
  if (now.isZero()) return;
  std::vector<geometry_msgs::TransformStamped> transforms;
  {
    const Lock lock(mutex_);
    const std::vector<RobotInSharedMap> robots = shared_.robots();
    for (std::size_t i = 0; i < robots.size(); ++i) {
      if (!robots[i].map_in_shared) continue;
      geometry_msgs::TransformStamped t;
      t.header.frame_id = params_.global_frame_id;
      t.child_frame_id = answers_[i].frame;
      t.transform = hyselam::toTransformMsg(*robots[i].map_in_shared);
      transforms.push_back(t);
    }
  }
  if (transforms.empty()) return;
  ros::Time stamp = now + ros::Duration(params_.transform_publish_period);
  // Nobody takes a second transform of one stamp: while the clock stands, what is new is sent with
  // the next one, and nothing else.
  if (now == sent_at_) {
    const auto same = [](const auto& a, const auto& b) {
      return a.child_frame_id == b.child_frame_id && isSame(a.transform, b.transform);
    };
    if (std::equal(transforms.begin(), transforms.end(), sent_.begin(), sent_.end(), same)) return;
    stamp = sent_stamp_ + ros::Duration(0, 1);
  }
  for (geometry_msgs::TransformStamped& t : transforms) t.header.stamp = stamp;
  tf_.sendTransform(transforms);
  sent_at_ = now;
  sent_stamp_ = stamp;
  sent_ = std::move(transforms);
}

bool SharedMapServer::onMap(nav_msgs::GetMap::Response& out) {
  const Lock lock(mutex_);
  if (newest_map_) out.map = *newest_map_;
  return newest_map_.has_value();
}

bool SharedMapServer::onSave(hyselam_msgs::StatePath::Request& request,
                             hyselam_msgs::StatePath::Response& out) {
  try {
    if (request.path.empty()) throw hyselam::InputError("path", "", "none given");
    SharedMapState shared;
    {
      const Lock lock(mutex_);
      shared = shared_.state();
    }
    if (shared.state.keyframes.empty()) throw hyselam::InputError("map", "", "there is none yet");
    SlamStateFile::save(request.path, shared.state);
    out.success = true;
    out.message = request.path + ": " + std::to_string(shared.state.keyframes.size()) +
                  " keyframes, " + std::to_string(shared.state.loops.size()) + " loops";
  } catch (const std::exception& e) {
    out.success = false;
    out.message = e.what();
    ROS_ERROR_STREAM(log_name_ << " not saved: " << e.what());
  }
  return true;
}

/// Also publishes the status, at the same times.
void SharedMapServer::report(DiagnosticStatus& status) {
  const Lock lock(mutex_);
  const std::vector<RobotInSharedMap> robots = shared_.robots();
  std::vector<RobotAnswers> answers = answers_;
  for (std::size_t i = 0; i < answers.size(); ++i) {
    // A call over a lost connection comes back late, or never.
    if (answers[i].reason.empty() && asked_since_[i] &&
        (ros::WallTime::now() - *asked_since_[i]).toSec() > params_.answer_timeout) {
      answers[i].reason = kNoAnswer;
    }
  }
  const hyselam_msgs::SharedMapStatus msg = sharedMapStatusMsg(answers, robots, header());
  publish_.status.publish(msg);
  if (msg.text != told_) ROS_INFO_STREAM(log_name_ << ' ' << msg.text);
  told_ = msg.text;
  addRemark(status, DiagnosticStatus::OK, msg.text);
  for (const RobotAnswers& a : answers) {
    if (!a.reason.empty()) addRemark(status, DiagnosticStatus::WARN, a.name + ": " + a.reason);
  }
  const auto addError = [&](const char* what, const std::string& error) {
    if (!error.empty()) addRemark(status, DiagnosticStatus::ERROR, what + error);
  };
  addError("merging: ", times_.merge_error);
  addError("map: ", times_.map_error);
  for (const LeftOutSession& r : shared_.remarks()) {
    addRemark(status, DiagnosticStatus::WARN, r.name + ": " + r.reason);
  }
  if (shared_.formerMapsGivenUp() > 0) {
    addRemark(status, DiagnosticStatus::WARN,
              std::to_string(shared_.formerMapsGivenUp()) + " former maps were given up");
  }
  for (const hyselam_msgs::SharedMapRobot& r : msg.robots) {
    addValue(status, r.name + ": in the map", static_cast<bool>(r.in_map));
    addValue(status, r.name + ": keyframes", r.keyframes);
    addValue(status, r.name + ": ties to other robots", r.ties);
  }
  addValue(status, "mergings", shared_.merges());
  addValue(status, "last merging [s]", times_.merge_s);
  addValue(status, "last map [ms]", times_.map_ms);
}

}  // namespace ngram_slam
