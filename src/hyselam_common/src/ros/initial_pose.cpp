#include "hyselam_common/ros/initial_pose.hpp"

#include <cmath>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/ros/conversions.hpp"

namespace hyselam {

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

}  // namespace hyselam
