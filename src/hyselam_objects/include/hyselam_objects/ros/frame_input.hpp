// Frames of the camera in, each with the camera's pose in the map: from depth and colour images, or
// from organised clouds.
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

#include "hyselam_objects/object_mapper.hpp"

namespace hyselam_objects {

struct FrameInputParams {
  std::string map_frame = "map";
  bool use_points = false;   ///< input from `points`, else from the camera's images
  double period = 0.5;       ///< frames that come sooner are left out [s]
  double tf_patience = 0.2;  ///< a pose is waited for [s]
};

/// All callbacks run on the queue of `nh`.
class FrameInput {
 public:
  using Use =
      std::function<void(const OrganisedCloud&, const PinholeCamera&, const ros::Time& stamp)>;
  using Refuse = std::function<void(const std::string& reason)>;

  /// `use` gets each frame whose pose is known; what it throws is a reason to refuse the frame.
  FrameInput(ros::NodeHandle nh, const FrameInputParams& params, Use use, Refuse refuse);
  FrameInput(const FrameInput&) = delete;  // its callbacks hold it
  FrameInput& operator=(const FrameInput&) = delete;

  /// What the input has lacked since this was asked last: topics that gave nothing, stamps of depth
  /// and colour that never were the same; empty: nothing.
  std::string missing();

  /// Frames refused because nobody told in time where the camera was.
  std::size_t withoutPose() const { return without_pose_; }

 private:
  using Image = sensor_msgs::Image;
  using WithPose = std::function<void(const Eigen::Isometry3d& camera_in_map)>;

  void onInfo(const sensor_msgs::CameraInfo::ConstPtr& msg);
  void onDepth(const Image::ConstPtr& msg);
  void onColour(const Image::ConstPtr& msg);
  void onImages(const Image::ConstPtr& depth, const Image::ConstPtr& colour);
  void onPoints(const sensor_msgs::PointCloud2::ConstPtr& msg);
  bool isDue(const std_msgs::Header& header);
  void await(const std_msgs::Header& header, WithPose use);
  void serveWaiting();
  void refuseWithoutPose(const std::string& why);

  const FrameInputParams params_;
  const Use use_;
  const Refuse refuse_;
  const std::string depth_topic_, colour_topic_, info_topic_, points_topic_;
  struct Received {
    std::size_t depth = 0, colour = 0, info = 0, clouds = 0;
  };
  Received since_;                                        // missing() was asked
  std::size_t unpaired_depth_ = 0, unpaired_colour_ = 0;  // since the last pair of the same stamp
  std::optional<PinholeCamera> camera_;
  struct Waiting {
    std_msgs::Header header;
    WithPose use;
    ros::WallTime since;
  };
  std::optional<Waiting> waiting_;  // for the camera's pose
  ros::Time last_frame_;
  std::size_t without_pose_ = 0;

  tf2_ros::Buffer tf_buffer_;
  tf2_ros::TransformListener tf_listener_;
  ros::Subscriber info_, points_;
  std::unique_ptr<message_filters::Subscriber<Image>> depth_, colour_;
  std::unique_ptr<message_filters::TimeSynchronizer<Image, Image>> images_;
  ros::WallTimer pose_timer_;
};

}  // namespace hyselam_objects
