// Lists of images with their places, and image files, read with every mistake named.
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "selovis/descriptor.hpp"
#include "selovis/samples.hpp"

namespace selovis {

struct LabelledFrame {
  std::string image;  ///< path of the image file
  std::string place;
  std::string depth;  ///< path of a depth image; may be empty
  Readings readings;
  hyselam::Pose2 pose = kNoPose;  ///< of the camera in the map
  std::size_t line = 0;           ///< where in the list
};

/// CSV, one row per frame in time order: image_path, place, then sensor columns. Paths are relative
/// to the list. A header line names the columns in any order: `image_path` (or `image`, `file`,
/// `path`), `place`, `depth_path`, `psi` [rad], `mag_x`, `mag_y`, `mag_z`, `range_0` .. (across the
/// image, left to right [m]), `scan_0` .. (the laser, right to left [m]), `stamp` [s], `x`, `y`,
/// `theta` (camera in the map [m, rad]: learnt, never asked for), `odom_x`, `odom_y`, `odom_theta`
/// (camera in the frame of odometry); others are passed over. Cells with commas or quotation marks
/// stand between quotation marks, a mark within them is doubled (RFC 4180; no line breaks).
/// Without a header the third column and those after it are ranges. Empty cells: no value. Throws
/// hyselam::InputError with the line.
std::vector<LabelledFrame> readLabels(const std::string& path);

/// A cell as readLabels() reads it: between quotation marks where it must be.
std::string csvCell(const std::string& text);

/// An 8-bit image file as it is stored, 1 or 3 channels. A file that was cut short is refused:
/// decoders would fill in grey. Throws hyselam::InputError.
cv::Mat readImage(const std::string& path);

/// The same from the bytes of a file; `source` begins the message.
cv::Mat decodeImage(const std::string& bytes, const std::string& source);

/// The frame's readings, with distances taken from its depth image if it has one and no ranges.
/// Throws hyselam::InputError.
Readings readingsOf(const LabelledFrame& frame);

}  // namespace selovis
