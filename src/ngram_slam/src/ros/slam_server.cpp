#include "ngram_slam/ros/slam_server.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/put_aside.hpp"
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

namespace {

constexpr double kStatusRate = 1.0;      // [1/s]
constexpr double kOdometryWindow = 0.1;  // [m], [rad] searched where odometry gives the start
constexpr double kOdometryDrift = 0.1;   // [m/m], [rad/m]

/// Where the robot is when its odometry went on from elsewhere: beside the keyframe of the last run
/// that was taken nearest by odometry. Right for a bag that begins again and for a clock that was
/// set back.
Pose2 placeByOdometry(const std::vector<SlamKeyframe>& keyframes, const Pose2& odometry) {
  const SlamKeyframe* nearest = &keyframes.back();
  for (const SlamKeyframe& k : keyframes) {
    if (k.run == keyframes.back().run &&
        distance(k.odometry, odometry) < distance(nearest->odometry, odometry)) {
      nearest = &k;
    }
  }
  return nearest->pose * between(nearest->odometry, odometry);
}

}  // namespace

SlamServer::Mapping::Mapping(const SlamServerParams& params, SlamState state)
    : name(ros::this_node::getName() + '@' + std::to_string(ros::WallTime::now().toNSec())),
      engine(params.slam, std::move(state)),
      jobs(params.slam.loop_latency),
      segmenter(params.semantic),
      session_end((engine.keyframes().empty() ? 0.0 : engine.keyframes().back().path_length) +
                  params.session_path) {
  segmentNew();
  published_words = engine.recognizer().text().words();
  published_matches = engine.matches().size();
  requantizations = engine.recognizer().requantisations();
  saved_scans = engine.counters().scans;
}

std::vector<SemanticRegion> SlamServer::Mapping::segmentNew() {
  const ObservationStore& observations = engine.recognizer().observations();
  std::vector<SemanticRegion> fresh;
  const auto append = [&](const std::vector<SemanticRegion>& found) {
    fresh.insert(fresh.end(), found.begin(), found.end());
  };
  for (; segmented < observations.size(); ++segmented) {
    if (segmented > 0 && observations.runOf(segmented) != observations.runOf(segmented - 1)) {
      append(segmenter.finish());
    }
    append(segmenter.add(observations[segmented]));
  }
  regions.insert(regions.end(), fresh.begin(), fresh.end());
  return fresh;
}

SlamServer::SlamServer(ros::NodeHandle nh, const ros::NodeHandle& private_nh)
    : log_name_(hyselam::logName(private_nh)),
      params_(hyselam::loadAndLogParams(private_nh, loadSlamParams)),
      initial_pose_(params_.initialPose()),
      status_rate_(kStatusRate),
      map_rate_(drawsMaps() ? 1.0 / params_.map_update_interval : -1.0),
      publisher_(nh) {
  mapping_ = std::make_unique<Mapping>(params_, storedState());
  if (!mapping_->engine.keyframes().empty()) next_scan_ = NextScan::kAfterPause;
  map_due_ = drawsMaps() && !mapping_->engine.keyframes().empty();

  advertiseServices(nh, private_nh);
  input_ = std::make_unique<hyselam::ScanInput>(
      nh, params_.input, log_name_,
      [this](const hyselam::LaserScan& scan, const Pose2& base_in_odom, const ros::Time& stamp) {
        return onScan(scan, base_in_odom, stamp);
      },
      [this] { onTimeJump(); });
  input_->holdWhile([this](const ros::Time& stamp) { return isHeldUp(stamp); });
  initial_pose_subscriber_ = nh.subscribe("initialpose", 2, &SlamServer::onInitialPose, this);
  if (params_.tf_broadcast && params_.transform_publish_period > 0.0) {
    broadcaster_.timer = nh.createWallTimer(ros::WallDuration(params_.transform_publish_period),
                                            [this](const ros::WallTimerEvent&) {
                                              if (!broadcaster_.last.isZero())
                                                broadcast(ros::Time::now());
                                            });
  }
  diagnostics_ = std::make_unique<hyselam::Diagnostics>(
      nh, private_nh.getNamespace().substr(1) + ": SLAM", params_.diagnostic_period,
      [this](diagnostic_msgs::DiagnosticStatus& status) { report(status); });
  services_.spinner = std::make_unique<ros::AsyncSpinner>(1, &services_.queue);
  services_.spinner->start();
  job_thread_ = std::thread([this] { runJobs(); });
  map_thread_ = std::thread([this] { runMapper(); });
}

