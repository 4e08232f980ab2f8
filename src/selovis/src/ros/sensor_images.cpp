#include "selovis/ros/sensor_images.hpp"

#include <cv_bridge/cv_bridge.h>
#include <sensor_msgs/image_encodings.h>

#include <cmath>
#include <limits>
#include <opencv2/core.hpp>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/pose2.hpp"
#include "selovis/learning/labeled_frames.hpp"

namespace selovis {
namespace {

namespace encodings = sensor_msgs::image_encodings;

/// cv_bridge does not check the size of a message.
void checkSize(const sensor_msgs::Image& msg, const std::string& source) {
  if (msg.width == 0 || msg.height == 0 || msg.width > 100000 || msg.height > 100000) {
    throw hyselam::InputError(source, "",
                              "an image of " + std::to_string(msg.width) + " x " +
                                  std::to_string(msg.height) + " pixels");
  }
  std::size_t pixel = 0;
  try {
    pixel = static_cast<std::size_t>(encodings::numChannels(msg.encoding) *
                                     encodings::bitDepth(msg.encoding) / 8);
  } catch (const std::exception&) {
    throw hyselam::InputError(source, "encoding '" + msg.encoding + "'", "is not known");
  }
  if (msg.step < msg.width * pixel || msg.data.size() < std::size_t{msg.step} * msg.height) {
    throw hyselam::InputError(source, "",
                              "has " + std::to_string(msg.data.size()) + " bytes, too few for " +
                                  std::to_string(msg.width) + " x " + std::to_string(msg.height) +
                                  " " + msg.encoding);
  }
}

cv::Mat shared(const sensor_msgs::ImageConstPtr& msg, const std::string& encoding,
               const std::string& source) {
  try {
    const cv_bridge::CvImageConstPtr image = cv_bridge::toCvShare(msg, encoding);
    // The image may outlive the message.
    return image->image.clone();
  } catch (const cv_bridge::Exception& e) {
    throw hyselam::InputError(source, "encoding '" + msg->encoding + "'", e.what());
  } catch (const cv::Exception& e) {
    throw hyselam::InputError(source, "encoding '" + msg->encoding + "'", e.err);
  }
}

}  // namespace

cv::Mat fromMsg(const sensor_msgs::ImageConstPtr& msg, const std::string& source) {
  checkSize(*msg, source);
  const bool gray = encodings::isMono(msg->encoding) || msg->encoding == encodings::TYPE_8UC1;
  const bool picture = gray || encodings::isColor(msg->encoding) ||
                       encodings::isBayer(msg->encoding) || msg->encoding == encodings::TYPE_8UC3 ||
                       msg->encoding == encodings::YUV422;
  if (!picture) {
    throw hyselam::InputError(source, "encoding '" + msg->encoding + "'", "is no picture");
  }
  if (msg->encoding == encodings::TYPE_8UC1 || msg->encoding == encodings::TYPE_8UC3) {
    return shared(msg, msg->encoding, source);
  }
  return shared(msg, gray ? encodings::MONO8 : encodings::BGR8, source);
}

cv::Mat fromMsg(const sensor_msgs::CompressedImage& msg, const std::string& source) {
  cv::Mat image = decodeImage(std::string(msg.data.begin(), msg.data.end()), source);
  if (image.depth() != CV_8U) throw hyselam::InputError(source, "", "has not 8 bits");
  return image;
}

cv::Mat depthFromMsg(const sensor_msgs::ImageConstPtr& msg, const std::string& source) {
  checkSize(*msg, source);
  if (msg->encoding == encodings::TYPE_16UC1 || msg->encoding == encodings::MONO16) {
    return shared(msg, msg->encoding, source);
  }
  if (msg->encoding != encodings::TYPE_32FC1) {
    throw hyselam::InputError(source, "encoding '" + msg->encoding + "'", "is no depth");
  }
  const cv::Mat metres = shared(msg, msg->encoding, source);
  cv::Mat depth(metres.size(), CV_16U);
  for (int y = 0; y < metres.rows; ++y) {
    for (int x = 0; x < metres.cols; ++x) {
      const float m = metres.at<float>(y, x);
      depth.at<std::uint16_t>(y, x) =
          m > 0.0f && m < 65.0f ? static_cast<std::uint16_t>(std::lround(1e3f * m)) : 0;
    }
  }
  return depth;
}

std::vector<float> rangesAcross(const sensor_msgs::LaserScan& scan, double fov,
                                double laser_in_camera, int columns) {
  std::vector<float> ranges;
  for (int k = 0; k < columns; ++k) {
    const double bearing =
        std::atan((1.0 - (2.0 * k + 1.0) / columns) * std::tan(0.5 * fov)) - laser_in_camera;
    const double beam =
        scan.angle_increment == 0.0f
            ? -1.0
            : std::round(hyselam::normalizeAngle(bearing - scan.angle_min) / scan.angle_increment);
    const double turned =
        scan.angle_increment == 0.0f
            ? -1.0
            : std::round((hyselam::normalizeAngle(bearing - scan.angle_min) + 2.0 * hyselam::kPi) /
                         scan.angle_increment);
    const double n = static_cast<double>(scan.ranges.size());
    const double at = beam >= 0.0 && beam < n ? beam : turned;
    ranges.push_back(at >= 0.0 && at < n ? scan.ranges[static_cast<std::size_t>(at)]
                                         : std::numeric_limits<float>::quiet_NaN());
  }
  return ranges;
}

}  // namespace selovis
