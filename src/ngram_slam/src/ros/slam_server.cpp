#include "ngram_slam/ros/slam_server.hpp"

#include <hyselam_msgs/RegionGraph.h>
#include <hyselam_msgs/SemanticRegionArray.h>
#include <hyselam_msgs/WordArray.h>
#include <hyselam_msgs/WordMatchArray.h>
#include <nav_msgs/Path.h>
#include <sys/stat.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/ros/conversions.hpp"
#include "hyselam_common/ros/initial_pose.hpp"
#include "hyselam_common/ros/server_setup.hpp"
#include "ngram_slam/ros/conversions.hpp"
#include "ngram_slam/ros/slam_messages.hpp"
#include "ngram_slam/slam/region_graph.hpp"
#include "ngram_slam/slam/slam_state_io.hpp"
#include "wall_milliseconds.hpp"

namespace ngram_slam {

using hyselam::Pose2;
using Lock = std::unique_lock<std::mutex>;
using Status = diagnostic_msgs::DiagnosticStatus;

namespace {

constexpr std::uint32_t kQueue = 1000;
constexpr double kOdometryWindow = 0.1;  // [m], [rad] searched where odometry tells the start
constexpr double kOdometryDrift = 0.1;   // [m/m], [rad/m]

bool exists(const std::string& path) {
  struct stat info {};
  return ::stat(path.c_str(), &info) == 0;
}

/// Where the robot is when its odometry went on from elsewhere: beside the keyframe of the last run
/// that was taken nearest by odometry. A bag that begins again and a clock that was set back are
/// told right alike.
Pose2 placeByOdometry(const std::vector<SlamKeyframe>& keyframes, const Pose2& odometry) {
  const SlamKeyframe* nearest = &keyframes.back();
  for (const SlamKeyframe& k : keyframes)
    if (k.run == keyframes.back().run &&
        distance(k.odometry, odometry) < distance(nearest->odometry, odometry))
      nearest = &k;
  return nearest->pose * between(nearest->odometry, odometry);
}

}  // namespace

SlamServer::Mapping::Mapping(const SlamServerParams& params, SlamState state)
    : engine(params.slam, std::move(state)), segmenter(params.semantic) {
  segment();
  told_words = engine.recogniser().text().words();
  told_matches = engine.matches().size();
  requantisations = engine.recogniser().requantisations();
  saved_scans = engine.counters().scans;
}

std::vector<SemanticRegion> SlamServer::Mapping::segment() {
  const ObservationStore& observations = engine.recogniser().observations();
  std::vector<SemanticRegion> fresh;
  const auto take = [&](const std::vector<SemanticRegion>& found) {
    fresh.insert(fresh.end(), found.begin(), found.end());
  };
  for (; segmented < observations.size(); ++segmented) {
    if (segmented > 0 && observations.runOf(segmented) != observations.runOf(segmented - 1))
      take(segmenter.finish());
    take(segmenter.add(observations[segmented]));
  }
  regions.insert(regions.end(), fresh.begin(), fresh.end());
  return fresh;
}

SlamServer::SlamServer(ros::NodeHandle nh, const ros::NodeHandle& private_nh)
    : who_(hyselam::logName(private_nh)),
      params_(hyselam::loadAndLogParams(private_nh, loadSlamParams)),
      pending_(params_.initial_pose),
      map_rate_(params_.map_update_interval > 0.0 ? 1.0 / params_.map_update_interval : -1.0) {
  SlamState state;
  if (!params_.state.empty() && exists(params_.state)) {
    state = SlamStateFile::load(params_.state, params_.slam.surface);
    ROS_INFO_STREAM(who_ << " goes on with " << params_.state << ": " << state.keyframes.size()
                         << " keyframes, " << state.loops.size() << " loops");
  }
  mapping_ = std::make_unique<Mapping>(params_, std::move(state));
  if (!mapping_->engine.keyframes().empty()) next_ = Next::kAfterPause;
  map_due_ = drawsMaps() && !mapping_->engine.keyframes().empty();

  map_publisher_ = nh.advertise<nav_msgs::OccupancyGrid>("map", 1, true);
  metadata_publisher_ = nh.advertise<nav_msgs::MapMetaData>("map_metadata", 1, true);
  word_publisher_ = nh.advertise<hyselam_msgs::WordArray>("words", kQueue);
  match_publisher_ = nh.advertise<hyselam_msgs::WordMatchArray>("word_matches", kQueue);
  region_publisher_ = nh.advertise<hyselam_msgs::SemanticRegionArray>("semantic_regions", kQueue);
  graph_publisher_ = nh.advertise<hyselam_msgs::RegionGraph>("region_graph", 1, true);
  path_publisher_ = nh.advertise<nav_msgs::Path>("path", 1, true);
  marker_publisher_ = nh.advertise<visualization_msgs::MarkerArray>("slam_markers", 1, true);

  ros::NodeHandle service_nh(nh), private_service_nh(private_nh);
  service_nh.setCallbackQueue(&service_queue_);
  private_service_nh.setCallbackQueue(&service_queue_);
  save_service_ = private_service_nh.advertiseService("save", &SlamServer::onSave, this);
  load_service_ = private_service_nh.advertiseService("load", &SlamServer::onLoad, this);
  using std_srvs::Trigger;
  const auto switchTo = [&](const char* name, bool pause) {
    return private_service_nh.advertiseService<Trigger::Request, Trigger::Response>(
        name,
        [this, pause](Trigger::Request&, Trigger::Response& out) { return onPause(pause, out); });
  };
  pause_service_ = switchTo("pause", true);
  resume_service_ = switchTo("resume", false);
  using nav_msgs::GetMap;
  map_service_ = service_nh.advertiseService<GetMap::Request, GetMap::Response>(
      "dynamic_map", [this](GetMap::Request&, GetMap::Response& out) { return onMap(out); });

  input_ = std::make_unique<hyselam::ScanInput>(
      nh, params_.input, who_,
      [this](const hyselam::LaserScan& scan, const Pose2& base_in_odom, const ros::Time& stamp) {
        return onScan(scan, base_in_odom, stamp);
      },
      [this] { onTimeBack(); });
  initial_pose_subscriber_ = nh.subscribe("initialpose", 2, &SlamServer::onInitialPose, this);
  if (params_.tf_broadcast && params_.transform_publish_period > 0.0)
    tf_timer_ = nh.createWallTimer(ros::WallDuration(params_.transform_publish_period),
                                   [this](const ros::WallTimerEvent&) {
                                     if (!told_tf_.isZero()) broadcast(ros::Time::now());
                                   });
  diagnostics_ = std::make_unique<hyselam::Diagnostics>(
      nh, private_nh.getNamespace().substr(1) + ": SLAM", params_.diagnostic_period,
      [this](Status& status) { report(status); });
  service_spinner_ = std::make_unique<ros::AsyncSpinner>(1, &service_queue_);
  service_spinner_->start();
  optimiser_ = std::thread([this] { optimise(); });
  drawer_ = std::thread([this] { draw(); });
}

SlamServer::~SlamServer() {
  // No scan comes any more: what is saved is all.
  diagnostics_.reset();
  initial_pose_subscriber_.shutdown();
  input_.reset();
  service_spinner_->stop();
  {
    const Lock lock(mutex_);
    ending_ = true;
  }
  work_.notify_all();
  optimiser_.join();
  drawer_.join();
  saveNow("at the end");
}

// ---- scans

bool SlamServer::onScan(const hyselam::LaserScan& scan, const Pose2& base_in_odom,
                        const ros::Time& stamp) {
  const ros::WallTime begin = ros::WallTime::now();
  {
    const Lock lock(mutex_);
    if (paused_) {
      ++paused_scans_;
      return false;
    }
    SlamEngine& engine = mapping_->engine;
    try {
      if (pending_ || next_ != Next::kGoOn) startRun(base_in_odom);
      const SlamUpdate update = engine.add(scan, base_in_odom);
      if (update.leap) ROS_WARN_STREAM(who_ << " the odometry leapt; the robot is taken to stand");
      weak_ += update.weak ? 1 : 0;
      mapping_->localised = true;
      last_odometry_ = base_in_odom;
      stamp_ = stamp;
      tell();
    } catch (const hyselam::InputError&) {
      throw;  // a refused scan
    } catch (const std::exception& e) {
      throw hyselam::InputError("scan", std::to_string(scan.stamp) + " s", e.what());
    }
    if (drawsMaps() && map_rate_.pass(stamp)) map_due_ = true;
    scan_ms_ = millisecondsSince(begin);
    worst_scan_ms_ = std::max(worst_scan_ms_, scan_ms_);
  }
  work_.notify_all();
  if (params_.tf_broadcast) broadcast(stamp);
  return true;
}

/// The next scan begins a run: where, is known more or less. With mutex_ held.
void SlamServer::startRun(const Pose2& base_in_odom) {
  SlamEngine& engine = mapping_->engine;
  const bool fresh = engine.keyframes().empty();
  Pose2 at = engine.pose();
  double window = params_.start_window, turn = params_.start_turn;
  // Odometry that went on tells more than a search that one scan decides.
  const auto follow = [&](const Pose2& guess, double driven) {
    at = guess;
    window = std::min(window, kOdometryWindow + kOdometryDrift * driven);
    turn = std::min(turn, kOdometryWindow + kOdometryDrift * driven);
  };
  if (pending_) {
    at = pending_->base_in_map;
    window = std::min(SlamEngine::kMaxStartWindow,
                      std::max(window, 2.0 * std::max(pending_->stddev.x, pending_->stddev.y)));
    turn = std::min(hyselam::kPi, std::max(turn, 2.0 * pending_->stddev.theta));
  } else if (!fresh && next_ == Next::kAfterJump) {
    at = placeByOdometry(engine.keyframes(), base_in_odom);
  } else if (!fresh && mapping_->localised) {  // paused: it may have been driven meanwhile
    follow(engine.odomInMap() * base_in_odom, distance(last_odometry_, base_in_odom));
  } else if (!fresh) {
    // A state was loaded. Where odometry is still near to what it was then, it was not interrupted.
    const SlamKeyframe& last = engine.keyframes().back();
    const Pose2 driven = between(last.odometry, base_in_odom);
    const double metres = std::hypot(driven.x, driven.y);
    if (metres <= params_.start_window && std::abs(driven.theta) <= params_.start_turn)
      follow(last.pose * driven, metres);
  }
  if (!fresh || pending_) {
    ROS_INFO_STREAM(who_ << " a run begins at x " << at.x << " m, y " << at.y << " m, "
                         << hyselam::degrees(at.theta) << " deg, searched within " << window
                         << " m");
    engine.startRun(at, window, turn);
  }
  pending_.reset();
  next_ = Next::kGoOn;
}

void SlamServer::onTimeBack() {
  const Lock lock(mutex_);
  mapping_->engine.endRun();
  next_ = Next::kAfterJump;
  told_tf_ = ros::Time();
}

void SlamServer::onInitialPose(const geometry_msgs::PoseWithCovarianceStamped::ConstPtr& msg) {
  hyselam::InitialPose pose;
  try {
    pose = hyselam::initialPoseFromMsg(*msg, params_.global_frame_id,
                                       initial_pose_subscriber_.getTopic());
  } catch (const hyselam::InputError& e) {
    ROS_ERROR_STREAM(who_ << " initial pose ignored: " << e.what());
    return;
  }
  // The robot may have moved on while a person pointed at the map.
  if (!msg->header.stamp.isZero())
    if (const auto motion = input_->motionSince(msg->header.stamp))
      pose.base_in_map = pose.base_in_map * *motion;
  const Lock lock(mutex_);
  pending_ = pose;
}

void SlamServer::broadcast(const ros::Time& stamp) {
  const ros::Time dated = stamp + ros::Duration(params_.transform_tolerance);
  geometry_msgs::TransformStamped transform;
  {
    const Lock lock(mutex_);
    if (!mapping_->localised || dated <= told_tf_) return;
    told_tf_ = dated;
    transform.transform = hyselam::toTransformMsg(mapping_->engine.odomInMap());
  }
  transform.header.stamp = dated;
  transform.header.frame_id = params_.global_frame_id;
  transform.child_frame_id = params_.input.odom_frame_id;
  tf_.sendTransform(transform);
}

std_msgs::Header SlamServer::header(const std::string& frame) const {
  std_msgs::Header h;
  h.stamp = stamp_;
  h.frame_id = frame;
  return h;
}

/// Words, matches and regions that are new. With mutex_ held.
void SlamServer::tell() {
  Mapping& m = *mapping_;
  const NgramRecognizer& recogniser = m.engine.recogniser();
  const bool anew = recogniser.requantisations() != m.requantisations;
  m.requantisations = recogniser.requantisations();
  if (anew) m.told_words = m.told_matches = 0;
  m.told_matches = std::min(m.told_matches, m.engine.matches().size());
  const std_msgs::Header in_odom = header(params_.input.odom_frame_id);
  const std::size_t words = recogniser.text().words();
  if (words > m.told_words || anew) {
    hyselam_msgs::WordArray msg;
    msg.header = in_odom;
    msg.anew = anew;
    for (; m.told_words < words; ++m.told_words)
      msg.words.push_back(wordMsg(recogniser, static_cast<WordIndex>(m.told_words)));
    word_publisher_.publish(msg);
    hyselam_msgs::WordMatchArray matches;
    matches.header = in_odom;
    matches.anew = anew;
    for (; m.told_matches < m.engine.matches().size(); ++m.told_matches)
      matches.matches.push_back(matchMsg(recogniser, m.engine.matches()[m.told_matches]));
    match_publisher_.publish(matches);
  }
  const std::vector<SemanticRegion> regions = m.segment();
  if (regions.empty()) return;
  hyselam_msgs::SemanticRegionArray msg;
  msg.header = in_odom;
  for (const SemanticRegion& region : regions)
    msg.regions.push_back(
        regionMsg(recogniser.observations(), region, params_.slam.observations.step));
  region_publisher_.publish(msg);
}

}  // namespace ngram_slam
