// What a place looks like, whichever way the robot faces: free-space densities of several kernels
// (Maffei 2017, chapter 3), distances of free sight all around, and the surfaces around in rings
// and sectors (a polar context: Kim and Kim, "Scan Context", IROS 2018).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "fsd_localization/density/bit_plane.hpp"
#include "fsd_localization/density/free_space_density.hpp"

namespace ngram_slam {

struct PlaceFeatures {
  static constexpr std::array<double, 4> kBandwidths{1.0, 1.5, 2.5, 4.0};  ///< [m]
  static constexpr std::size_t kBeams = 72;
  static constexpr std::size_t kRings = 20, kSectors = 60;
  static constexpr double kRange = 20.0;  ///< of the context [m]

  std::array<float, kBandwidths.size()> densities{};  ///< 0..1
  std::array<float, kBeams> distances{};              ///< free sight, counter-clockwise from x [m]
  /// Cells on surfaces, [sector][ring].
  std::array<std::array<std::uint16_t, kRings>, kSectors> context{};
};

/// Computes the features of the middle cell of a view. Not thread-safe.
class PlaceFeatureExtractor {
 public:
  /// Views have 2 * reach + 1 cells a side. @throws hyselam::ParameterError
  PlaceFeatureExtractor(double resolution, int reach);
  /// Cells within a robot's radius of the middle count as free: the robot was there.
  void extract(fsd_localization::FreeSpaceGrid* view, PlaceFeatures* features) const;

 private:
  double resolution_;
  int reach_;
  std::vector<fsd_localization::FreeSpaceDensity> kernels_;
  std::vector<std::int16_t> bin_;  // of each cell of a view, sector * kRings + ring; -1: none
};

}  // namespace ngram_slam
