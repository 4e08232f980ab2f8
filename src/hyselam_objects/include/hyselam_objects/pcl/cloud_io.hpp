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
};

/// Reads a PCD file (ASCII, binary, compressed) with the fields x, y, z as 32-bit floats, and rgb,
/// rgba and label if they are there.
/// @throws hyselam::InputError for a file that is missing, is no PCD, is cut short, lacks a
///         coordinate or holds no point.
CloudFile readPcd(const std::string& path);

/// Writes x, y, z, rgb (if known) and label, binary compressed, as a whole or not at all.
/// @throws hyselam::InputError if the file cannot be written.
void writePcd(const std::string& path, const OrganizedCloud& cloud,
              const std::vector<std::uint32_t>& labels);

}  // namespace hyselam_objects
