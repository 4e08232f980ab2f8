// Which runs lie in one map: those that loops join.
#pragma once

#include <cstdint>
#include <vector>

#include "ngram_slam/slam/slam_types.hpp"

namespace ngram_slam {

/// A map is a set of runs that loops join, directly or by other runs; it has the name of its first
/// run. Poses of keyframes can be compared within a map only: what lies between two maps is not
/// known, whatever their poses say.
class RunConnections {
 public:
  /// Each run is a map of its own.
  RunConnections() = default;
  /// Of the loops that are used (isUsed()).
  RunConnections(const std::vector<SlamKeyframe>& keyframes, const std::vector<SlamLoop>& loops);

  void connect(std::uint32_t a, std::uint32_t b);
  bool connected(std::uint32_t a, std::uint32_t b) const { return mapOf(a) == mapOf(b); }
  /// The first run of the map that a run belongs to.
  std::uint32_t mapOf(std::uint32_t run) const;

 private:
  std::vector<std::uint32_t> first_;  // an earlier run of its map, or itself; by run
};

/// Takes the loops between a run and all others out of `loops`.
std::vector<SlamLoop> loopsWithinRuns(const std::vector<SlamLoop>& loops,
                                      const std::vector<SlamKeyframe>& keyframes,
                                      std::uint32_t run);

}  // namespace ngram_slam
