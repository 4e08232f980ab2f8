// Images, each with the sensor readings of its time.
#pragma once

#include <diagnostic_msgs/DiagnosticStatus.h>
#include <image_transport/image_transport.h>
#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Imu.h>
#include <sensor_msgs/LaserScan.h>
#include <sensor_msgs/MagneticField.h>

#include <functional>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "hyselam_common/ros/drop_counter.hpp"
#include "hyselam_common/ros/wait_for_transform.hpp"
#include "selovis/descriptors/descriptor.hpp"
#include "selovis/ros/camera_poses.hpp"
#include "selovis/ros/parameters.hpp"
#include "selovis/ros/sensor_history.hpp"

namespace selovis {

/// Field of view of a camera [rad].
struct CameraFov {
  double horizontal, vertical;
};

/// Subscribes to images and to the readings that a descriptor requires. An image waits, in order,
/// until the reading nearest to its time is known; after `sync_timeout` the nearest that has come
/// is taken, and an image without one is dropped.
///
/// Why not message_filters: its synchronizer pairs every image with every topic or drops it without
/// a word; here a depth image, where there are any, replaces the scan, odometry may be missing, and
/// each drop is reported with its reason.
///
/// Everything runs on the queue of the node handle, one callback at a time.
class ImageInput {
 public:
  using ImageHandler =
      std::function<void(const cv::Mat&, const SensorReadings&, const std_msgs::Header&)>;
  /// Called when the time of the images went back; images that waited are forgotten by then.
  using TimeJumpHandler = std::function<void()>;
  struct Requirements {
    RequiredReadings readings;
    bool odometry = false;
  };

  /// @param poses is kept as a reference. @param default_fov until a camera_info comes.
  /// @param log_name begins what is logged.
  ImageInput(const ros::NodeHandle& nh, const ImageInputParams& params,
             const Requirements& required, const CameraFov& default_fov, CameraPoses& poses,
             const std::string& log_name, ImageHandler on_image, TimeJumpHandler on_time_jump);

  /// From now on the handlers are called. An InputError that they throw counts as a refused image.
  void subscribe();

  /// By camera_info, or the default.
  const CameraFov& fov() const { return fov_; }
  void report(diagnostic_msgs::DiagnosticStatus& status);

 private:
  struct Image {
    sensor_msgs::ImageConstPtr raw;  ///< or
    sensor_msgs::CompressedImage::ConstPtr compressed;
    const std_msgs::Header& header() const { return raw ? raw->header : compressed->header; }
  };
  using Queue = hyselam::WaitingQueue<Image>;

  template <typename M>
  void subscribeReading(SensorHistory<M>& history, const char* topic, std::uint32_t queue_size);
  void subscribeImages();
  void onImage(const Image& image);
  void onCameraInfo(const sensor_msgs::CameraInfo& info);
  /// Name of the sensor data that an image still waits for; empty if it is complete.
  std::string missingReading(const Image& image) const;
  /// Whether depth images come, and one belongs to that time.
  bool hasDepth(const ros::Time& stamp) const;
  /// The readings nearest to the image's time. @throws hyselam::InputError where there is none.
  SensorReadings readingsFor(const std_msgs::Header& header) const;
  template <typename M>
  typename M::ConstPtr nearest(const SensorHistory<M>& history, const ros::Time& stamp,
                               const char* what) const;
  void use(const Image& image);
  void giveUp(const Image& image, Queue::GivenUp why);

  ros::NodeHandle nh_;
  const ImageInputParams params_;
  const Requirements required_;
  CameraFov fov_;
  CameraPoses& poses_;
  const std::string topic_, log_name_;
  const ImageHandler on_image_;
  const TimeJumpHandler on_time_jump_;
  SensorHistory<sensor_msgs::LaserScan> scans_;
  SensorHistory<sensor_msgs::Image> depths_;
  SensorHistory<sensor_msgs::Imu> imus_;
  SensorHistory<sensor_msgs::MagneticField> fields_;
  ros::Time last_stamp_;
  hyselam::DropCounter drops_;
  std::size_t received_ = 0, used_ = 0, reported_received_ = 0, reported_drops_ = 0;
  hyselam::WaitForTransform<Image> waiting_;
  image_transport::ImageTransport transport_;
  image_transport::Subscriber image_subscriber_;
  std::vector<ros::Subscriber> subscribers_;
};

}  // namespace selovis
