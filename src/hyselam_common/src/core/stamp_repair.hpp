// Times of a recorded sequence put in order with as few changes as possible.
#pragma once

#include <cstddef>
#include <vector>

namespace hyselam {

/// The largest time that ros::Time holds [s].
constexpr double kMaxStamp = 4294967295.0;

struct RepairedStamps {
  std::vector<double>
      stamps;  ///< non-decreasing, or strictly increasing; NaN where there is no room
  std::vector<std::size_t> changed;  ///< indices, ascending, of stamps that are not the given ones
};

/// Keeps a longest subsequence of usable (0 .. kMaxStamp) stamps in order; every other stamp is put
/// evenly between its kept neighbours. Before the first and after the last kept stamp the mean step
/// of the kept ones continues. O(n log n).
RepairedStamps repairStamps(const std::vector<double>& stamps, bool strict);

}  // namespace hyselam