/// What is stored; an empty state where nothing is, or nothing that can be used: then SLAM begins
/// anew, as a robot whose map is broken has to drive all the same.
SlamState SlamServer::storedState() {
  if (params_.state.empty() || !hyselam::mayExist(params_.state)) return {};
  try {
    SlamState state = consolidated(SlamStateFile::load(params_.state, params_.slam.surface),
                                   params_.slam.consolidation);
    ROS_INFO_STREAM(log_name_ << " goes on with " << params_.state << ": " << state.keyframes.size()
                              << " keyframes, " << state.loops.size() << " loops");
    return state;
  } catch (const hyselam::InputError& e) {
    const auto aside = hyselam::putAside(params_.state);
    ROS_ERROR_STREAM(log_name_ << " begins a new map: " << e.what() << hyselam::keptAs(aside));
    if (aside) {
      status_.put_aside =
          "a new map was begun, the one before is kept as " + *aside + ": " + e.what();
    } else {  // then nothing is written over it
      status_.save_error = e.what();
      params_.state.clear();
    }
    return {};
  }
}

SlamServer::~SlamServer() {
  // No scan comes any more: what is saved is all.
  diagnostics_.reset();
  initial_pose_subscriber_.shutdown();
  input_.reset();
  services_.spinner->stop();
  {
    const Lock lock(mutex_);
    ending_ = true;
  }
  work_.notify_all();
  job_thread_.join();
  map_thread_.join();
  broadcaster_.timer.stop();
  {
    const Lock lock(mutex_);
    takeInNow();
  }
  saveIfChanged("at the end");
}

// ---- scans

bool SlamServer::onScan(const hyselam::LaserScan& scan, const Pose2& base_in_odom,
                        const ros::Time& stamp) {
  const ros::WallTime begin = ros::WallTime::now();
  {
    const Lock lock(mutex_);
    if (paused_) {
      ++status_.paused_scans;
      return false;
    }
    last_scan_came_ = begin;
    takeIn(scan.stamp);
    addScan(scan, base_in_odom);
    mapping_->jobs.noteScan(scan.stamp, &mapping_->engine);
    if (later_scans_) later_scans_->push_back({scan, base_in_odom});
    last_scan_ = {stamp, base_in_odom};
    publishStatus();
    publishNewWords();
    publishNewRegions();
    if (drawsMaps() && map_rate_.pass(stamp)) map_due_ = true;
    status_.scan_ms = millisecondsSince(begin);
    status_.max_scan_ms = std::max(status_.max_scan_ms, status_.scan_ms);
  }
  work_.notify_all();
  if (params_.tf_broadcast) broadcast(stamp);
  return true;
}

/// With mutex_ held. @throws hyselam::InputError for a scan that is refused.
void SlamServer::addScan(const hyselam::LaserScan& scan, const Pose2& base_in_odom) {
  try {
    if (initial_pose_ || next_scan_ != NextScan::kGoesOn) startRun(base_in_odom);
    const SlamUpdate update = mapping_->engine.add(scan, base_in_odom);
    if (update.odometry_jump) {
      ROS_WARN_STREAM(log_name_ << " the odometry jumped; the robot is taken to stand");
    }
    status_.weak_matches += update.weak_match ? 1 : 0;
    mapping_->localized = true;
  } catch (const hyselam::InputError&) {
    throw;
  } catch (const std::exception& e) {
    throw hyselam::InputError("scan", std::to_string(scan.stamp) + " s", e.what());
  }
}

/// Where the next scan begins a run, more or less. With mutex_ held.
SlamServer::RunStart SlamServer::runStart(const Pose2& base_in_odom) const {
  const SlamEngine& engine = mapping_->engine;
  RunStart start{engine.pose(), params_.start_window, params_.start_angle, RunTrust::kSupposed};
  // Odometry that went on is better than a search that one scan decides.
  const auto startByOdometry = [&](const Pose2& guess, double driven) {
    start.base_in_map = guess;
    start.window = std::min(start.window, kOdometryWindow + kOdometryDrift * driven);
    start.angle = std::min(start.angle, kOdometryWindow + kOdometryDrift * driven);
  };
  if (initial_pose_) {
    const Pose2& stddev = initial_pose_->stddev;
    start.base_in_map = initial_pose_->base_in_map;
    start.window = std::min(SlamEngine::kMaxStartWindow,
                            std::max(start.window, 2.0 * std::max(stddev.x, stddev.y)));
    start.angle = std::min(hyselam::kPi, std::max(start.angle, 2.0 * stddev.theta));
  } else if (engine.keyframes().empty()) {
    return start;
  } else if (next_scan_ == NextScan::kAfterJump) {
    start.base_in_map = placeByOdometry(engine.keyframes(), base_in_odom);
  } else if (mapping_->localized) {  // paused: it may have been driven meanwhile
    if (engine.runPlace() != RunPlace::kSupposed) start.trust = RunTrust::kKnown;
    startByOdometry(engine.odomInMap() * base_in_odom, distance(last_scan_.odometry, base_in_odom));
  } else {
    // A state was loaded. Where odometry is still near to what it was then, it was not interrupted.
    const SlamKeyframe& last = engine.keyframes().back();
    const Pose2 driven = between(last.odometry, base_in_odom);
    const double distance_driven = std::hypot(driven.x, driven.y);
    if (distance_driven <= params_.start_window && std::abs(driven.theta) <= params_.start_angle) {
      startByOdometry(last.pose * driven, distance_driven);
    }
  }
  return start;
}

