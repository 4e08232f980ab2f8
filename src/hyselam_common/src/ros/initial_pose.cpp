#include "hyselam_common/ros/initial_pose.hpp"

#include <cmath>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/ros/conversions.hpp"

namespace hyselam {

void InitialPoseParams::describe(ParameterVisitor& visit) {
  constexpr double kFarthest = 1e8;
  const Range finite = Range::between(-kFarthest, kFarthest);
  const Range variance = Range::aboveUpTo(0.0, kFarthest);
  visit("initial_pose_x", x, finite, "m",
        "where the robot starts; if none of the three is set, it starts lost");
  visit("initial_pose_y", y, finite, "m", "");
  visit("initial_pose_a", a, finite, "rad", "");
  visit("initial_cov_xx", cov_xx, variance, "m^2", "variance of initial_pose_x");
  visit("initial_cov_yy", cov_yy, variance, "m^2", "variance of initial_pose_y");
  visit("initial_cov_aa", cov_aa, variance, "rad^2", "variance of initial_pose_a");
}

std::optional<InitialPose> InitialPoseParams::pose() const {
  if (!x && !y && !a) return std::nullopt;
  return InitialPose{{x.value_or(0.0), y.value_or(0.0), normalizeAngle(a.value_or(0.0))},
                     {std::sqrt(cov_xx), std::sqrt(cov_yy), std::sqrt(cov_aa)}};
}

InitialPose initialPoseFromMsg(const geometry_msgs::PoseWithCovarianceStamped& msg,
                               const std::string& global_frame, const std::string& source) {
  std::string frame = msg.header.frame_id;
  if (!frame.empty() && frame[0] == '/') frame.erase(0, 1);
  if (!frame.empty() && frame != global_frame) {
    throw InputError(source, "frame_id", "is '" + frame + "', but must be '" + global_frame + "'");
  }
  InitialPose pose;
  pose.base_in_map = fromMsg(msg.pose.pose, source);
  // Of the 6 x 6 covariance over x, y, z, roll, pitch, yaw.
  const auto deviation = [&](std::size_t element, const std::string& of) {
    const double variance = msg.pose.covariance[element];
    if (!std::isfinite(variance) || !(variance > 0.0)) {
      throw InputError(
          source, "covariance of " + of,
          "is " + std::to_string(variance) + ", but must be > 0: say how sure the guess is");
    }
    return std::sqrt(variance);
  };
  pose.stddev = {deviation(0, "x"), deviation(7, "y"), deviation(35, "yaw")};
  return pose;
}

std::optional<InitialPose> initialPoseNow(const geometry_msgs::PoseWithCovarianceStamped& msg,
                                          const std::string& global_frame,
                                          const std::string& source, const ScanInput& input,
                                          const std::string& log_name) {
  InitialPose pose;
  try {
    pose = initialPoseFromMsg(msg, global_frame, source);
  } catch (const InputError& e) {
    ROS_ERROR_STREAM(log_name << " initial pose ignored: " << e.what());
    return std::nullopt;
  }
  if (!msg.header.stamp.isZero()) {
    if (const auto motion = input.motionSince(msg.header.stamp)) {
      pose.base_in_map = pose.base_in_map * *motion;
    }
  }
  return pose;
}

}  // namespace hyselam
