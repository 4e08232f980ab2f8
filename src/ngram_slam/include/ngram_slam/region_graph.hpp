// The topological graph of a way: one node per region, tied where the robot went from one into the
// other and where it recognised a place (Maffei 2017, 5.2.4).
#pragma once

#include <vector>

#include "ngram_slam/semantic_segmenter.hpp"
#include "ngram_slam/slam_types.hpp"

namespace ngram_slam {

struct RegionNode {
  SemanticRegion region;  ///< observations counted over all runs
  std::uint32_t run = 0;
  hyselam::Pose2 pose;  ///< of the base in its middle, in the map
};

struct RegionLink {
  std::size_t a = 0, b = 0;  ///< nodes, a < b
  bool loop = false;         ///< one place at different times, else one after the other
};

struct RegionGraph {
  std::vector<RegionNode> nodes;  ///< in the order of the way
  std::vector<RegionLink> links;  ///< each pair at most once per kind; ways first
};

/// `regions` in the order of the way; those whose observations have no keyframe yet are left out.
RegionGraph regionGraph(const std::vector<SemanticRegion>& regions,
                        const std::vector<SlamKeyframe>& keyframes,
                        const std::vector<SlamLoop>& loops,
                        const std::vector<std::int32_t>& keyframe_of_observation);

}  // namespace ngram_slam
