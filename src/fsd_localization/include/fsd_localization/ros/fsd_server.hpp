// Free-space density of a live laser: scan and odometry in, observations out.
#pragma once

#include <ros/ros.h>

#include "fsd_localization/density/fsd_sensor.hpp"
#include "fsd_localization/ros/parameters.hpp"
#include "hyselam_common/ros/diagnostics.hpp"
#include "hyselam_common/ros/rate_limit.hpp"
#include "hyselam_common/ros/scan_input.hpp"

namespace fsd_localization {

/// Topics: in `scan` and tf; out `fsd_observation`, `local_map`, `fsd_markers` (the last two only
/// while someone listens), /diagnostics. All callbacks on the queue of `nh`, one at a time.
class FsdServer {
 public:
  /// Reads and checks the parameters of `private_nh`, before anything is subscribed.
  /// @throws hyselam::ParameterError.
  FsdServer(ros::NodeHandle nh, const ros::NodeHandle& private_nh);

 private:
  bool onScan(const hyselam::LaserScan& scan, const hyselam::Pose2& base_in_odom,
              const ros::Time& stamp);
  void onTimeJump();
  void show(const FsdObservation& observation, const std_msgs::Header& header);
  void report(diagnostic_msgs::DiagnosticStatus& status);

  FsdServerParams params_;
  FsdSensor sensor_;
  std::optional<hyselam::Pose2> last_odom_;      // of the last scan
  std::optional<hyselam::Pose2> observed_odom_;  // of the last observation
  double travelled_ = 0.0;
  std::size_t observations_ = 0;
  double observe_ms_ = 0.0;
  hyselam::RateLimit gui_rate_;
  ros::Publisher observation_publisher_, local_map_publisher_, marker_publisher_;
  hyselam::ScanInput input_;
  hyselam::Diagnostics diagnostics_;
};

}  // namespace fsd_localization
