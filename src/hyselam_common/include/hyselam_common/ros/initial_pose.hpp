// A pose of the robot that a person or a program gives (topic `initialpose`, parameters), checked.
#pragma once

#include <geometry_msgs/PoseWithCovarianceStamped.h>

#include <string>

#include "hyselam_common/pose2.hpp"

namespace hyselam {

/// Base in the map frame with standard deviations [m, m, rad].
struct InitialPose {
  Pose2 base_in_map;
  Pose2 stddev;
};

/// @param source begins the text of the error (a topic, a service).
/// @throws InputError for: another frame than `global_frame` (none at all is taken as it), a
///   position or orientation that is not finite, a quaternion without direction, variances of x, y
///   or yaw that are not finite and > 0.
InitialPose initialPoseFromMsg(const geometry_msgs::PoseWithCovarianceStamped& msg,
                               const std::string& global_frame, const std::string& source);

}  // namespace hyselam
