#include "hyselam_objects/ros/frame_input.hpp"

#include <utility>

#include "hyselam_common/errors.hpp"
#include "hyselam_objects/ros/conversions.hpp"
#include "points_camera.hpp"

namespace hyselam_objects {
namespace {

constexpr double kTimeBack = 0.5;     // [s] a smaller step back is a late frame
constexpr double kRetryEvery = 0.01;  // [s] while a frame waits for its pose

}  // namespace

FrameInput::FrameInput(ros::NodeHandle nh, const FrameInputParams& params, Use use, Refuse refuse)
    : params_(params),
      use_(std::move(use)),
      refuse_(std::move(refuse)),
      tf_listener_(tf_buffer_),
      pose_timer_(nh.createWallTimer(
          ros::WallDuration(kRetryEvery), [this](const ros::WallTimerEvent&) { serveWaiting(); },
          false, false)) {
  if (params_.use_points) {
    points_ = nh.subscribe("points", 1, &FrameInput::onPoints, this);
  } else {
    info_ = nh.subscribe("camera/depth/camera_info", 1, &FrameInput::onInfo, this);
    depth_ = std::make_unique<message_filters::Subscriber<Image>>(nh, "camera/depth/image_raw", 5);
    colour_ = std::make_unique<message_filters::Subscriber<Image>>(nh, "camera/color/image_raw", 5);
    images_ =
        std::make_unique<message_filters::TimeSynchronizer<Image, Image>>(*depth_, *colour_, 10);
    images_->registerCallback(&FrameInput::onImages, this);
  }
}

void FrameInput::onInfo(const sensor_msgs::CameraInfo::ConstPtr& msg) {
  try {
    camera_ = cameraOf(*msg);
  } catch (const hyselam::InputError& e) {
    refuse_(e.what());
  }
}

void FrameInput::onImages(const Image::ConstPtr& depth, const Image::ConstPtr& colour) {
  if (!camera_ || !isDue(depth->header)) return;
  await(depth->header,
        [this, depth, colour, camera = *camera_](const Eigen::Isometry3d& in_map) mutable {
          camera.in_map = in_map;
          use_(cloudOf(*depth, colour.get(), camera), camera, depth->header.stamp);
        });
}

void FrameInput::onPoints(const sensor_msgs::PointCloud2::ConstPtr& msg) {
  if (!isDue(msg->header)) return;
  await(msg->header, [this, msg](const Eigen::Isometry3d& in_map) {
    const OrganisedCloud cloud = cloudOf(*msg);
    PinholeCamera camera = cameraOf(cloud);
    camera.in_map = in_map;
    use_(cloud, camera, msg->header.stamp);
  });
}

bool FrameInput::isDue(const std_msgs::Header& header) {
  const bool back = header.stamp < last_frame_;  // a bag begins again
  if ((last_frame_ - header.stamp).toSec() > kTimeBack) {
    // A transform of before, received after the listener forgot them, would make it refuse all new
    // ones.
    tf_buffer_.clear();
    waiting_.reset();
  }
  if (!back && !last_frame_.isZero() && (header.stamp - last_frame_).toSec() < params_.period) {
    return false;
  }
  last_frame_ = header.stamp;
  return true;
}

// Waiting must not block: it would hold up the other nodelets of the manager, and for ever while
// the clock stands.
void FrameInput::await(const std_msgs::Header& header, WithPose use) {
  if (waiting_) refuseWithoutPose("a newer frame has come");
  waiting_ = {header, std::move(use), ros::WallTime::now()};
  serveWaiting();
}

void FrameInput::serveWaiting() {
  if (!waiting_) return;
  const std_msgs::Header& header = waiting_->header;
  std::string why;
  if (tf_buffer_.canTransform(params_.map_frame, header.frame_id, header.stamp, &why)) {
    const Waiting frame = std::move(*waiting_);
    waiting_.reset();
    pose_timer_.stop();
    try {
      const geometry_msgs::Transform pose =
          tf_buffer_.lookupTransform(params_.map_frame, frame.header.frame_id, frame.header.stamp)
              .transform;
      const auto& t = pose.translation;
      const auto& q = pose.rotation;
      frame.use(Eigen::Translation3d(t.x, t.y, t.z) *
                Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized());
    } catch (const std::exception& e) {
      refuse_(e.what());
    }
  } else if ((ros::WallTime::now() - waiting_->since).toSec() >= params_.tf_patience) {
    refuseWithoutPose(why);
  } else {
    pose_timer_.start();
  }
}

void FrameInput::refuseWithoutPose(const std::string& why) {
  waiting_.reset();
  pose_timer_.stop();
  ++without_pose_;
  refuse_("the camera's pose is not known: " + why);
}

}  // namespace hyselam_objects
