#include "selovis/ros/camera_poses.hpp"

#include <tf2/LinearMath/Quaternion.h>

#include <cmath>
#include <utility>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/ros/conversions.hpp"
#include "hyselam_common/ros/transport.hpp"

namespace selovis {
namespace {

constexpr double kMaxPoseAge = 0.5;  // [s] against an image

/// The optical axis, z, in the plane of the parent frame.
double headingOf(const geometry_msgs::Quaternion& r) {
  const tf2::Vector3 axis =
      tf2::quatRotate(tf2::Quaternion(r.x, r.y, r.z, r.w).normalized(), tf2::Vector3(0, 0, 1));
  return std::atan2(axis.y(), axis.x());
}

}  // namespace

CameraPoses::CameraPoses(FrameIds ids)
    : ids_(std::move(ids)), listener_(tf_, true, hyselam::tcpNoDelay()) {}

std::optional<geometry_msgs::TransformStamped> CameraPoses::lookup(const std::string& parent,
                                                                   const std::string& child,
                                                                   const ros::Time& stamp) const {
  if (parent.empty() || child.empty()) return {};
  try {
    if (tf_.canTransform(parent, child, stamp)) return tf_.lookupTransform(parent, child, stamp);
    const auto newest = tf_.lookupTransform(parent, child, ros::Time(0));
    if (!newest.header.stamp.isZero() &&
        std::abs((newest.header.stamp - stamp).toSec()) > kMaxPoseAge) {
      return {};
    }
    return newest;
  } catch (const tf2::TransformException&) {
    return {};
  }
}

std::optional<hyselam::Pose2> CameraPoses::baseIn(const std::string& parent,
                                                  const ros::Time& stamp) const {
  const auto found = lookup(parent, ids_.base, stamp);
  if (!found) return {};
  try {
    return hyselam::fromMsg(found->transform, "tf");
  } catch (const hyselam::InputError&) {  // not a rotation, or not finite
    return {};
  }
}

std::optional<CameraPoses::CameraPose> CameraPoses::cameraIn(const std::string& parent,
                                                             const std::string& camera,
                                                             const ros::Time& stamp) const {
  const auto found = lookup(parent, camera, stamp);
  if (!found) return {};
  const auto& t = found->transform.translation;
  if (camera == ids_.base) {  // images without a frame of their own
    const auto base = baseIn(parent, stamp);
    return base ? std::optional<CameraPose>({*base, t.z}) : std::nullopt;
  }
  return CameraPose{{t.x, t.y, headingOf(found->transform.rotation)}, t.z};
}

std::optional<hyselam::Pose2> CameraPoses::baseInMap(const ros::Time& stamp) const {
  return baseIn(ids_.global, stamp);
}

std::optional<CameraPoses::CameraPose> CameraPoses::cameraInMap(const std::string& camera,
                                                                const ros::Time& stamp) const {
  return cameraIn(ids_.global, camera, stamp);
}

std::optional<hyselam::Pose2> CameraPoses::cameraInOdometry(const std::string& camera,
                                                            const ros::Time& stamp) const {
  const auto found = cameraIn(ids_.odom, camera, stamp);
  return found ? found->pose : baseIn(ids_.odom, stamp);
}

std::optional<hyselam::Pose2> CameraPoses::baseInOdometry(const ros::Time& stamp) const {
  return baseIn(ids_.odom, stamp);
}

std::optional<tf2::Transform> CameraPoses::sensorInBase(const std::string& sensor) const {
  if (sensor.empty()) return {};
  try {
    return hyselam::spatialFromMsg(tf_.lookupTransform(ids_.base, sensor, ros::Time(0)).transform,
                                   "tf: frame " + sensor);
  } catch (const tf2::TransformException&) {
    return {};
  }
}

bool CameraPoses::awaitsOdometry(const ros::Time& stamp) const {
  return tf_.canTransform(ids_.odom, ids_.base, ros::Time(0)) &&
         !tf_.canTransform(ids_.odom, ids_.base, stamp);
}

double CameraPoses::cameraHeadingIn(const std::string& laser, const std::string& camera) const {
  try {
    return headingOf(tf_.lookupTransform(laser, camera, ros::Time(0)).transform.rotation);
  } catch (const tf2::TransformException&) {
    return 0.0;
  }
}

}  // namespace selovis
