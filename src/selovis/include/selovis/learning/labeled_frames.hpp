// Lists of images labeled with their places, and image files.
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "selovis/classifiers/samples.hpp"
#include "selovis/descriptors/descriptor.hpp"

namespace selovis {

struct LabeledFrame {
  std::string image;  ///< path of the image file
  std::string place;
  std::string depth;  ///< path of a depth image; may be empty
  SensorReadings readings;
  hyselam::Pose2 pose = kNoPose;  ///< of the camera in the map
  std::size_t line = 0;           ///< in the list, from 1 on
};

/// Reads CSV, one row per frame in time order: image_path, place, then sensor columns. Paths are
/// relative to the list. A header line names the columns in any order:
///
/// | column | meaning |
/// |---|---|
/// | image_path (image, file, path), place | required |
/// | depth_path | depth image, 16 bits, in mm |
/// | psi | heading against north [rad] |
/// | mag_x, mag_y, mag_z | magnetic field |
/// | range_0 .. | ranges across the image, left to right [m] |
/// | scan_0 .. | the laser scan, right to left [m] |
/// | stamp | time [s] |
/// | x, y, theta | camera in the map [m, rad]: only used for learning |
/// | odom_x, odom_y, odom_theta | camera in the odometry frame [m, rad] |
///
/// Other columns are ignored; without a header the third column and those after it are ranges.
/// Cells with commas or quotation marks stand between quotation marks, a mark within them is
/// doubled (RFC 4180; no line breaks). Empty cells: no value.
/// @throws hyselam::InputError with the line.
std::vector<LabeledFrame> readLabeledFrames(const std::string& path);

/// A cell as readLabeledFrames() reads it: between quotation marks where needed.
std::string csvCell(const std::string& text);

/// An image file of 8 bits and 1 or 3 channels, as it is stored. A truncated file is refused:
/// decoders would fill it up with gray. @throws hyselam::InputError.
cv::Mat readImage(const std::string& path);

/// The same from the bytes of a file; `source` begins the message. @throws hyselam::InputError.
cv::Mat decodeImage(const std::string& bytes, const std::string& source);

/// The frame's readings, with ranges from its depth image if it has one and no ranges.
/// @throws hyselam::InputError.
SensorReadings readingsOf(const LabeledFrame& frame);

}  // namespace selovis
