// Keyframes by where they are.
#pragma once

#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "ngram_slam/slam/slam_types.hpp"

namespace ngram_slam {

/// Of keyframes whose poses do not change.
class KeyframeGrid {
 public:
  /// `cell`: side [m], about the radius that is asked for.
  KeyframeGrid(const std::vector<SlamKeyframe>& keyframes, double cell)
      : keyframes_(keyframes), cell_(cell) {
    for (std::size_t k = 0; k < keyframes.size(); ++k) {
      cells_[keyOf(cellOf(keyframes[k].pose.x), cellOf(keyframes[k].pose.y))].push_back(
          static_cast<int>(k));
    }
  }

  /// Calls `use(keyframe, distance)` for all nearer than `radius` [m]; in the same order each time.
  template <typename Use>
  void forEachNear(const hyselam::Pose2& pose, double radius, Use use) const {
    for (auto y = cellOf(pose.y - radius); y <= cellOf(pose.y + radius); ++y) {
      for (auto x = cellOf(pose.x - radius); x <= cellOf(pose.x + radius); ++x) {
        const auto found = cells_.find(keyOf(x, y));
        if (found == cells_.end()) continue;
        for (const int k : found->second) {
          const double d = distance(keyframes_[static_cast<std::size_t>(k)].pose, pose);
          if (d < radius) use(k, d);
        }
      }
    }
  }

 private:
  std::int64_t cellOf(double x) const { return static_cast<std::int64_t>(std::floor(x / cell_)); }
  static std::uint64_t keyOf(std::int64_t x, std::int64_t y) {
    return (static_cast<std::uint64_t>(x) << 32U) ^ (static_cast<std::uint64_t>(y) & 0xffffffffU);
  }

  const std::vector<SlamKeyframe>& keyframes_;
  double cell_;
  std::unordered_map<std::uint64_t, std::vector<int>> cells_;
};

}  // namespace ngram_slam
