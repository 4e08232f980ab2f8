// Where the camera and the robot are, by tf.
#pragma once

#include <tf2/LinearMath/Transform.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>

#include <optional>
#include <string>

#include "hyselam_common/pose2.hpp"
#include "selovis/ros/parameters.hpp"

namespace selovis {

/// Camera poses from tf. All functions return nullopt if tf has no transform at the time or within
/// half a second of it.
class CameraPoses {
 public:
  /// The heading of a camera is that of its optical axis.
  struct CameraPose {
    hyselam::Pose2 pose;
    double height = 0.0;  ///< [m]
  };

  explicit CameraPoses(FrameIds ids);

  std::optional<hyselam::Pose2> baseInMap(const ros::Time& stamp) const;
  std::optional<CameraPose> cameraInMap(const std::string& camera, const ros::Time& stamp) const;
  /// By odometry; of the base where the camera's transform is not known.
  std::optional<hyselam::Pose2> cameraInOdometry(const std::string& camera,
                                                 const ros::Time& stamp) const;
  /// Whether odometry is known, but not yet at that time.
  bool awaitsOdometry(const ros::Time& stamp) const;
  /// A sensor on the robot, in the base's frame; by the newest transform.
  std::optional<tf2::Transform> sensorInBase(const std::string& sensor) const;
  /// The base by odometry.
  std::optional<hyselam::Pose2> baseInOdometry(const ros::Time& stamp) const;
  /// Heading of the camera in the frame of a laser [rad]; 0 where it is not known.
  double cameraHeadingIn(const std::string& laser, const std::string& camera) const;

  void clear() { tf_.clear(); }

 private:
  std::optional<geometry_msgs::TransformStamped> lookup(const std::string& parent,
                                                        const std::string& child,
                                                        const ros::Time& stamp) const;
  std::optional<CameraPose> cameraIn(const std::string& parent, const std::string& camera,
                                     const ros::Time& stamp) const;
  std::optional<hyselam::Pose2> baseIn(const std::string& parent, const ros::Time& stamp) const;

  const FrameIds ids_;
  tf2_ros::Buffer tf_;
  tf2_ros::TransformListener listener_;
};

}  // namespace selovis
