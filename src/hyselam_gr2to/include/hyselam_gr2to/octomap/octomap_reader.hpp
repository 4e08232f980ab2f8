// OctoMaps as plain lists of cubes, from files (.bt, .ot) and from the data of octomap_msgs.
//
// Parsed here and not by liboctomap, whose readers do not check the data: a damaged or malicious
// file makes them recurse without end. The result is the same (tested).
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace hyselam_topo {

/// A cube of equal occupancy: cells x .. x + size - 1 along x, and so on. Cell i covers
/// [i, i + 1) * resolution.
struct VoxelLeaf {
  std::int32_t x = 0;
  std::int32_t y = 0;
  std::int32_t z = 0;
  std::int32_t size = 1;
  float probability = 0.0f;  ///< of being occupied
};

/// Space is unknown where no leaf is.
struct VoxelMap {
  double resolution = 0.1;  ///< side of the smallest cell [m]
  std::vector<VoxelLeaf> leaves;
};

struct OctoMapLimits {
  std::size_t max_bytes = std::size_t{1} << 30;
  std::size_t max_leaves = std::size_t{1} << 25;
};

/// Reads a file of type .bt (free and occupied only: probabilities 0 and 1) or .ot (trees of type
/// OcTree and ColorOcTree), which its first line says. @throws hyselam::InputError for a file that
/// cannot be read, another format, damaged, missing or surplus data, or more than the limits allow.
VoxelMap loadOctoMap(const std::string& path, const OctoMapLimits& limits = {});

/// The same for the content of a file.
VoxelMap parseOctoMap(const std::string& bytes, const std::string& source,
                      const OctoMapLimits& limits = {});

/// The same for the fields of octomap_msgs/Octomap.
VoxelMap octoMapFromData(const std::string& data, bool binary, const std::string& id,
                         double resolution, const std::string& source,
                         const OctoMapLimits& limits = {});

}  // namespace hyselam_topo
