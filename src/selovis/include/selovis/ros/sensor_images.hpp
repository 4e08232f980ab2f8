// Image messages as OpenCV images, laser scans as the readings of a descriptor.
#pragma once

#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/LaserScan.h>

#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

namespace selovis {

/// 8-bit BGR of a color image, 8-bit gray of a gray one.
/// @throws hyselam::InputError for an image without pixels, with fewer bytes than its size needs,
/// or
///   with an encoding that is no picture.
cv::Mat fromMsg(const sensor_msgs::ImageConstPtr& msg, const std::string& source);

/// The same from JPEG, PNG, ...; a truncated one is refused. @throws hyselam::InputError.
cv::Mat fromMsg(const sensor_msgs::CompressedImage& msg, const std::string& source);

/// 16-bit depth in mm from 16UC1 or 32FC1 (m). @throws hyselam::InputError.
cv::Mat depthFromMsg(const sensor_msgs::ImageConstPtr& msg, const std::string& source);

/// Ranges across the image, from its left edge to its right: for each of `columns` columns that of
/// the beam nearest to its middle; NaN where the laser has no beam.
/// @param fov horizontal field of view of the camera [rad]. @param laser_in_camera heading of the
/// laser against the camera [rad].
std::vector<float> rangesAcross(const sensor_msgs::LaserScan& scan, double fov,
                                double laser_in_camera, int columns);

}  // namespace selovis
