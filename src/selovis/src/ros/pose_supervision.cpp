#include "selovis/ros/pose_supervision.hpp"

#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <std_msgs/Bool.h>
#include <std_srvs/Empty.h>

#include <algorithm>
#include <chrono>
#include <sstream>
#include <utility>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/ros/conversions.hpp"
#include "hyselam_common/ros/diagnostics.hpp"
#include "hyselam_common/ros/transport.hpp"

namespace selovis {
namespace {

using hyselam_msgs::LocalizationStatus;

// From setting a pose to the status of the localization that takes it into account, at most.
constexpr double kMaxStatusDelay = 1.0;  // [s]
// Stamps that are later than the image by more: time went back.
constexpr double kMaxLead = 1.0;  // [s]

constexpr std::uint32_t kScanQueue = 100;
constexpr double kMaxScanAge = 0.1;  // [s] against an image
constexpr double kFirstFrame = 0.2;  // [s] that the first frame counts for

}  // namespace

PoseSupervision::PoseSupervision(ros::NodeHandle nh, ros::NodeHandle private_nh,
                                 const SupervisionParams& params, const CameraPoses& poses,
                                 std::string log_name)
    : params_(params),
      poses_(poses),
      log_name_(std::move(log_name)),
      nh_(nh),
      kidnapped_publisher_(private_nh.advertise<std_msgs::Bool>("kidnapped", 10, true)),
      initialpose_publisher_(
          nh.advertise<geometry_msgs::PoseWithCovarianceStamped>("initialpose", 1)),
      global_localization_(nh.serviceClient<std_srvs::Empty>("global_localization")) {
  status_subscriber_ = nh.subscribe<LocalizationStatus>(
      "localization_status", 10,
      [this](const LocalizationStatus::ConstPtr& status) { status_ = status; });
  publishKidnapped();
}

void PoseSupervision::subscribe() {
  if (!params_.use_scan) return;
  scan_subscriber_ = nh_.subscribe<sensor_msgs::LaserScan>(
      "scan", kScanQueue,
      [this](const sensor_msgs::LaserScan::ConstPtr& scan) { scans_.add(scan); },
      ros::VoidConstPtr(), hyselam::tcpNoDelay());
  map_subscriber_ = nh_.subscribe<nav_msgs::OccupancyGrid>(
      "map", 1, [this](const nav_msgs::OccupancyGrid::ConstPtr& map) { onMap(*map); });
}

void PoseSupervision::onMap(const nav_msgs::OccupancyGrid& msg) {
  try {
    fit_ = std::make_shared<const ScanFit>(hyselam::fromMsg(msg, "map"));
    scan_problem_.clear();
  } catch (const hyselam::InputError& e) {
    scan_problem_ = e.what();  // the map before it stays in use
    ROS_ERROR_STREAM(log_name_ << " not used: " << e.what());
    return;
  }
  if (supervisor_) supervisor_->setMap(fit_);
}

const ScanPoints* PoseSupervision::scanAt(const ros::Time& stamp) {
  const auto msg = scans_.nearest(stamp, kMaxScanAge);
  if (!fit_ || !msg) return nullptr;
  try {
    const auto laser = poses_.sensorInBase(msg->header.frame_id);
    if (!laser) return nullptr;
    hyselam::LaserScan scan = hyselam::fromMsg(*msg, "scan");
    hyselam::placeLaser(*laser, "tf", &scan);
    points_ = scanPoints(scan);
  } catch (const hyselam::InputError& e) {
    scan_problem_ = e.what();
    return nullptr;
  }
  ++counts_.scans;
  return &points_;
}

void PoseSupervision::setModel(const PlaceModel& model, const PlaceTransitions& transitions,
                               bool same_samples) {
  const ReliabilityMemory* known = same_samples ? memory() : nullptr;
  transitions_ = transitions;
  supervisor_ = transitions.places.empty() ? nullptr
                                           : std::make_unique<PoseSupervisor>(
                                                 model, transitions, params_.supervisor, known);
  if (supervisor_) supervisor_->setMap(fit_);
  last_frame_.reset();
  state_ = SupervisionState();
  pending_ = Cause::kNone;
  publishKidnapped();
}

const std::string& PoseSupervision::placeName() const {
  return transitions_.places[static_cast<std::size_t>(state_.place)];
}

void PoseSupervision::followLocalizationStatus(const ros::Time& stamp) {
  const bool lost = params_.on_kidnap == OnKidnap::kPlace && status_ &&
                    status_->phase == LocalizationStatus::LOST &&
                    (status_->header.stamp - stamp).toSec() < kMaxLead;
  if (pending_ == Cause::kLocalization && !lost) {
    // It has found its pose, or was given one: setting the place would only disturb it now.
    pending_ = Cause::kNone;
    supervisor_->reset();
    state_ = SupervisionState();
    return;
  }
  if (!lost || pending_ != Cause::kNone) return;
  if (set_at_ && (status_->header.stamp - *set_at_).toSec() <
                     std::max(kMaxStatusDelay, params_.relocalization_timeout)) {
    return;  // a pose that was just set is given time
  }
  supervisor_->declareLost();
  pending_ = Cause::kLocalization;
  pending_since_ = stamp;
  ++counts_.lost;
  last_alarm_ = "the localisation reports that it is lost";
  ROS_WARN_STREAM(log_name_ << " " << last_alarm_ << ": searching the place");
}

bool PoseSupervision::poseIsValid(const ros::Time& stamp) {
  // Our localization reports whether its pose is valid. Others, amcl among them, do not: after the
  // pose was set they get time to converge.
  if (status_) {
    if (!status_->converged) return false;
    if (set_at_ && status_->header.stamp <= *set_at_) return false;
  } else if (set_at_ && stamp >= *set_at_ && (stamp - *set_at_).toSec() < params_.grace_period) {
    return false;
  }
  if (set_at_) {
    // From now on the new pose is tested.
    set_at_.reset();
    if (supervisor_) supervisor_->reset();
  }
  return true;
}

void PoseSupervision::update(const ImageRecognizer& recognizer,
                             const hyselam_topo::AugmentedTopologicalMap& map,
                             const std_msgs::Header& image) {
  if (!supervisor_) return;
  const ros::Time& stamp = image.stamp;
  reportGlobalLocalization();
  if (set_at_ && (*set_at_ - stamp).toSec() > kMaxLead) set_at_.reset();
  followLocalizationStatus(stamp);
  SupervisedFrame frame;
  frame.places = &recognizer.frameProbabilities();
  frame.view.seconds = last_frame_ ? (stamp - *last_frame_).toSec() : kFirstFrame;
  last_frame_ = stamp;
  const auto pose = poses_.baseInMap(stamp);
  if (pose && poseIsValid(stamp)) {
    frame.expected =
        expectedPlaces(map, transitions_, {pose->x, pose->y}, params_.expected_place_radius);
    // Views are compared where the camera's own pose is known.
    if (const auto camera = poses_.cameraInMap(image.frame_id, stamp)) {
      frame.view.distances = recognizer.distances();
      frame.view.base = pose;
      frame.view.camera_in_base = hyselam::between(*pose, camera->pose);
      frame.view.odometry = poses_.baseInOdometry(stamp);
      frame.view.scan = scanAt(stamp);
    }
  }
  expected_ = frame.expected;
  const bool was_kidnapped = state_.kidnapped;
  state_ = supervisor_->update(frame);
  counts_.tested += state_.tested;
  counts_.by_views += state_.tested && state_.by_views;
  if (state_.alarm) {
    raiseAlarm(stamp);
  } else if (was_kidnapped && !state_.kidnapped) {
    ROS_INFO_STREAM(log_name_ << " the pose and the recognized place agree again");
  }
  if (!state_.kidnapped) pending_ = Cause::kNone;
  publishKidnapped();
  if (pending_ != Cause::kNone) relocalize(map, stamp);
}

void PoseSupervision::raiseAlarm(const ros::Time& stamp) {
  ++counts_.alarms;
  pending_since_ = stamp;
  pending_ = params_.on_kidnap == OnKidnap::kNothing ? Cause::kNone : Cause::kCamera;
  std::ostringstream text;
  text << "the pose lies in '" << expected_.own << "', but the camera sees "
       << (state_.place >= 0 ? "'" + placeName() + "'" : std::string("another place"));
  last_alarm_ = text.str();
  ROS_WARN_STREAM(log_name_ << " kidnapped or diverged: " << last_alarm_);
}

void PoseSupervision::relocalize(const hyselam_topo::AugmentedTopologicalMap& map,
                                 const ros::Time& stamp) {
  std::optional<PlacePosePrior> prior;
  if (params_.on_kidnap == OnKidnap::kPlace) {
    prior = state_.pose;
    if (!prior && state_.place >= 0) prior = posePriorOf(map, placeName());
    // A localization that is lost searches the whole map by itself; after an alarm the place may
    // still become known.
    if (!prior && (pending_ == Cause::kLocalization ||
                   (stamp - pending_since_).toSec() < params_.relocalization_timeout)) {
      return;
    }
  }
  if (prior) {
    publishInitialPose(*prior, map.frame_id, stamp);
  } else {
    startGlobalLocalization();
  }
  pending_ = Cause::kNone;
  set_at_ = stamp;
}

void PoseSupervision::publishInitialPose(const PlacePosePrior& prior, const std::string& frame_id,
                                         const ros::Time& stamp) {
  geometry_msgs::PoseWithCovarianceStamped msg;
  msg.header.stamp = stamp;
  msg.header.frame_id = frame_id;
  msg.pose.pose = hyselam::toPoseMsg(prior.mean);
  msg.pose.covariance[0] = prior.stddev.x * prior.stddev.x;
  msg.pose.covariance[7] = prior.stddev.y * prior.stddev.y;
  msg.pose.covariance[35] = prior.stddev.theta * prior.stddev.theta;
  initialpose_publisher_.publish(msg);
  ++counts_.poses_set;
  ROS_INFO_STREAM(log_name_ << " localisation begins again at (" << prior.mean.x << ", "
                            << prior.mean.y << "), in '"
                            << (state_.place >= 0 ? placeName() : std::string("?")) << "'");
}

void PoseSupervision::startGlobalLocalization() {
  reportGlobalLocalization();
  if (search_.valid()) return;  // the last call has not been answered
  ++counts_.searches;
  search_ = std::async(std::launch::async, [client = global_localization_]() mutable {
    std_srvs::Empty empty;
    return client.call(empty);
  });
}

void PoseSupervision::reportGlobalLocalization() {
  if (!search_.valid() || search_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) {
    return;
  }
  if (search_.get()) {
    ROS_INFO_STREAM(log_name_ << " localisation begins again on the whole map");
  } else {
    ROS_WARN_STREAM(log_name_ << " the service " << global_localization_.getService()
                              << " does not answer");
  }
}

void PoseSupervision::publishKidnapped() {
  if (published_ && *published_ == state_.kidnapped) return;
  published_ = state_.kidnapped;
  std_msgs::Bool msg;
  msg.data = state_.kidnapped;
  kidnapped_publisher_.publish(msg);
}

void PoseSupervision::report(diagnostic_msgs::DiagnosticStatus& status) const {
  using hyselam::addRemark;
  using hyselam::addValue;
  if (state_.kidnapped) {
    addRemark(status, diagnostic_msgs::DiagnosticStatus::WARN,
              "kidnapped or diverged: " + last_alarm_);
  }
  addValue(status, "pose tested", state_.tested);
  addValue(status, "place of the pose", expected_.own);
  addValue(status, "evidence against the pose [nats]", state_.evidence);
  addValue(status, "kidnapped", state_.kidnapped);
  addValue(status, "evidence of an alarm [nats]", supervisor_ ? supervisor_->threshold() : 0.0);
  addValue(status, "frames tested", counts_.tested);
  addValue(status, "frames tested by views", counts_.by_views);
  addValue(status, "frames tested with a scan", counts_.scans);
  addValue(status, "alarms", counts_.alarms);
  addValue(status, "localisation lost", counts_.lost);
  addValue(status, "poses set", counts_.poses_set);
  addValue(status, "global localisations", counts_.searches);
  addValue(status, "last alarm", last_alarm_);
}

}  // namespace selovis
