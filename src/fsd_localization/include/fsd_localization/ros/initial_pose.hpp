// A guess of the pose from outside, checked.
#pragma once

#include <geometry_msgs/PoseWithCovarianceStamped.h>

#include <string>

#include "fsd_localization/ros/parameters.hpp"

namespace fsd_localization {

/// @throws hyselam::InputError, beginning with `source`, for: another frame than `global_frame`
///   (none at all is taken as it), a position or orientation that is not finite, a quaternion
///   without direction, variances of x, y or yaw that are not finite and > 0.
InitialPose fromMsg(const geometry_msgs::PoseWithCovarianceStamped& msg,
                    const std::string& global_frame, const std::string& source);

}  // namespace fsd_localization
