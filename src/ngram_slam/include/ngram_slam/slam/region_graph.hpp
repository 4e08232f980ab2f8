// The topological graph of a path: a node for each region, or evenly spaced nodes where words of
// several levels overlap (Maffei 2017, 4.3.1 and 5.2.4).
#pragma once

#include <cstdint>
#include <vector>

#include "ngram_slam/semantics/semantic_segmenter.hpp"
#include "ngram_slam/slam/slam_engine.hpp"

namespace ngram_slam {

struct RegionNode {
  std::uint32_t first = 0, last = 0;          ///< observations
  double stamp_begin = 0.0, stamp_end = 0.0;  ///< [s]
  std::uint32_t run = 0;
  hyselam::Pose2 pose;  ///< of the base at the median observation, in the map
  double length = 0.0;  ///< of the path in it [m]
  SemanticClass semantic_class = SemanticClass::kCorridor;
  double confidence = 1.0;  ///< 0..1
};

struct RegionEdge {
  enum class Kind : std::uint8_t { kConsecutive, kLoop };
  std::uint32_t a = 0, b = 0;  ///< nodes, a < b
  Kind kind = Kind::kConsecutive;
};

struct RegionGraph {
  std::vector<RegionNode> nodes;
  std::vector<RegionEdge> edges;  ///< each pair and kind once, ordered
};

/// Poses of the observations of the engine's recognizer, in the current map.
std::vector<hyselam::Pose2> observationPoses(const SlamEngine& engine);

/// A node for each semantic region; edges between consecutive ones, and between regions that a loop
/// of the graph connects.
RegionGraph regionGraph(const SlamEngine& engine);
/// The same for regions that are known already: of the engine's observations, in their order.
RegionGraph regionGraph(const SlamEngine& engine, const std::vector<SemanticRegion>& regions);

/// A node every `spacing` [m] of path, so that matches of words of any level find a node near both
/// their ends. @throws hyselam::ParameterError unless spacing > 0.
RegionGraph spacedGraph(const SlamEngine& engine, double spacing = 2.0);

}  // namespace ngram_slam