/// With mutex_ held.
void SlamServer::startRun(const Pose2& base_in_odom) {
  later_scans_.reset();
  SlamEngine& engine = mapping_->engine;
  if (!engine.keyframes().empty() || initial_pose_) {
    const RunStart start = runStart(base_in_odom);
    const Pose2& at = start.base_in_map;
    ROS_INFO_STREAM(log_name_ << " a run begins at x " << at.x << " m, y " << at.y << " m, "
                              << hyselam::degrees(at.theta) << " deg, "
                              << (start.trust == RunTrust::kKnown
                                      ? "where odometry says"
                                      : "supposedly: to be confirmed by what it sees"));
    engine.startRun(at, start.window, start.angle, start.trust);
  }
  initial_pose_.reset();
  next_scan_ = NextScan::kGoesOn;
}

void SlamServer::onTimeJump() {
  const Lock lock(mutex_);
  mapping_->engine.endRun();
  later_scans_.reset();
  result_wait_.forget();
  next_scan_ = NextScan::kAfterJump;
  broadcaster_.last = ros::Time();
}

void SlamServer::onInitialPose(const geometry_msgs::PoseWithCovarianceStamped::ConstPtr& msg) {
  const auto pose = hyselam::initialPoseNow(
      *msg, params_.global_frame_id, initial_pose_subscriber_.getTopic(), *input_, log_name_);
  if (!pose) return;
  const Lock lock(mutex_);
  initial_pose_ = pose;
}

void SlamServer::broadcast(const ros::Time& stamp) {
  const ros::Time dated = stamp + ros::Duration(params_.transform_tolerance);
  geometry_msgs::TransformStamped transform;
  {
    const Lock lock(mutex_);
    if (!mapping_->localized || dated <= broadcaster_.last) return;
    broadcaster_.last = dated;
    transform.transform = hyselam::toTransformMsg(mapping_->engine.odomInMap());
  }
  transform.header.stamp = dated;
  transform.header.frame_id = params_.global_frame_id;
  transform.child_frame_id = params_.input.odom_frame_id;
  broadcaster_.tf.sendTransform(transform);
}

std_msgs::Header SlamServer::header(const std::string& frame) const {
  std_msgs::Header h;
  h.stamp = last_scan_.stamp;
  h.frame_id = frame;
  return h;
}

/// When it changed, and once a second. With mutex_ held.
void SlamServer::publishStatus() {
  const auto place = std::make_pair(mapping_->engine.runPlace(), mapping_->engine.tiesWithdrawn());
  const bool due = status_rate_.pass(last_scan_.stamp);
  if (place == published_place_ && !due) return;
  published_place_ = place;
  publisher_.publishStatus(
      statusMsg(mapping_->engine, status_.scan_ms, header(params_.global_frame_id)));
}

/// Words and matches that are new, or all of them when the classes have changed. With mutex_ held.
void SlamServer::publishNewWords() {
  Mapping& m = *mapping_;
  const NgramRecognizer& recognizer = m.engine.recognizer();
  const bool replace = recognizer.requantisations() != m.requantizations;
  m.requantizations = recognizer.requantisations();
  if (replace) m.published_words = m.published_matches = 0;
  m.published_matches = std::min(m.published_matches, m.engine.matches().size());
  const std::size_t words = recognizer.text().words();
  if (words <= m.published_words && !replace) return;
  hyselam_msgs::WordArray word_array;
  word_array.header = header(params_.input.odom_frame_id);
  word_array.replaces_previous = replace;
  for (; m.published_words < words; ++m.published_words) {
    word_array.words.push_back(wordMsg(recognizer, static_cast<WordIndex>(m.published_words)));
  }
  hyselam_msgs::WordMatchArray match_array;
  match_array.header = word_array.header;
  match_array.replaces_previous = replace;
  for (; m.published_matches < m.engine.matches().size(); ++m.published_matches) {
    match_array.matches.push_back(matchMsg(recognizer, m.engine.matches()[m.published_matches]));
  }
  publisher_.publishWords(word_array, match_array);
}

/// With mutex_ held.
void SlamServer::publishNewRegions() {
  const std::vector<SemanticRegion> regions = mapping_->segmentNew();
  if (regions.empty()) return;
  hyselam_msgs::SemanticRegionArray msg;
  msg.header = header(params_.input.odom_frame_id);
  for (const SemanticRegion& region : regions) {
    msg.regions.push_back(regionMsg(mapping_->engine.recognizer().observations(), region,
                                    params_.slam.observations.step));
  }
  publisher_.publishRegions(msg);
}

}  // namespace ngram_slam
