// Saves the state of SLAM to a file and loads it, to continue a saved map.
#pragma once

#include <string>

#include "ngram_slam/slam/slam_params.hpp"
#include "ngram_slam/slam/slam_types.hpp"

namespace ngram_slam {

/// Layout (little-endian): "NGRAMSLM", version u32, length of the body u64, CRC-32 of these; body;
/// CRC-32 of the body. Older versions are still read: version 1 has no SlamLoop::fit (the least
/// that verified loops have is taken), version 2 no settled map, version 3 one run for all settled
/// cells. Scans are stored as they were measured; surfaces are made of them on loading.
class SlamStateFile {
 public:
  static constexpr std::uint32_t kVersion = 4;

  /// Atomic: a reader sees the old file or the new one.
  /// @throws hyselam::InputError when the place cannot be written.
  static void save(const std::string& path, const SlamState& state);
  /// `surface`: SlamParams::surface of the engine that continues the map.
  /// @throws hyselam::InputError naming file, place and reason for a file that is missing, no such
  /// file, of another version, cut short, damaged, or inconsistent.
  static SlamState load(const std::string& path,
                        const hyselam_scan_matching::SurfacePointParams& surface);
};

}  // namespace ngram_slam
