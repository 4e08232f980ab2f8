#include "fsd_localization/ros/localization_publisher.hpp"

#include <limits>

#include "fsd_localization/ros/conversions.hpp"
#include "hyselam_common/ros/conversions.hpp"

namespace fsd_localization {

LocalizationPublisher::LocalizationPublisher(ros::NodeHandle nh,
                                             const LocalizationServerParams& params)
    : params_(params),
      gui_rate_(params.gui_publish_rate),
      pose_(nh.advertise<geometry_msgs::PoseWithCovarianceStamped>("amcl_pose", 10, true)),
      status_(nh.advertise<hyselam_msgs::LocalizationStatus>("localization_status", 10, true)),
      cloud_(nh.advertise<geometry_msgs::PoseArray>("particlecloud", 2)),
      local_map_(nh.advertise<nav_msgs::OccupancyGrid>("local_map", 1)),
      markers_(nh.advertise<visualization_msgs::MarkerArray>("fsd_markers", 1)),
      short_term_(nh.advertise<visualization_msgs::Marker>("short_term_markers", 1)) {
  if (params_.density_field_kernel >= 0) {
    density_field_ = nh.advertise<nav_msgs::OccupancyGrid>("density_field", 1, true);
  }
}

void LocalizationPublisher::setParams(const LocalizationServerParams& params) {
  if (params.gui_publish_rate != params_.gui_publish_rate) {
    gui_rate_ = hyselam::RateLimit(params.gui_publish_rate);
  }
  params_ = params;
}

std_msgs::Header LocalizationPublisher::header(const ros::Time& stamp,
                                               const std::string& frame) const {
  std_msgs::Header h;
  h.stamp = stamp;
  h.frame_id = frame;
  return h;
}

void LocalizationPublisher::publishMap(const Localizer& localizer) {
  if (params_.density_field_kernel < 0) return;
  density_field_.publish(densityFieldMsg(localizer.map(), params_.density_field_kernel,
                                         header(ros::Time::now(), params_.global_frame_id)));
}

void LocalizationPublisher::publishUpdate(const Localizer& localizer,
                                          const LocalizationResult& result, double update_ms,
                                          const ros::Time& stamp) {
  const std_msgs::Header in_map = header(stamp, params_.global_frame_id);
  pose_.publish(toMsg(result, localizer, in_map));
  status_.publish(toStatusMsg(result, update_ms, in_map));
  if (gui_rate_.pass(stamp)) show(localizer, result, in_map);
}

void LocalizationPublisher::show(const Localizer& localizer, const LocalizationResult& result,
                                 const std_msgs::Header& in_map) {
  const std_msgs::Header in_odom = header(in_map.stamp, params_.input.odom_frame_id);
  if (cloud_.getNumSubscribers() > 0) {
    cloud_.publish(toMsg(localizer.particles(),
                         static_cast<std::size_t>(params_.max_cloud_particles),
                         localizer.map().geometry().origin, in_map));
  }
  if (showsLocalMap() && localizer.keepsLocalMap()) {  // of who has just come, from the next on
    local_map_.publish(
        hyselam::toMsg(localizer.localMap().toGrid(), in_odom.frame_id, in_odom.stamp));
  }
  if (short_term_.getNumSubscribers() > 0) {
    short_term_.publish(shortTermMarker(localizer.shortTermPoints(result.base_in_map), in_map));
  }
  const FsdObservation& seen = localizer.lastObservation();
  // Once is enough to take the discs away where the model of the moment reads no densities.
  if (markers_.getNumSubscribers() > 0 && (markers_shown_ || !seen.readings.empty())) {
    markers_.publish(kernelMarkers(seen, localizer.params().map.kernels, in_odom));
    markers_shown_ = !seen.readings.empty();
  }
}

void LocalizationPublisher::publishUnknown(const std::string& text, std::size_t particles) {
  hyselam_msgs::LocalizationStatus status;
  status.header = header(ros::Time::now(), params_.global_frame_id);
  status.phase = hyselam_msgs::LocalizationStatus::GLOBAL;
  status.particles = static_cast<std::uint32_t>(particles);
  status.match_quality = std::numeric_limits<float>::quiet_NaN();
  status.text = text;
  status_.publish(status);
}

void LocalizationPublisher::broadcast(const hyselam::Pose2& odom_in_map, const ros::Time& stamp) {
  geometry_msgs::TransformStamped transform;
  transform.header =
      header(stamp + ros::Duration(params_.transform_tolerance), params_.global_frame_id);
  transform.child_frame_id = params_.input.odom_frame_id;
  transform.transform = hyselam::toTransformMsg(odom_in_map);
  tf_.sendTransform(transform);
}

}  // namespace fsd_localization
