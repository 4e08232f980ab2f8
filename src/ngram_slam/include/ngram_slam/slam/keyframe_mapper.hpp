// The map of keyframes whose poses move now and then.
#pragma once

#include <vector>

#include "hyselam_common/occupancy_mapper.hpp"
#include "ngram_slam/slam/slam_types.hpp"

namespace ngram_slam {

/// Adds keyframes as they come; draws everything anew after old ones moved.
class KeyframeMapper {
 public:
  /// @throws hyselam::ParameterError
  explicit KeyframeMapper(const hyselam::OccupancyMapperParams& params) : mapper_(params) {}

  /// `revision`: changes whenever poses of keyframes given before are others.
  /// @throws std::length_error when the map would be too large; what fits remains.
  void update(const std::vector<SlamKeyframe>& keyframes, long revision) {
    if (revision != revision_ || keyframes.size() < drawn_) {
      mapper_.clear();
      drawn_ = 0;
      revision_ = revision;
    }
    while (drawn_ < keyframes.size()) {
      const SlamKeyframe& k = keyframes[drawn_++];
      mapper_.insert(k.pose, *k.scan);
    }
  }
  hyselam::OccupancyGrid grid() const { return mapper_.grid(); }

 private:
  hyselam::OccupancyMapper mapper_;
  std::size_t drawn_ = 0;
  long revision_ = -1;
};

}  // namespace ngram_slam
