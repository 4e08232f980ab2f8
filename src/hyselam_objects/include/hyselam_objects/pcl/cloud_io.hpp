// Point clouds in PCD files.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hyselam_objects/segmentation/organized_cloud.hpp"

namespace hyselam_objects {

/// A cloud as stored in a file. `cloud.height` is 1 for one that is not organized.
struct CloudFile {
  OrganizedCloud cloud;
  std::vector<std::uint32_t> labels;  ///< field `label`; empty: the file has none
  std::vector<Point> seen_from;       ///< fields vp_x, vp_y, vp_z [m]; empty: the file has none
};

/// Reads a PCD file (ASCII, binary, compressed) with the fields x, y, z as 32-bit floats, and rgb,
/// rgba, label, and vp_x, vp_y, vp_z (PCL's viewpoint of a point) if they are there.
/// @throws hyselam::InputError for a file that is missing, is no PCD, is cut short, lacks a
///         coordinate or holds no point.
CloudFile readPcd(const std::string& path);

/// Writes x, y, z, rgb (if known), vp_x, vp_y, vp_z (if given) and label, binary compressed, as a
/// whole or not at all.
/// @throws hyselam::InputError if the file cannot be written.
void writePcd(const std::string& path, const OrganizedCloud& cloud,
              const std::vector<std::uint32_t>& labels, const std::vector<Point>& seen_from = {});

}  // namespace hyselam_objects
