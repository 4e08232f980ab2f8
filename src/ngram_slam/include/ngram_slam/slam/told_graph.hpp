// The graph of a SLAM that runs elsewhere, as it is told part by part.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "ngram_slam/slam/slam_engine.hpp"
#include "ngram_slam/slam/slam_types.hpp"

namespace ngram_slam {

/// What is known of a graph by who asks for what is new.
struct GraphQuestion {
  std::string map;  ///< as told last
  std::uint32_t keyframes = 0;
  std::uint64_t version = 0;        ///< as told last
  std::uint32_t max_keyframes = 0;  ///< told at once; 0: all
};

struct GraphPart {
  std::string map;          ///< names the map
  std::uint32_t first = 0;  ///< number of the first of `keyframes`
  std::vector<SlamKeyframe> keyframes;
  std::vector<hyselam_pose_graph::PoseEdge> odometry;  ///< that end in them
  bool complete = false;                               ///< there are no more keyframes: then also
  std::uint64_t version = 0;                           ///< of poses and loops
  bool changed = false;               ///< it is not the one asked with: these are told
  std::vector<hyselam::Pose2> poses;  ///< of all keyframes
  std::vector<SlamLoop> loops;        ///< all
  SettledMap settled;                 ///< if no version was asked with
};

/// What is new in the graph of an engine, whose map has that name.
GraphPart newGraphPart(const SlamEngine& engine, const std::string& map,
                       const GraphQuestion& question);

/// What was told so far. Whatever is lost, or refused, is asked for again.
class ToldGraph {
 public:
  /// `surface`: SlamParams::surface.
  explicit ToldGraph(
      const hyselam_scan_matching::SurfacePointParams& surface = SlamParams{}.surface)
      : surface_(surface) {}

  GraphQuestion question(std::uint32_t max_keyframes) const;
  /// Adds the answer to question(). Returns whether state() is a newer one.
  /// @throws hyselam::InputError, beginning with `source`, for a part that does not fit what was
  /// told before or is inconsistent: all is asked for again, state() stays as it was.
  bool add(GraphPart part, const std::string& source);
  /// As told completely last: without words and without scans that are no keyframes.
  const SlamState& state() const { return state_; }
  /// Its name; empty: nothing was told.
  const std::string& map() const { return map_; }

 private:
  bool isAnew(const GraphPart& part) const;
  void begin(const std::string& map);
  void append(GraphPart* part, const std::string& source);

  hyselam_scan_matching::SurfacePointParams surface_;
  GraphQuestion known_;  // what is being told
  SlamState told_;       // of it so far
  std::string map_;
  SlamState state_;
};

}  // namespace ngram_slam
