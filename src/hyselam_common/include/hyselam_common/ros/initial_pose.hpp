// A pose of the robot that a person or a program gives (topic `initialpose`, parameters), checked.
#pragma once

#include <geometry_msgs/PoseWithCovarianceStamped.h>

#include <optional>
#include <string>

#include "hyselam_common/parameters.hpp"
#include "hyselam_common/pose2.hpp"
#include "hyselam_common/ros/scan_input.hpp"

namespace hyselam {

/// Base in the map frame with standard deviations [m, m, rad].
struct InitialPose {
  Pose2 base_in_map;
  Pose2 stddev;
};

/// The pose at the start, as amcl has it.
struct InitialPoseParams {
  std::optional<double> x, y, a;  ///< [m, m, rad]; none: the robot knows nothing at the start
  double cov_xx = 0.25;           ///< [m^2]
  double cov_yy = 0.25;           ///< [m^2]
  double cov_aa = (kPi / 12.0) * (kPi / 12.0);  ///< [rad^2]

  /// initial_pose_x, _y, _a and initial_cov_xx, _yy, _aa.
  void describe(ParameterVisitor& visit);
  /// Empty where none of x, y and a is set; the others are 0 then.
  std::optional<InitialPose> pose() const;
};

/// @param source begins the text of the error (a topic, a service).
/// @throws InputError for: another frame than `global_frame` (none at all is taken as it), a
///   position or orientation that is not finite, a quaternion without direction, variances of x, y
///   or yaw that are not finite and > 0.
InitialPose initialPoseFromMsg(const geometry_msgs::PoseWithCovarianceStamped& msg,
                               const std::string& global_frame, const std::string& source);

/// The same at this moment: the robot may have moved on while a person pointed at the map. Nothing
/// where it is refused, which is logged.
std::optional<InitialPose> initialPoseNow(const geometry_msgs::PoseWithCovarianceStamped& msg,
                                          const std::string& global_frame,
                                          const std::string& source, const ScanInput& input,
                                          const std::string& log_name);

}  // namespace hyselam
