// What a value of a grid map means.
#pragma once

namespace fsd_localization {

/// Thresholds on map values; a value between the two, or negative, is unknown.
struct OccupancyThresholds {
  int free_below = 25;     ///< free: 0 <= value < free_below
  int occupied_from = 65;  ///< occupied: value >= occupied_from

  bool isFree(int value) const { return value >= 0 && value < free_below; }
  bool isOccupied(int value) const { return value >= occupied_from; }
};

}  // namespace fsd_localization
