#include "selovis/ros/image_input.hpp"

#include <cmath>
#include <utility>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/ros/conversions.hpp"
#include "hyselam_common/ros/diagnostics.hpp"
#include "hyselam_common/ros/transport.hpp"
#include "selovis/ros/sensor_images.hpp"

namespace selovis {
namespace {

// Without depth images for so long ranges come from the laser.
constexpr double kMaxDepthPause = 1.0;  // [s]
constexpr int kRangeColumns = 40;       // ranges taken from a laser scan
// Messages that may wait in the queues of ROS, and depth images that are kept: two seconds of a
// camera, each may be a megabyte.
constexpr std::uint32_t kScanQueue = 100, kImuQueue = 200, kCameraInfoQueue = 5;
constexpr std::size_t kKeptDepths = 60;

}  // namespace

ImageInput::ImageInput(const ros::NodeHandle& nh, const ImageInputParams& params,
                       const Requirements& required, const CameraFov& default_fov,
                       CameraPoses& poses, const std::string& log_name, ImageHandler on_image,
                       TimeJumpHandler on_time_jump)
    : nh_(nh),
      params_(params),
      required_(required),
      fov_(default_fov),
      poses_(poses),
      topic_(nh_.resolveName("image")),
      log_name_(log_name),
      on_image_(std::move(on_image)),
      on_time_jump_(std::move(on_time_jump)),
      depths_(kKeptDepths),
      drops_(log_name, "image"),
      waiting_(
          nh, {params.queue_size, params.sync_timeout, hyselam::WaitParams::Clock::kWall},
          [this](const Image& image) { return missingReading(image); },
          [this](const Image& image) { use(image); },
          [this](const Image& image, Queue::GivenUp why, const std::string& /*missing*/) {
            giveUp(image, why);
          }),
      transport_(nh) {}

void ImageInput::subscribe() {
  const RequiredReadings& needs = required_.readings;
  if (needs.scan || needs.ranges) subscribeReading(scans_, "scan", kScanQueue);
  if (needs.ranges) {
    subscribeReading(depths_, "depth", static_cast<std::uint32_t>(params_.queue_size));
  }
  if (needs.heading) subscribeReading(imus_, "imu", kImuQueue);
  if (needs.magnetic) subscribeReading(fields_, "magnetic_field", kImuQueue);
  subscribers_.push_back(nh_.subscribe<sensor_msgs::CameraInfo>(
      "camera_info", kCameraInfoQueue,
      [this](const sensor_msgs::CameraInfo::ConstPtr& info) { onCameraInfo(*info); },
      ros::VoidConstPtr(), hyselam::tcpNoDelay()));
  subscribeImages();
}

template <typename M>
void ImageInput::subscribeReading(SensorHistory<M>& history, const char* topic,
                                  std::uint32_t queue_size) {
  subscribers_.push_back(nh_.subscribe<M>(
      topic, queue_size,
      [this, &history](const typename M::ConstPtr& msg) {
        history.add(msg);
        waiting_.serve();
      },
      ros::VoidConstPtr(), hyselam::tcpNoDelay()));
}

void ImageInput::subscribeImages() {
  const auto queue_size = static_cast<std::uint32_t>(params_.queue_size);
  if (params_.image_transport == "compressed") {
    // Without image_transport's plugin, which decodes truncated images.
    subscribers_.push_back(nh_.subscribe<sensor_msgs::CompressedImage>(
        "image/compressed", queue_size,
        [this](const sensor_msgs::CompressedImage::ConstPtr& msg) {
          onImage({nullptr, msg});
        },
        ros::VoidConstPtr(), hyselam::tcpNoDelay()));
  } else {
    image_subscriber_ = transport_.subscribe(
        "image", queue_size,
        [this](const sensor_msgs::ImageConstPtr& msg) {
          onImage({msg, nullptr});
        },
        ros::VoidPtr(),
        image_transport::TransportHints(params_.image_transport, hyselam::tcpNoDelay()));
  }
}

void ImageInput::onCameraInfo(const sensor_msgs::CameraInfo& info) {
  if (info.K[0] > 0.0 && info.K[4] > 0.0 && info.width > 0 && info.height > 0) {
    fov_ = {2.0 * std::atan(0.5 * info.width / info.K[0]),
            2.0 * std::atan(0.5 * info.height / info.K[4])};
  }
}

void ImageInput::onImage(const Image& image) {
  ++received_;
  const ros::Time& stamp = image.header().stamp;
  if ((last_stamp_ - stamp).toSec() > kMaxDisorder) {
    ROS_WARN_STREAM(log_name_ << " time went back: starting again");
    waiting_.clear();
    poses_.clear();
    on_time_jump_();
  }
  last_stamp_ = stamp;
  waiting_.add(image);
}

bool ImageInput::hasDepth(const ros::Time& stamp) const {
  return required_.readings.ranges && depths_.nearest(stamp, params_.sync_tolerance);
}

std::string ImageInput::missingReading(const Image& image) const {
  // A later reading may be nearer, until one of the image's time or after it has come.
  const ros::Time& stamp = image.header().stamp;
  const RequiredReadings& needs = required_.readings;
  // Depth images are preferred to the scan: as long as they come, they are waited for.
  if (needs.ranges && depths_.nearest(stamp, kMaxDepthPause) && !depths_.reaches(stamp)) {
    return "depth";
  }
  const bool needs_scan = needs.scan || (needs.ranges && !hasDepth(stamp));
  const auto comes = [&](const auto& history) {
    return history.reaches(stamp) && history.nearest(stamp, params_.sync_tolerance);
  };
  if (needs_scan && !comes(scans_)) return "scan";
  if (needs.heading && !comes(imus_)) return "imu";
  if (needs.magnetic && !comes(fields_)) return "magnetic_field";
  // What tf knows may be older than the image: it comes on a connection of its own.
  if (required_.odometry && poses_.awaitsOdometry(stamp)) return "odometry";
  return "";
}

template <typename M>
typename M::ConstPtr ImageInput::nearest(const SensorHistory<M>& history, const ros::Time& stamp,
                                         const char* what) const {
  auto msg = history.nearest(stamp, params_.sync_tolerance);
  if (!msg) {
    throw hyselam::InputError(topic_, "",
                              std::string("no ") + what + " came within " +
                                  std::to_string(params_.sync_tolerance) + " s of an image");
  }
  return msg;
}

SensorReadings ImageInput::readingsFor(const std_msgs::Header& header) const {
  const ros::Time& stamp = header.stamp;
  const RequiredReadings& needs = required_.readings;
  SensorReadings readings;
  readings.stamp = stamp.toSec();
  const bool depth = hasDepth(stamp);
  if (needs.scan || (needs.ranges && !depth)) {
    const auto scan = nearest(scans_, stamp, needs.scan ? "scan" : "scan or depth image");
    if (needs.scan) readings.scan = scan->ranges;
    if (needs.ranges) {
      const double heading = poses_.cameraHeadingIn(scan->header.frame_id, header.frame_id);
      readings.ranges = rangesAcross(*scan, fov_.horizontal, -heading, kRangeColumns);
    }
  }
  if (depth) {
    const auto msg = nearest(depths_, stamp, "depth image");
    readings.ranges = rangesOfDepth(depthFromMsg(msg, "depth"), kDepthColumns);
  }
  if (needs.heading) {
    readings.heading = hyselam::yawFromMsg(nearest(imus_, stamp, "imu")->orientation, "imu");
  }
  if (needs.magnetic) {
    const auto field = nearest(fields_, stamp, "magnetic_field")->magnetic_field;
    readings.magnetic = {field.x, field.y, field.z};
  }
  if (required_.odometry) readings.odometry = poses_.cameraInOdometry(header.frame_id, stamp);
  return readings;
}

void ImageInput::use(const Image& image) {
  const char* reason = "no reading";
  try {
    const SensorReadings readings = readingsFor(image.header());
    reason = "refused";
    const cv::Mat picture =
        image.raw ? fromMsg(image.raw, topic_) : fromMsg(*image.compressed, topic_ + "/compressed");
    on_image_(picture, readings, image.header());
    ++used_;
  } catch (const std::exception& e) {
    drops_.drop(reason, e.what());
  }
}

void ImageInput::giveUp(const Image& image, Queue::GivenUp why) {
  if (why == Queue::GivenUp::kQueueFull) {
    drops_.drop("queue full", "the oldest of the images that waited");
  } else {
    use(image);  // with the nearest readings that have come
  }
}

void ImageInput::report(diagnostic_msgs::DiagnosticStatus& status) {
  using diagnostic_msgs::DiagnosticStatus;
  using hyselam::addRemark;
  using hyselam::addValue;
  if (received_ == reported_received_) {
    addRemark(status, DiagnosticStatus::WARN, "no images on " + topic_);
  }
  if (drops_.total() > reported_drops_) {
    addRemark(status, DiagnosticStatus::WARN, "images dropped: " + drops_.last());
  }
  reported_received_ = received_;
  reported_drops_ = drops_.total();
  addValue(status, "images received", received_);
  addValue(status, "images used", used_);
  addValue(status, "images waiting", waiting_.size());
  addValue(status, "images dropped", drops_.total());
  drops_.report(status);
  addValue(status, "last dropped", drops_.last());
}

}  // namespace selovis
