// The occupancy map of keyframes whose poses optimization moves.
#pragma once

#include <vector>

#include "hyselam_common/occupancy_mapper.hpp"
#include "ngram_slam/slam/slam_types.hpp"

namespace ngram_slam {

/// Inserts keyframes as they come; inserts all of them again after old ones moved.
class KeyframeMapper {
 public:
  /// @throws hyselam::ParameterError
  explicit KeyframeMapper(const hyselam::OccupancyMapperParams& params) : mapper_(params) {}

  /// `revision`: changes whenever poses of earlier keyframes change. `shown`: by run, whether it is
  /// in the map; runs beyond are not.
  /// @throws std::length_error when the map would be too large; what fits remains.
  void update(const std::vector<SlamKeyframe>& keyframes, const std::vector<bool>& shown,
              long revision) {
    if (revision != revision_ || keyframes.size() < inserted_ || shown != shown_) {
      mapper_.clear();
      inserted_ = 0;
      revision_ = revision;
      shown_ = shown;
    }
    while (inserted_ < keyframes.size()) {
      const SlamKeyframe& k = keyframes[inserted_++];
      if (k.run < shown.size() && shown[k.run]) mapper_.insert(k.pose, *k.scan);
    }
  }
  hyselam::OccupancyGrid grid() const { return mapper_.grid(); }

 private:
  hyselam::OccupancyMapper mapper_;
  std::size_t inserted_ = 0;
  std::vector<bool> shown_;
  long revision_ = -1;
};

}  // namespace ngram_slam
