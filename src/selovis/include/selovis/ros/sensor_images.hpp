// Image messages as OpenCV images, laser scans as the readings of a descriptor.
#pragma once

#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/LaserScan.h>

#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

namespace selovis {

/// 8-bit BGR of a colour image, 8-bit grey of a grey one; the pixels are the message's where they
/// need not be turned round. Throws hyselam::InputError: no pixels, fewer bytes than the size says,
/// an encoding that is no picture.
cv::Mat fromMsg(const sensor_msgs::ImageConstPtr& msg, const std::string& source);

/// The same from JPEG, PNG, ...; one that was cut short is refused.
cv::Mat fromMsg(const sensor_msgs::CompressedImage& msg, const std::string& source);

/// 16-bit depth in mm from 16UC1 or 32FC1 (m). Throws as above.
cv::Mat depthFromMsg(const sensor_msgs::ImageConstPtr& msg, const std::string& source);

/// Distances across the image, from its left edge to its right, `columns` of them: what the beam
/// nearest to the middle of each column read. The laser looks the camera's way, turned by
/// `laser_in_camera` [rad]. NaN where no beam looks.
std::vector<float> rangesAcross(const sensor_msgs::LaserScan& scan, double aperture,
                                double laser_in_camera, int columns);

}  // namespace selovis
