// State of SLAM as plain values: keyframes, the edges between them, loop closures, n-gram matches.
//
// Terms (those of words: ngram_matcher.hpp):
// - Run: one uninterrupted drive, with an odometry frame of its own. Session: the runs since the
//   process began, or those of one saved map.
// - Map: the runs that loops join (RunConnections). Poses of two maps cannot be compared.
// - Tie: loops between a run, or a map, and another one, which make them one map.
// - Near loop: the graph knows where to look, and one scan decides. Far loop: it does not; a wide
//   search found the place, which counts when other far loops agree (far_loops.hpp).
// - Place: what is around a keyframe, as something to be recognized: by words (WordPlaces), by
//   signatures (SignaturePlaces), or by the last metres of a run on a drawn map (KnownMaps).
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "hyselam_common/laser_scan.hpp"
#include "hyselam_pose_graph/pose_graph.hpp"
#include "hyselam_scan_matching/surface_points.hpp"
#include "ngram_slam/words/corpus.hpp"
#include "ngram_slam/words/density_word.hpp"

namespace ngram_slam {

/// A scan that is a node of the pose graph.
struct SlamKeyframe {
  double stamp = 0.0;        ///< [s]
  hyselam::Pose2 odometry;   ///< base in odom when the scan was taken
  hyselam::Pose2 pose;       ///< base in map, as optimized last
  double path_length = 0.0;  ///< driven by odometry until here, over all runs [m]
  std::uint32_t run = 0;     ///< counted from 0
  std::shared_ptr<const hyselam::LaserScan> scan;  ///< never null; never changed
  std::shared_ptr<const hyselam_scan_matching::SurfacePoints> points;  ///< the scan as surfaces
};

/// Where a scan was taken, as it moves with a keyframe: the scan itself is forgotten.
struct PlacedScan {
  double stamp = 0.0;  ///< [s]
  int keyframe = 0;
  hyselam::Pose2 base_in_keyframe;
};

/// What proposed the place.
enum class LoopSource : std::uint8_t {
  /// Poses, or scans laid on what is known: near and far loops by the graph, starts of runs, places
  /// on drawn maps, loops composed of those of dropped keyframes.
  kProximity,
  kNgram,     ///< a match of words
  kSignature  ///< signatures of places
};

/// A loop of less weight contradicts the others so much that it is not used.
constexpr double kMinLoopWeight = 0.3;

/// A loop closure: a measurement between keyframes that do not follow each other.
struct SlamLoop {
  int older = 0, newer = 0;                               ///< keyframes
  hyselam::Pose2 measured;                                ///< newer in older
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();  ///< see PoseEdge
  LoopSource source = LoopSource::kProximity;
  bool far = false;  ///< found by a wide search, accepted with consistent loops
  /// Fraction of the points on known surfaces, 0..1; 0: no scan bears the loop out (thesis mode, a
  /// start that was told and where nothing fits).
  double inlier_ratio = 0.0;
  /// Of what both segments observed of each other, the fraction on surfaces instead of in free
  /// space, in the direction in which it is less, 0..1.
  double fit = 1.0;
  double weight = 1.0;  ///< by the last optimization, 0..1; below 1: contradicts others
};

/// Whether the map goes by the loop: the last optimization left it enough weight.
inline bool isUsed(const SlamLoop& loop) {
  return loop.weight >= kMinLoopWeight;
}

/// An n-gram match between words of the path, and the result of its verification by scans.
struct SlamMatch {
  std::uint32_t newer = 0, older = 0;           ///< observations
  double stamp_newer = 0.0, stamp_older = 0.0;  ///< [s]
  int level = 0;                                ///< highest level of words in use, from 0
  int n = 0;                                    ///< words of the match
  Direction direction = Direction::kSame;
  double probability = 0.0;
  int keyframe_newer = 0, keyframe_older = 0;
  /// Newer in older keyframe: as verified, else the same place and heading or its opposite.
  hyselam::Pose2 measured;
  bool tried = false;     ///< the scans were compared
  bool verified = false;  ///< the scans fit
  bool accepted = false;  ///< the loop is in the graph
};

/// A cell of the map of which the keyframes that were kept do not tell what all did: what was known
/// when the others were dropped.
struct SettledCell {
  int keyframe = 0;        ///< that it moves with
  hyselam::Point2 center;  ///< in the frame of the keyframe [m]
  float log_odds = 0.0F;   ///< that it is occupied
  std::uint16_t visits = 0, changes = 0;
  std::uint32_t run = 0;  ///< the runs after it come on top
};

/// See SettledCell.
struct SettledMap {
  double cell = 0.05;  ///< side [m], > 0
  std::vector<SettledCell> cells;
};

/// Counts of events.
struct SlamCounters {
  std::uint64_t scans = 0;           ///< added
  std::uint64_t matched = 0;         ///< with the local map
  std::uint64_t relocalized = 0;     ///< of the matched: pose found by a search
  std::uint64_t weak_matches = 0;    ///< of the matched: few points on known surfaces
  std::uint64_t odometry_jumps = 0;  ///< see SlamParams::max_odometry_step
  std::uint64_t optimizations = 0;
  struct Loops {
    std::uint64_t tried = 0, verified = 0, accepted = 0;
  } near, far, words;
  Loops signatures;  ///< since the process began: not saved
};

/// The serialized state. With SlamParams it restores the engine, except for the observations of the
/// last few meters whose full density is pending and the loops whose verification is pending.
struct SlamState {
  std::vector<SlamKeyframe> keyframes;
  std::vector<PlacedScan> scans;  ///< all scans of all runs, keyframes' own too
  std::vector<hyselam_pose_graph::PoseEdge> odometry;  ///< edges between following keyframes
  std::vector<SlamLoop> loops;
  std::vector<SlamLoop> pending_loops;  ///< verified far loops without consistent ones yet
  std::vector<SlamMatch> matches;
  Corpus corpus;
  std::vector<std::int32_t> keyframe_of_observation;  ///< index of a keyframe per observation
  SlamCounters counters;
  SettledMap settled;

  /// Describes an inconsistency (an index out of range, a keyframe without scan or finite pose);
  /// nullptr if there is none.
  const char* error() const;
  /// @throws hyselam::InputError with error().
  void validate() const;
};

}  // namespace ngram_slam
