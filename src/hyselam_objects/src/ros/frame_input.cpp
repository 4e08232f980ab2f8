#include "hyselam_objects/ros/frame_input.hpp"

#include <algorithm>
#include <utility>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/ros/transport.hpp"
#include "hyselam_objects/ros/conversions.hpp"
#include "points_camera.hpp"

namespace hyselam_objects {
namespace {

constexpr double kTimeBack = 0.5;     // [s] a smaller step back is a late frame
constexpr double kRetryEvery = 0.01;  // [s] while a frame waits for its pose
constexpr std::size_t kUnpaired = 3;  // images of both in a row: their stamps differ

}  // namespace

FrameInput::FrameInput(ros::NodeHandle nh, const FrameInputParams& params, Use use, Refuse refuse)
    : params_(params),
      use_(std::move(use)),
      refuse_(std::move(refuse)),
      depth_topic_(nh.resolveName("camera/depth/image_raw")),
      colour_topic_(nh.resolveName("camera/color/image_raw")),
      info_topic_(nh.resolveName("camera/depth/camera_info")),
      points_topic_(nh.resolveName("points")),
      tf_listener_(tf_buffer_, true, hyselam::tcpNoDelay()),
      pose_timer_(nh.createWallTimer(
          ros::WallDuration(kRetryEvery), [this](const ros::WallTimerEvent&) { serveWaiting(); },
          false, false)) {
  if (params_.use_points) {
    points_ = nh.subscribe("points", 1, &FrameInput::onPoints, this, hyselam::tcpNoDelay());
  } else {
    info_ = nh.subscribe("camera/depth/camera_info", 1, &FrameInput::onInfo, this,
                         hyselam::tcpNoDelay());
    depth_ = std::make_unique<message_filters::Subscriber<Image>>(nh, "camera/depth/image_raw", 5,
                                                                  hyselam::tcpNoDelay());
    colour_ = std::make_unique<message_filters::Subscriber<Image>>(nh, "camera/color/image_raw", 5,
                                                                   hyselam::tcpNoDelay());
    images_ =
        std::make_unique<message_filters::TimeSynchronizer<Image, Image>>(*depth_, *colour_, 10);
    depth_->registerCallback(&FrameInput::onDepth, this);
    colour_->registerCallback(&FrameInput::onColour, this);
    images_->registerCallback(&FrameInput::onImages, this);
  }
}

void FrameInput::onInfo(const sensor_msgs::CameraInfo::ConstPtr& msg) {
  try {
    ++since_.info;
    camera_ = cameraOf(*msg);
  } catch (const hyselam::InputError& e) {
    refuse_(e.what());
  }
}

void FrameInput::onDepth(const Image::ConstPtr&) {
  ++since_.depth;
  ++unpaired_depth_;
}

void FrameInput::onColour(const Image::ConstPtr&) {
  ++since_.colour;
  ++unpaired_colour_;
}

void FrameInput::onImages(const Image::ConstPtr& depth, const Image::ConstPtr& colour) {
  unpaired_depth_ = unpaired_colour_ = 0;
  if (!camera_ || !isDue(depth->header)) return;
  await(depth->header,
        [this, depth, colour, camera = *camera_](const Eigen::Isometry3d& in_map) mutable {
          camera.in_map = in_map;
          use_(cloudOf(*depth, colour.get(), camera), camera, depth->header.stamp);
        });
}

void FrameInput::onPoints(const sensor_msgs::PointCloud2::ConstPtr& msg) {
  ++since_.clouds;
  if (!isDue(msg->header)) return;
  await(msg->header, [this, msg](const Eigen::Isometry3d& in_map) {
    const OrganisedCloud cloud = cloudOf(*msg);
    PinholeCamera camera = cameraOf(cloud);
    camera.in_map = in_map;
    use_(cloud, camera, msg->header.stamp);
  });
}

bool FrameInput::isDue(const std_msgs::Header& header) {
  if ((last_frame_ - header.stamp).toSec() > kTimeBack) {  // a bag begins again
    // A transform of before, received after the listener forgot them, would make it refuse all new
    // ones.
    tf_buffer_.clear();
    waiting_.reset();
    last_frame_ = ros::Time();
  }
  // A pose that always comes later than the next frame would never be used, were the one that waits
  // given up for it.
  serveWaiting();
  if (waiting_) return false;
  if (!last_frame_.isZero() && (header.stamp - last_frame_).toSec() < params_.period) return false;
  last_frame_ = header.stamp;
  return true;
}

// Waiting must not block: it would hold up the other nodelets of the manager, and for ever while
// the clock stands.
void FrameInput::await(const std_msgs::Header& header, WithPose use) {
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

std::string FrameInput::missing() {
  const Received since = std::exchange(since_, {});
  if (params_.use_points) return since.clouds == 0 ? "no clouds on " + points_topic_ : "";
  std::string out;
  const auto add = [&out](const std::string& text) { out += (out.empty() ? "" : "; ") + text; };
  if (since.depth == 0) add("no images on " + depth_topic_);
  if (since.colour == 0) add("no images on " + colour_topic_);
  if (!camera_) {
    add((since.info == 0 ? "no camera_info on " : "no camera_info that can be used on ") +
        info_topic_);
  }
  if (std::min(unpaired_depth_, unpaired_colour_) >= kUnpaired) {
    add("no image on " + depth_topic_ + " has the same stamp as one on " + colour_topic_);
  }
  return out;
}

void FrameInput::refuseWithoutPose(const std::string& why) {
  waiting_.reset();
  pose_timer_.stop();
  ++without_pose_;
  refuse_("the camera's pose is not known: " + why);
}

}  // namespace hyselam_objects
