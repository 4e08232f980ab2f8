#include "fsd_localization/ros/localization_server.hpp"

#include <nav_msgs/GetMap.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/ros/conversions.hpp"
#include "hyselam_common/ros/server_setup.hpp"

namespace fsd_localization {

using hyselam::addRemark;
using hyselam::addValue;
using hyselam::InitialPose;
using hyselam::loadAndLogParams;
using hyselam::logName;
using hyselam::Pose2;

namespace {

constexpr double kTakeOverPeriod = 0.05;  // [s] while a map is being prepared
constexpr double kRequestPeriod = 0.5;    // [s] for the service static_map
constexpr double kReminderPeriod = 10.0;  // [s] that no map has come on the topic
constexpr double kRetryPeriod = 2.0;      // [s] when it gave a map that cannot be used

LocalizationServerParams loadParams(const ros::NodeHandle& private_nh) {
  for (const std::string& sentence : ignoredAmclParams(hyselam::ParamLoader(private_nh))) {
    ROS_WARN_STREAM(logName(private_nh) << " " << sentence);
  }
  return loadAndLogParams(private_nh, loadLocalizationParams);
}

hyselam::OccupancyGrid checkedMap(const nav_msgs::OccupancyGrid& msg,
                                  const LocalizationServerParams& params,
                                  const std::string& source) {
  std::string frame = msg.header.frame_id;
  if (!frame.empty() && frame[0] == '/') frame.erase(0, 1);
  if (frame != params.global_frame_id) {
    throw hyselam::InputError(
        source, "frame_id",
        "is '" + frame + "', but global_frame_id is '" + params.global_frame_id + "'");
  }
  const double cells = static_cast<double>(msg.info.width) * static_cast<double>(msg.info.height);
  if (cells > params.max_map_cells) {
    throw hyselam::InputError(
        source, "size",
        std::to_string(msg.info.width) + " x " + std::to_string(msg.info.height) +
            " cells are more than max_map_cells, " + std::to_string(params.max_map_cells));
  }
  hyselam::OccupancyGrid map = hyselam::fromMsg(msg, source);
  try {
    Localizer::checkMap(map, params.localizer);
  } catch (const std::exception& e) {
    throw hyselam::InputError(source, "", e.what());
  }
  return map;
}

/// Sleeps, but not on when the map is not wanted any more. @param seconds of wall time.
void pauseFor(double seconds, const std::function<bool()>& cancelled) {
  for (double waited = 0.0; waited < seconds && ros::ok() && !cancelled();
       waited += kTakeOverPeriod) {
    ros::WallDuration(kTakeOverPeriod).sleep();
  }
}

/// Calls static_map until it answers.
MapPreparation::Source mapService(ros::NodeHandle nh, const LocalizationServerParams& params,
                                  const std::string& who, std::atomic<bool>& map_seen) {
  return
      [nh, params, who, &map_seen](
          const std::function<bool()>& cancelled) mutable -> std::optional<hyselam::OccupancyGrid> {
        ros::ServiceClient client = nh.serviceClient<nav_msgs::GetMap>("static_map");
        while (ros::ok() && !cancelled()) {
          nav_msgs::GetMap call;
          if (client.exists() && client.call(call)) {
            hyselam::OccupancyGrid map =
                checkedMap(call.response.map, params, "service " + client.getService());
            map_seen = true;
            return map;
          }
          ROS_INFO_STREAM_THROTTLE(
              10.0, who << " waiting for a map from the service " << client.getService());
          pauseFor(kRequestPeriod, cancelled);
        }
        return std::nullopt;
      };
}

}  // namespace

LocalizationServer::LocalizationServer(ros::NodeHandle nh, const ros::NodeHandle& private_nh)
    : private_nh_(private_nh),
      log_name_(logName(private_nh)),
      map_topic_(nh.resolveName("map")),
      params_(loadParams(private_nh)),
      publisher_(nh, params_),
      map_service_(mapService(nh, params_, log_name_, map_seen_)),
      preparation_(params_.localizer, params_.cache_dir),
      input_(
          nh, params_.input, log_name_,
          [this](const hyselam::LaserScan& scan, const Pose2& base_in_odom,
                 const ros::Time& stamp) { return onScan(scan, base_in_odom, stamp); },
          [this] { onTimeJump(); }),
      diagnostics_(nh, private_nh.getNamespace().substr(1) + ": localisation",
                   params_.diagnostic_period,
                   [this](diagnostic_msgs::DiagnosticStatus& status) { report(status); }),
      map_timer_(nh.createWallTimer(
          ros::WallDuration(kTakeOverPeriod),
          [this](const ros::WallTimerEvent&) { takeOverMap({}); }, false, false)) {
  using Empty = std_srvs::Empty;
  if (const auto pose = params_.initial_pose.pose()) waiting_pose_ = WaitingPose{*pose, {}};
  if (params_.use_map_topic) {
    map_subscriber_ = nh.subscribe("map", 1, &LocalizationServer::onMap, this);
  } else {
    requestMap(0.0);
  }
  input_.holdWhile([this](const ros::Time& stamp) { return isHeldUp(stamp); });
  initial_pose_subscriber_ =
      nh.subscribe("initialpose", 2, &LocalizationServer::onInitialPose, this);
  services_.push_back(nh.advertiseService<Empty::Request, Empty::Response>(
      "global_localization", [this](Empty::Request&, Empty::Response&) {
        if (localizer_) localizer_->relocalizeGlobally();
        forgetPose("called by the service global_localization");
        return true;
      }));
  services_.push_back(nh.advertiseService<Empty::Request, Empty::Response>(
      "request_nomotion_update", [this](Empty::Request&, Empty::Response&) {
        force_update_ = true;
        return true;
      }));
  services_.push_back(nh.advertiseService("set_map", &LocalizationServer::onSetMap, this));
}

// ---- maps

void LocalizationServer::onMap(const nav_msgs::OccupancyGrid::ConstPtr& msg) {
  if (params_.first_map_only && map_seen_) {
    ROS_INFO_STREAM(log_name_ << " another map is ignored (first_map_only)");
    return;
  }
  prepare(*msg, map_topic_);
}

bool LocalizationServer::prepare(const nav_msgs::OccupancyGrid& msg, const std::string& source) {
  hyselam::OccupancyGrid map;
  try {
    map = checkedMap(msg, params_, source);
  } catch (const hyselam::InputError& e) {
    map_error_.clear();  // reported each time that somebody sends it
    refuseMap(e.what());
    return false;
  }
  const std::uint64_t fingerprint = FsdMap::fingerprint(map, params_.localizer.map);
  if (map_seen_ && fingerprint == fingerprint_ && map_error_.empty()) {
    ROS_INFO_STREAM(log_name_ << " the same map again, nothing to do");
    return true;
  }
  fingerprint_ = fingerprint;
  map_seen_ = true;
  map_error_.clear();
  ROS_INFO_STREAM(log_name_ << " preparing a map of " << map.geometry.width << " x "
                            << map.geometry.height << " cells of " << map.geometry.resolution
                            << " m");
  if (localizer_) waiting_pose_.reset();  // it was for a map that is not wanted any more
  startPreparation([map = std::move(map)](const std::function<bool()>&) { return map; });
  return true;
}

void LocalizationServer::requestMap(double pause) {
  // Kept for other parameters; only the thread of the preparation sees it.
  auto kept = std::make_shared<std::optional<hyselam::OccupancyGrid>>();
  startPreparation([ask = map_service_, pause, kept](const std::function<bool()>& cancelled) {
    if (!*kept) {
      pauseFor(pause, cancelled);
      *kept = ask(cancelled);
    }
    return *kept;
  });
}

void LocalizationServer::startPreparation(MapPreparation::Source source) {
  last_source_ = std::move(source);
  preparation_.start(last_source_);
  map_timer_.start();
}

namespace {

/// Values of all parameters, to be compared.
std::vector<std::string> valuesOf(LocalizerParams params) {
  hyselam::ParameterTable table;
  table.group("", params);
  std::vector<std::string> values;
  for (const hyselam::ParameterRow& row : table.rows()) values.push_back(row.default_yaml);
  return values;
}

}  // namespace

void LocalizationServer::setParams(const LocalizationServerParams& params) {
  const bool other_localizer = valuesOf(params.localizer) != valuesOf(params_.localizer);
  params_ = params;
  publisher_.setParams(params_);
  if (!other_localizer) return;
  preparation_.setParams(params_.localizer);
  // Without a map yet, the first one will find the new parameters.
  if (last_source_) startPreparation(last_source_);
}

void LocalizationServer::refuseMap(const std::string& why) {
  if (why != map_error_) {
    ROS_ERROR_STREAM(log_name_ << " map refused: " << why
                               << (localizer_ ? "; the map before stays" : ""));
  }
  map_error_ = why;
}

void LocalizationServer::takeOverMap(const std::optional<Pose2>& base_in_odom) {
  std::optional<MapPreparation::Outcome> outcome = preparation_.take();
  if (!preparation_.busy()) map_timer_.stop();
  if (!outcome) return;
  if (!outcome->localizer) {
    if (outcome->error.empty()) return;  // the node ends
    refuseMap(outcome->error);
    map_seen_ = localizer_ != nullptr;
    if (localizer_) {
      waiting_pose_.reset();  // it came with this map
    } else if (!params_.use_map_topic) {
      requestMap(kRetryPeriod);  // the map server may have a better one by then
    }
    return;
  }
  // A corrected map of the same place shall not make a robot lost that knows where it is.
  const std::optional<Pose2> odometry = base_in_odom ? base_in_odom : input_.baseInOdom();
  std::optional<InitialPose> start;
  if (waiting_pose_) {
    start = waiting_pose_->pose;
    if (odometry && waiting_pose_->base_in_odom) {
      start->base_in_map = start->base_in_map * between(*waiting_pose_->base_in_odom, *odometry);
    }
  } else if (last_result_ && (last_result_->converged || guided_)) {
    const auto deviation = [&](int i) {
      return std::max(0.25, std::sqrt(last_result_->covariance(i, i)));
    };
    start = InitialPose{
        odometry && odom_in_map_ ? *odom_in_map_ * *odometry : last_result_->base_in_map,
        {deviation(0), deviation(1), deviation(2)}};
  }
  waiting_pose_.reset();
  localizer_ = std::move(outcome->localizer);
  localizer_->waitForSearch(false);  // a callback waits for nothing; the scans do
  map_error_.clear();
  const FsdMap& map = localizer_->map();
  ROS_INFO_STREAM(log_name_ << " map ready: " << map.freeCells().size() << " free cells, "
                            << map.kernelCount() << " density fields "
                            << (outcome->cached ? "read" : "computed") << " in " << outcome->seconds
                            << " s, " << map.bytes() / 1000000.0 << " MB");
  if (!outcome->cache_problem.empty()) {
    ROS_WARN_STREAM(
        log_name_ << " the density fields could not be kept, the next start will compute them"
                  << " again: " << outcome->cache_problem);
  }
  publisher_.publishMap(*localizer_);
  if (!start || !startAt(*start)) {
    forgetPose("a new map");  // whose particles lie everywhere already
  }
}

// ---- scans

/// The scan at which an answer of the search counts waits for it.
bool LocalizationServer::isHeldUp(const ros::Time& stamp) {
  using Wait = hyselam::ResultWait;
  const bool is_there = !localizer_ || !localizer_->isSearchLate(stamp.toSec());
  const auto verdict = search_wait_.ask(is_there, ros::WallTime::now());
  if (verdict != Wait::Verdict::kGivenUp) return verdict == Wait::Verdict::kWait;
  ROS_WARN_STREAM_THROTTLE(
      30.0, log_name_ << " a search of the map has taken longer than search_latency, "
                      << params_.localizer.search_latency << " s, and search_wait, "
                      << params_.search_wait << " s: the machine is too slow, or the map too large."
                      << " Its answer counts when it comes; the same scans may give other poses");
  return false;
}

bool LocalizationServer::onScan(const hyselam::LaserScan& scan, const Pose2& base_in_odom,
                                const ros::Time& stamp) {
  takeOverMap(base_in_odom);
  if (!localizer_) {
    if (!map_seen_) {
      input_.drops().drop("no map", "none has come yet");
    } else {
      input_.drops().drop("map not ready",
                          map_error_.empty() ? "it is being prepared" : map_error_);
    }
    return false;
  }
  const ros::WallTime begin = ros::WallTime::now();
  localizer_->keepLocalMap(publisher_.showsLocalMap());
  const auto result = localizer_->update(scan, base_in_odom, force_update_);
  if (result) {
    updates_.last_ms = 1e3 * (ros::WallTime::now() - begin).toSec();
    force_update_ = false;
    ++updates_.count;
    noteResult(*result, base_in_odom);
    publisher_.publishUpdate(*localizer_, *result, updates_.last_ms, stamp);
    savePose(*result);
  }
  // Between updates too: tf listeners need transforms that cover the present.
  if (odom_in_map_ && params_.tf_broadcast) publisher_.broadcast(*odom_in_map_, stamp);
  return true;
}

void LocalizationServer::noteResult(const LocalizationResult& result, const Pose2& base_in_odom) {
  if (!last_result_ || last_result_->phase != result.phase ||
      last_result_->converged != result.converged) {
    ROS_INFO_STREAM(log_name_ << " " << toString(result.phase)
                              << (result.converged ? ", converged" : ", not converged") << " at x "
                              << result.base_in_map.x << " m, y " << result.base_in_map.y << " m, "
                              << hyselam::degrees(result.base_in_map.theta) << " deg after "
                              << result.travelled << " m");
  }
  const auto looks_carried = [](const LocalizationResult& r) {
    return r.misfits_standing && !r.converged;
  };
  if (looks_carried(result) && !(last_result_ && looks_carried(*last_result_))) {
    ROS_WARN_STREAM(log_name_ << " " << std::lround(100.0 * result.inlier_ratio.value_or(0.0))
                              << " % of the returns explained while the robot stands: was it "
                                 "carried? drive a little, or set a pose");
  }
  last_result_ = result;
  // An unconverged pose does not move the transform: dead reckoning from the last known pose is
  // better than jumping between hypotheses.
  if (result.converged || guided_ || params_.publish_unconverged_tf) {
    odom_in_map_ = result.base_in_map * base_in_odom.inverse();
  }
  if (result.converged) guided_ = false;
}

void LocalizationServer::onTimeJump() {
  odom_in_map_.reset();  // the odometry may have begun again elsewhere
  if (waiting_pose_) waiting_pose_->base_in_odom.reset();
  if (localizer_) localizer_->restartClock();
}

void LocalizationServer::savePose(const LocalizationResult& result) {
  if (params_.save_pose_rate <= 0.0 || !result.converged) return;
  const ros::WallTime now = ros::WallTime::now();
  if ((now - saved_).toSec() < 1.0 / params_.save_pose_rate) return;
  saved_ = now;
  private_nh_.setParam("initial_pose_x", result.base_in_map.x);
  private_nh_.setParam("initial_pose_y", result.base_in_map.y);
  private_nh_.setParam("initial_pose_a", result.base_in_map.theta);
  constexpr const char* kNames[] = {"initial_cov_xx", "initial_cov_yy", "initial_cov_aa"};
  constexpr double kSmallest = 1e-6;  // 0 would be refused at the next start
  for (int i = 0; i < 3; ++i) {
    private_nh_.setParam(kNames[i], std::max(kSmallest, result.covariance(i, i)));
  }
}

// ---- poses and commands from outside

void LocalizationServer::onInitialPose(
    const geometry_msgs::PoseWithCovarianceStamped::ConstPtr& msg) {
  const auto pose = hyselam::initialPoseNow(*msg, params_.global_frame_id,
                                            initial_pose_subscriber_.getTopic(), input_, log_name_);
  if (!pose) return;
  if (msg->header.frame_id.empty()) {
    ROS_WARN_STREAM(log_name_ << " initial pose without frame_id, taken as "
                              << params_.global_frame_id);
  }
  if (startAt(*pose) && params_.force_update_after_initialpose) force_update_ = true;
}

bool LocalizationServer::startAt(const InitialPose& pose) {
  ROS_INFO_STREAM(log_name_ << " initial pose x " << pose.base_in_map.x << " m, y "
                            << pose.base_in_map.y << " m, "
                            << hyselam::degrees(pose.base_in_map.theta) << " deg"
                            << (localizer_ ? "" : ", kept for when a map is ready"));
  // The newest guess counts.
  if (!localizer_ || preparation_.busy()) waiting_pose_ = WaitingPose{pose, input_.baseInOdom()};
  if (!localizer_) return true;
  try {
    localizer_->setInitialPose(pose.base_in_map, pose.stddev);
  } catch (const hyselam::InputError& e) {
    ROS_ERROR_STREAM(log_name_ << " initial pose ignored: " << e.what());
    return false;
  }
  odom_in_map_.reset();
  last_result_.reset();
  guided_ = true;
  return true;
}

void LocalizationServer::forgetPose(const std::string& why) {
  ROS_INFO_STREAM(log_name_ << " searching the whole map: " << why);
  waiting_pose_.reset();
  odom_in_map_.reset();
  last_result_.reset();
  guided_ = false;
  publisher_.publishUnknown("global, not converged: " + why,
                            localizer_ ? localizer_->particles().size() : 0);
}

bool LocalizationServer::onSetMap(nav_msgs::SetMap::Request& request,
                                  nav_msgs::SetMap::Response& response) {
  response.success = false;
  InitialPose pose;
  try {
    pose = hyselam::initialPoseFromMsg(request.initial_pose, params_.global_frame_id,
                                       "service set_map: initial_pose");
  } catch (const hyselam::InputError& e) {
    ROS_ERROR_STREAM(log_name_ << " set_map refused: " << e.what());
    return true;
  }
  if (!prepare(request.map, "service set_map: map")) return true;
  if (preparation_.busy()) {
    waiting_pose_ = WaitingPose{pose, input_.baseInOdom()};
    response.success = true;
  } else {
    response.success = startAt(pose);  // it was the same map
  }
  if (response.success && params_.force_update_after_set_map) force_update_ = true;
  return true;
}

// ---- diagnostics

void LocalizationServer::report(diagnostic_msgs::DiagnosticStatus& status) {
  using Status = diagnostic_msgs::DiagnosticStatus;
  input_.checkClock();
  const bool preparing = map_seen_ && preparation_.busy();
  if (preparing) {
    addRemark(status, Status::WARN,
              "preparing map (" +
                  std::to_string(static_cast<int>(100.0 * preparation_.progress())) + " %)");
  }
  if (!map_error_.empty()) addRemark(status, Status::ERROR, "map refused: " + map_error_);
  if (!localizer_) {
    if (!preparing && map_error_.empty()) {
      addRemark(status, Status::WARN,
                std::string("waiting for a map from the ") +
                    (params_.use_map_topic ? "topic map" : "service static_map"));
      const ros::WallTime now = ros::WallTime::now();
      if (params_.use_map_topic && (now - reminded_of_map_).toSec() > kReminderPeriod) {
        reminded_of_map_ = now;
        ROS_WARN_STREAM(log_name_ << " waiting for a map on " << map_topic_ << " ("
                                  << map_subscriber_.getNumPublishers() << " publishers)");
      }
    }
  } else if (!last_result_) {
    addRemark(status, Status::WARN, "map ready, no update yet");
  } else {
    addRemark(status, last_result_->converged ? Status::OK : Status::WARN,
              std::string(toString(last_result_->phase)) +
                  (last_result_->converged ? "" : ", not converged"));
  }
  addValue(status, "map ready", localizer_ != nullptr);
  addValue(status, "model", toString(params_.localizer.model));
  addValue(status, "updates", updates_.count);
  addValue(status, "last update [ms]", updates_.last_ms);
  addValue(status, "searches late", search_wait_.givenUp());
  if (last_result_) {
    const Eigen::Matrix3d& c = last_result_->covariance;
    addValue(status, "phase", toString(last_result_->phase));
    addValue(status, "converged", last_result_->converged);
    addValue(status, "particles", last_result_->particles);
    addValue(status, "cluster weight", last_result_->cluster_weight);
    addValue(status, "cluster deviation x, y [m], yaw [deg]",
             std::to_string(std::sqrt(c(0, 0))) + " " + std::to_string(std::sqrt(c(1, 1))) + " " +
                 std::to_string(hyselam::degrees(std::sqrt(c(2, 2)))));
    if (last_result_->inlier_ratio) addValue(status, "inlier ratio", *last_result_->inlier_ratio);
    if (last_result_->place_probability) {
      addValue(status, "place probability", *last_result_->place_probability);
      addValue(status, "places", last_result_->places);
    }
    addValue(status, "travelled [m]", last_result_->travelled);
  }
  addValue(status, "publishing tf", odom_in_map_.has_value() && params_.tf_broadcast);
  input_.report(status);
}

}  // namespace fsd_localization
