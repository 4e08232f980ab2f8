#include "selovis/ros/pose_supervision.hpp"

#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <std_msgs/Bool.h>
#include <std_srvs/Empty.h>

#include <algorithm>
#include <chrono>
#include <sstream>
#include <utility>

#include "hyselam_common/ros/conversions.hpp"
#include "hyselam_common/ros/diagnostics.hpp"

namespace selovis {
namespace {

constexpr double kArrival = 1.0;  // [s] from setting a pose to the localisation's answer, at most

}  // namespace

PoseSupervision::PoseSupervision(ros::NodeHandle nh, ros::NodeHandle private_nh,
                                 const SemanticLocalizationParams& params, std::string who)
    : params_(params),
      who_(std::move(who)),
      kidnapped_publisher_(private_nh.advertise<std_msgs::Bool>("kidnapped", 10, true)),
      initialpose_publisher_(
          nh.advertise<geometry_msgs::PoseWithCovarianceStamped>("initialpose", 1)),
      global_localization_(nh.serviceClient<std_srvs::Empty>("global_localization")) {
  status_subscriber_ = nh.subscribe<hyselam_msgs::LocalizationStatus>(
      "localization_status", 10,
      [this](const hyselam_msgs::LocalizationStatus::ConstPtr& status) { status_ = status; });
  publishKidnapped();
}

void PoseSupervision::setGraph(const PlaceGraph& graph) {
  graph_ = graph;
  supervisor_ =
      graph.places.empty() ? nullptr : std::make_unique<Supervisor>(graph, params_.supervisor);
  last_ = Supervision();
  to_act_ = by_laser_ = false;
  publishKidnapped();
}

void PoseSupervision::heedLost(const ros::Time& stamp) {
  const bool lost = params_.on_kidnap == OnKidnap::kPlace && status_ &&
                    status_->phase == hyselam_msgs::LocalizationStatus::LOST &&
                    (status_->header.stamp - stamp).toSec() < 1.0;  // else time went back
  if (by_laser_ && !lost) {
    // It has found itself, or was told from elsewhere: a place would only disturb it now.
    by_laser_ = to_act_ = false;
    supervisor_->reset();
    last_ = Supervision();
    return;
  }
  if (!lost || to_act_) return;
  // What was set needs a moment to arrive.
  if (set_at_ &&
      (status_->header.stamp - *set_at_).toSec() < std::max(kArrival, params_.patience)) {
    return;
  }
  supervisor_->doubt();
  by_laser_ = to_act_ = true;
  alarm_at_ = stamp;
  ++lost_;
  last_alarm_ = "the localisation says that it is lost";
  ROS_WARN_STREAM(who_ << " " << last_alarm_ << ": looking for the place");
}

bool PoseSupervision::poseIsMeant(const ros::Time& stamp) {
  // Part 1 says itself whether its pose deserves trust. Others, amcl among them, do not: after the
  // pose was set they get time to find it.
  if (status_) {
    if (!status_->converged) return false;
    if (set_at_ && status_->header.stamp <= *set_at_) return false;
  } else if (set_at_ && stamp >= *set_at_ && (stamp - *set_at_).toSec() < params_.settle) {
    return false;
  }
  if (set_at_) {
    // From now on the new pose is judged.
    set_at_.reset();
    if (supervisor_) supervisor_->reset();
  }
  return true;
}

void PoseSupervision::judge(const std::vector<double>& frame,
                            const std::optional<hyselam::Pose2>& pose,
                            const hyselam_topo::AugmentedTopologicalMap& map,
                            const ros::Time& stamp) {
  if (!supervisor_) return;
  tellSearch();
  if (set_at_ && (*set_at_ - stamp).toSec() > 1.0) set_at_.reset();  // time went back
  heedLost(stamp);
  expected_ = ExpectedPlaces();
  if (pose && poseIsMeant(stamp)) {
    expected_ = expectedPlaces(map, graph_, {pose->x, pose->y}, params_.reach);
  }
  const bool was = last_.kidnapped;
  last_ = supervisor_->update(frame, expected_.agree, expected_.unmapped);
  judged_ += last_.judged;
  if (last_.alarm) {
    ++alarms_;
    alarm_at_ = stamp;
    to_act_ = params_.on_kidnap != OnKidnap::kNothing;
    by_laser_ = false;
    std::ostringstream text;
    text << "the pose lies in '" << expected_.own << "', but the camera sees "
         << (last_.place >= 0 ? "'" + graph_.places[static_cast<std::size_t>(last_.place)] + "'"
                              : std::string("another place"));
    last_alarm_ = text.str();
    ROS_WARN_STREAM(who_ << " kidnapped or diverged: " << last_alarm_);
  } else if (was && !last_.kidnapped) {
    ROS_INFO_STREAM(who_ << " the pose and the place seen agree again");
  }
  if (!last_.kidnapped) to_act_ = by_laser_ = false;
  publishKidnapped();
  if (to_act_) act(map, stamp);
}

void PoseSupervision::act(const hyselam_topo::AugmentedTopologicalMap& map,
                          const ros::Time& stamp) {
  if (params_.on_kidnap == OnKidnap::kPlace) {
    const auto spread = last_.place >= 0
                            ? spreadOf(map, graph_.places[static_cast<std::size_t>(last_.place)])
                            : std::optional<PlaceSpread>();
    if (!spread && by_laser_) return;  // it searches the whole map by itself
    if (!spread && (stamp - alarm_at_).toSec() < params_.patience) return;  // it may become known
    if (spread) {
      geometry_msgs::PoseWithCovarianceStamped msg;
      msg.header.stamp = stamp;
      msg.header.frame_id = map.frame_id;
      msg.pose.pose = hyselam::toPoseMsg(spread->mean);
      msg.pose.covariance[0] = spread->stddev.x * spread->stddev.x;
      msg.pose.covariance[7] = spread->stddev.y * spread->stddev.y;
      msg.pose.covariance[35] = spread->stddev.theta * spread->stddev.theta;
      initialpose_publisher_.publish(msg);
      ++poses_set_;
      ROS_INFO_STREAM(who_ << " localisation begins again in '"
                           << graph_.places[static_cast<std::size_t>(last_.place)] << "'");
    } else {
      searchEverywhere();
    }
  } else {
    searchEverywhere();
  }
  to_act_ = by_laser_ = false;
  set_at_ = stamp;
}

void PoseSupervision::searchEverywhere() {
  tellSearch();
  if (search_.valid()) return;  // the last one has not been answered
  ++searches_;
  search_ = std::async(std::launch::async, [client = global_localization_]() mutable {
    std_srvs::Empty empty;
    return client.call(empty);
  });
}

void PoseSupervision::tellSearch() {
  if (!search_.valid() || search_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) {
    return;
  }
  if (search_.get()) {
    ROS_INFO_STREAM(who_ << " localisation begins again on the whole map");
  } else {
    ROS_WARN_STREAM(who_ << " the service " << global_localization_.getService()
                         << " does not answer");
  }
}

void PoseSupervision::publishKidnapped() {
  if (published_ && *published_ == last_.kidnapped) return;
  published_ = last_.kidnapped;
  std_msgs::Bool msg;
  msg.data = last_.kidnapped;
  kidnapped_publisher_.publish(msg);
}

void PoseSupervision::report(diagnostic_msgs::DiagnosticStatus& status) const {
  using hyselam::addRemark;
  using hyselam::addValue;
  if (last_.kidnapped) {
    addRemark(status, diagnostic_msgs::DiagnosticStatus::WARN,
              "kidnapped or diverged: " + last_alarm_);
  }
  addValue(status, "pose judged", last_.judged);
  addValue(status, "pose lies in", expected_.own);
  addValue(status, "evidence against the pose [nats]", last_.evidence);
  addValue(status, "kidnapped", last_.kidnapped);
  addValue(status, "frames judged", judged_);
  addValue(status, "alarms", alarms_);
  addValue(status, "localisation lost", lost_);
  addValue(status, "poses set", poses_set_);
  addValue(status, "global localisations", searches_);
  addValue(status, "last alarm", last_alarm_);
}

}  // namespace selovis
