#include "fsd_localization/ros/fsd_server.hpp"

#include <cmath>

#include "fsd_localization/ros/conversions.hpp"
#include "hyselam_common/ros/conversions.hpp"
#include "hyselam_common/ros/server_setup.hpp"

namespace fsd_localization {

using hyselam::addRemark;
using hyselam::addValue;

FsdServer::FsdServer(ros::NodeHandle nh, const ros::NodeHandle& private_nh)
    : params_(hyselam::loadAndLogParams(private_nh, loadFsdParams)),
      sensor_(params_.sensor),
      gui_rate_(params_.gui_publish_rate),
      observation_publisher_(nh.advertise<hyselam_msgs::FsdObservation>("fsd_observation", 100)),
      local_map_publisher_(nh.advertise<nav_msgs::OccupancyGrid>("local_map", 1)),
      marker_publisher_(nh.advertise<visualization_msgs::MarkerArray>("fsd_markers", 1)),
      input_(
          nh, params_.input, hyselam::logName(private_nh),
          [this](const hyselam::LaserScan& scan, const hyselam::Pose2& base_in_odom,
                 const ros::Time& stamp) { return onScan(scan, base_in_odom, stamp); },
          [this] { onTimeJump(); }),
      diagnostics_(nh, private_nh.getNamespace().substr(1) + ": free-space density",
                   params_.diagnostic_period,
                   [this](diagnostic_msgs::DiagnosticStatus& status) { report(status); }) {}

bool FsdServer::onScan(const hyselam::LaserScan& scan, const hyselam::Pose2& base_in_odom,
                       const ros::Time& stamp) {
  const ros::WallTime begin = ros::WallTime::now();
  sensor_.integrate(scan, base_in_odom);
  if (last_odom_) travelled_ += hyselam::distance(*last_odom_, base_in_odom);
  last_odom_ = base_in_odom;
  if (observed_odom_) {
    const hyselam::Pose2 moved = hyselam::between(*observed_odom_, base_in_odom);
    const bool far = std::hypot(moved.x, moved.y) >= params_.update_min_d;
    const bool turned = params_.update_min_a > 0.0 && std::abs(moved.theta) >= params_.update_min_a;
    if (!far && !turned) return true;
  }
  observed_odom_ = base_in_odom;
  std_msgs::Header header;
  header.stamp = stamp;
  header.frame_id = params_.input.odom_frame_id;
  const FsdObservation observation = sensor_.observe();
  observation_publisher_.publish(toMsg(observation, params_.sensor.kernels, header, travelled_));
  ++observations_;
  observe_ms_ = 1e3 * (ros::WallTime::now() - begin).toSec();
  if (gui_rate_.pass(stamp)) show(observation, header);
  return true;
}

void FsdServer::show(const FsdObservation& observation, const std_msgs::Header& header) {
  if (local_map_publisher_.getNumSubscribers() > 0) {
    local_map_publisher_.publish(
        hyselam::toMsg(sensor_.localMap().toGrid(), header.frame_id, header.stamp));
  }
  if (marker_publisher_.getNumSubscribers() > 0) {
    marker_publisher_.publish(kernelMarkers(observation, params_.sensor.kernels, header));
  }
}

void FsdServer::onTimeJump() {
  sensor_.reset();
  last_odom_.reset();
  observed_odom_.reset();
  travelled_ = 0.0;
}

void FsdServer::report(diagnostic_msgs::DiagnosticStatus& status) {
  input_.checkClock();
  addRemark(status, diagnostic_msgs::DiagnosticStatus::OK,
            std::to_string(observations_) + " observations");
  addValue(status, "observations", observations_);
  addValue(status, "travelled [m]", travelled_);
  addValue(status, "last observation [ms]", observe_ms_);
  input_.report(status);
}

}  // namespace fsd_localization
