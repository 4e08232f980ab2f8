// Frames of a color and depth camera, each with the camera's pose in the map: from depth and color
// images, or from organized clouds.
#pragma once

#include <message_filters/subscriber.h>
#include <message_filters/time_synchronizer.h>
#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/PointCloud2.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "hyselam_common/parameters.hpp"
#include "hyselam_common/ros/wait_for_transform.hpp"
#include "hyselam_objects/mapping/object_mapper.hpp"

namespace hyselam_objects {

struct FrameInputParams {
  std::string map_frame = "map";
  bool use_points = false;      ///< input from `points`, else from the camera's images
  double frame_period = 0.5;    ///< frames that come sooner are left out [s], 0 .. 60
  double transform_wait = 0.2;  ///< a frame waits at most this long for its pose [s], 0 .. 5

  void describe(hyselam::ParameterVisitor& visit);
};

/// All callbacks run on the queue of `nh`.
class FrameInput {
 public:
  using FrameCallback =
      std::function<void(const OrganizedCloud&, const PinholeCamera&, const ros::Time& stamp)>;
  using RefusalCallback = std::function<void(const std::string& reason)>;

  /// `on_frame` gets each frame whose pose is known; an exception that it throws is a reason to
  /// refuse the frame.
  FrameInput(ros::NodeHandle nh, const FrameInputParams& params, FrameCallback on_frame,
             RefusalCallback on_refusal);
  FrameInput(const FrameInput&) = delete;  // its callbacks hold it
  FrameInput& operator=(const FrameInput&) = delete;

  /// What the input has lacked since the last call: topics without messages, depth and color images
  /// without equal stamps; empty: nothing.
  std::string missing();

  /// Frames refused because the camera's pose did not become known in time.
  std::size_t framesWithoutPose() const { return frames_without_pose_; }

 private:
  using Image = sensor_msgs::Image;
  using PoseCallback = std::function<void(const Eigen::Isometry3d& camera_in_map)>;
  struct WaitingFrame {
    std_msgs::Header header;
    PoseCallback on_pose;
  };
  using PoseQueue = hyselam::WaitForTransform<WaitingFrame>;

  PoseQueue makePoseQueue(const ros::NodeHandle& nh);
  void subscribeImages(ros::NodeHandle nh);
  void onInfo(const sensor_msgs::CameraInfo::ConstPtr& msg);
  void onDepth(const Image::ConstPtr& msg);
  void onColor(const Image::ConstPtr& msg);
  void onImages(const Image::ConstPtr& depth, const Image::ConstPtr& color);
  void onPoints(const sensor_msgs::PointCloud2::ConstPtr& msg);
  bool isDue(const std_msgs::Header& header);
  void serveFrame(const WaitingFrame& frame);

  const FrameInputParams params_;
  const FrameCallback on_frame_;
  const RefusalCallback on_refusal_;
  const std::string depth_topic_, color_topic_, info_topic_, points_topic_;
  struct Received {
    std::size_t depth = 0, color = 0, info = 0, clouds = 0;
  };
  Received received_;                                    // since missing() was called
  std::size_t unpaired_depth_ = 0, unpaired_color_ = 0;  // since the last pair of the same stamp
  std::optional<PinholeCamera> camera_;
  ros::Time last_frame_;
  std::size_t frames_without_pose_ = 0;

  tf2_ros::Buffer tf_buffer_;
  tf2_ros::TransformListener tf_listener_;
  PoseQueue pose_queue_;  // holds one frame at most
  ros::Subscriber info_, points_;
  std::unique_ptr<message_filters::Subscriber<Image>> depth_, color_;
  std::unique_ptr<message_filters::TimeSynchronizer<Image, Image>> images_;
};

}  // namespace hyselam_objects
