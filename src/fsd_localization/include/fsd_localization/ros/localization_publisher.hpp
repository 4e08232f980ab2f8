// Everything that the localisation publishes.
#pragma once

#include <hyselam_msgs/LocalizationStatus.h>
#include <ros/ros.h>
#include <tf2_ros/transform_broadcaster.h>

#include "fsd_localization/localizer.hpp"
#include "fsd_localization/ros/parameters.hpp"
#include "hyselam_common/ros/rate_limit.hpp"

namespace fsd_localization {

class LocalizationPublisher {
 public:
  LocalizationPublisher(ros::NodeHandle nh, const LocalizationServerParams& params);

  /// What may change while it runs: rates, tolerances, the cloud's size.
  void setParams(const LocalizationServerParams& params);
  /// `density_field`, latched, when a map is ready.
  void publishMap(const Localizer& localizer);
  /// `amcl_pose` and `localization_status` at each update; `particlecloud`, `local_map`,
  /// `fsd_markers` and `short_term_markers` only while someone listens, and not more often than
  /// gui_publish_rate.
  void publishUpdate(const Localizer& localizer, const LocalizationResult& result, double update_ms,
                     const ros::Time& stamp);
  /// Whether somebody listens to `local_map`.
  bool showsLocalMap() const { return local_map_.getNumSubscribers() > 0; }
  /// `localization_status` without an update: not localized, with the reason.
  void publishUnknown(const std::string& text, std::size_t particles);
  /// tf global frame -> odom, valid from `stamp` + transform_tolerance.
  void broadcast(const hyselam::Pose2& odom_in_map, const ros::Time& stamp);

 private:
  void show(const Localizer& localizer, const LocalizationResult& result,
            const std_msgs::Header& in_map);
  std_msgs::Header header(const ros::Time& stamp, const std::string& frame) const;

  LocalizationServerParams params_;
  hyselam::RateLimit gui_rate_;
  bool markers_shown_ = false;
  ros::Publisher pose_, status_, cloud_, density_field_, local_map_, markers_, short_term_;
  tf2_ros::TransformBroadcaster tf_;
};

}  // namespace fsd_localization
