#include "hyselam_objects/ros/frame_input.hpp"

#include <algorithm>
#include <utility>

#include "camera_from_cloud.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/ros/transport.hpp"
#include "hyselam_objects/ros/conversions.hpp"

namespace hyselam_objects {
namespace {

constexpr double kTimeJump = 0.5;     // [s] a smaller step back is a late frame
constexpr std::size_t kUnpaired = 3;  // images of both in a row: their stamps differ

}  // namespace

void FrameInputParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit.renamed("period", "frame_period");
  visit.renamed("tf_patience", "transform_wait");
  visit("map_frame", map_frame, "frame of the object map");
  visit("use_points", use_points, "input from the topic points, else from the images");
  visit("frame_period", frame_period, Range::between(0.0, 60.0), "s",
        "frames that come sooner are left out");
  visit("transform_wait", transform_wait, Range::between(0.0, 5.0), "s",
        "a frame waits at most this long for the camera's pose");
}

FrameInput::FrameInput(ros::NodeHandle nh, const FrameInputParams& params, FrameCallback on_frame,
                       RefusalCallback on_refusal)
    : params_(params),
      on_frame_(std::move(on_frame)),
      on_refusal_(std::move(on_refusal)),
      depth_topic_(nh.resolveName("camera/depth/image_raw")),
      color_topic_(nh.resolveName("camera/color/image_raw")),
      info_topic_(nh.resolveName("camera/depth/camera_info")),
      points_topic_(nh.resolveName("points")),
      tf_listener_(tf_buffer_, true, hyselam::tcpNoDelay()),
      pose_queue_(makePoseQueue(nh)) {
  if (params_.use_points) {
    points_ = nh.subscribe("points", 1, &FrameInput::onPoints, this, hyselam::tcpNoDelay());
  } else {
    subscribeImages(nh);
  }
}

FrameInput::PoseQueue FrameInput::makePoseQueue(const ros::NodeHandle& nh) {
  // By wall time: while the clock stands, a frame must not wait for ever.
  const hyselam::WaitParams wait{1, params_.transform_wait, hyselam::WaitParams::Clock::kWall};
  return PoseQueue(
      nh, wait,
      [this](const WaitingFrame& frame) {
        return hyselam::missingTransform(tf_buffer_, params_.map_frame, frame.header.frame_id,
                                         frame.header.stamp);
      },
      [this](const WaitingFrame& frame) { serveFrame(frame); },
      [this](const WaitingFrame&, PoseQueue::Queue::GivenUp, const std::string& missing) {
        ++frames_without_pose_;
        on_refusal_("the camera's pose is not known: " + missing);
      });
}

void FrameInput::subscribeImages(ros::NodeHandle nh) {
  constexpr std::uint32_t kQueue = 5, kPairs = 10;
  using Subscriber = message_filters::Subscriber<Image>;
  info_ =
      nh.subscribe("camera/depth/camera_info", 1, &FrameInput::onInfo, this, hyselam::tcpNoDelay());
  depth_ =
      std::make_unique<Subscriber>(nh, "camera/depth/image_raw", kQueue, hyselam::tcpNoDelay());
  color_ =
      std::make_unique<Subscriber>(nh, "camera/color/image_raw", kQueue, hyselam::tcpNoDelay());
  images_ =
      std::make_unique<message_filters::TimeSynchronizer<Image, Image>>(*depth_, *color_, kPairs);
  depth_->registerCallback(&FrameInput::onDepth, this);
  color_->registerCallback(&FrameInput::onColor, this);
  images_->registerCallback(&FrameInput::onImages, this);
}

void FrameInput::onInfo(const sensor_msgs::CameraInfo::ConstPtr& msg) {
  try {
    ++received_.info;
    camera_ = cameraFromInfo(*msg);
  } catch (const hyselam::InputError& e) {
    on_refusal_(e.what());
  }
}

void FrameInput::onDepth(const Image::ConstPtr&) {
  ++received_.depth;
  ++unpaired_depth_;
}

void FrameInput::onColor(const Image::ConstPtr&) {
  ++received_.color;
  ++unpaired_color_;
}

void FrameInput::onImages(const Image::ConstPtr& depth, const Image::ConstPtr& color) {
  unpaired_depth_ = unpaired_color_ = 0;
  if (!camera_ || !isDue(depth->header)) return;
  pose_queue_.add(
      {depth->header,
       [this, depth, color, camera = *camera_](const Eigen::Isometry3d& in_map) mutable {
         camera.in_map = in_map;
         on_frame_(cloudFromImages(*depth, color.get(), camera), camera, depth->header.stamp);
       }});
}

void FrameInput::onPoints(const sensor_msgs::PointCloud2::ConstPtr& msg) {
  ++received_.clouds;
  if (!isDue(msg->header)) return;
  pose_queue_.add({msg->header, [this, msg](const Eigen::Isometry3d& in_map) {
                     const OrganizedCloud cloud = cloudFromMsg(*msg);
                     PinholeCamera camera = cameraFromCloud(cloud);
                     camera.in_map = in_map;
                     on_frame_(cloud, camera, msg->header.stamp);
                   }});
}

bool FrameInput::isDue(const std_msgs::Header& header) {
  if ((last_frame_ - header.stamp).toSec() > kTimeJump) {  // a bag is played again
    // Older transforms, received after the listener was cleared, would make it refuse all new ones.
    tf_buffer_.clear();
    pose_queue_.clear();
    last_frame_ = ros::Time();
  }
  // The waiting frame is not given up for a newer one: otherwise no frame would ever be used if
  // poses always came later than the next frame.
  pose_queue_.serve();
  if (!pose_queue_.empty()) return false;
  if (!last_frame_.isZero() && (header.stamp - last_frame_).toSec() < params_.frame_period) {
    return false;
  }
  last_frame_ = header.stamp;
  return true;
}

void FrameInput::serveFrame(const WaitingFrame& frame) {
  try {
    const geometry_msgs::Transform pose =
        tf_buffer_.lookupTransform(params_.map_frame, frame.header.frame_id, frame.header.stamp)
            .transform;
    const auto& t = pose.translation;
    const auto& q = pose.rotation;
    frame.on_pose(Eigen::Translation3d(t.x, t.y, t.z) *
                  Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized());
  } catch (const std::exception& e) {
    on_refusal_(e.what());
  }
}

std::string FrameInput::missing() {
  const Received received = std::exchange(received_, {});
  if (params_.use_points) return received.clouds == 0 ? "no clouds on " + points_topic_ : "";
  std::string out;
  const auto add = [&out](const std::string& text) { out += (out.empty() ? "" : "; ") + text; };
  if (received.depth == 0) add("no images on " + depth_topic_);
  if (received.color == 0) add("no images on " + color_topic_);
  if (!camera_) {
    add((received.info == 0 ? "no camera_info on " : "no camera_info that can be used on ") +
        info_topic_);
  }
  if (std::min(unpaired_depth_, unpaired_color_) >= kUnpaired) {
    add("no image on " + depth_topic_ + " has the same stamp as one on " + color_topic_);
  }
  return out;
}

}  // namespace hyselam_objects
