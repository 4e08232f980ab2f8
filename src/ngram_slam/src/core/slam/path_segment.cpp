#include "ngram_slam/slam/path_segment.hpp"

#include <cmath>

namespace ngram_slam {

LoopTask::Segment segmentAround(const std::vector<SlamKeyframe>& keyframes, int k,
                                double half_length, double max_path_length) {
  const auto at = [&](int i) -> const SlamKeyframe& {
    return keyframes[static_cast<std::size_t>(i)];
  };
  const SlamKeyframe& middle = at(k);
  LoopTask::Segment segment;
  const auto belongs = [&](int i) {
    return at(i).run == middle.run &&
           std::abs(at(i).path_length - middle.path_length) <= half_length;
  };
  int first = k;
  while (first > 0 && belongs(first - 1)) --first;
  const auto end = static_cast<int>(keyframes.size());
  for (int i = first; i < end && belongs(i); ++i) {
    const SlamKeyframe& other = at(i);
    if (other.path_length > max_path_length) break;
    segment.push_back({hyselam::between(middle.pose, other.pose),
                       other.points,
                       {other.scan->laser_in_base.x, other.scan->laser_in_base.y}});
  }
  return segment;
}

}  // namespace ngram_slam
