// Maps of several sessions or robots, of which nobody knows how they lie to each other, become one
// map with one graph, as far as their places are recognized.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "hyselam_common/parameters.hpp"
#include "ngram_slam/slam/slam_params.hpp"
#include "ngram_slam/slam/slam_types.hpp"

namespace ngram_slam {

/// All numbers were chosen on intel, aces and mit-killian cut into pieces (bench/merge_maps): in
/// sample there; those of places on seed 1 of intel and mit-killian.
struct MapMergingParams {
  SlamParams slam;  ///< of the engines that made the maps and that will go on with the result
  int threads = 1;  ///< that verify loops, >= 1; the result does not depend on it
  /// Places of one map that are asked for in all others: one each so many metres of path, with the
  /// best so many candidates; first few, then more where the map is not tied yet or the graph knows
  /// little. [m] and > 0; >= 1.
  double first_interval = 4.0;
  int first_candidates = 3;
  double second_interval = 2.0;
  int second_candidates = 5;
  /// Around a verified loop between maps that are not tied, each place is asked for on so much path
  /// before and after it [m], >= 0.
  double ask_around = 8.0;
  /// Two maps are not tied if there is another tie with more than this part of the support of the
  /// best one, 0..1: see bestTie().
  double max_rival = 0.5;
  /// A tie is borne out if at least this part of the near loops that are tried along both paths,
  /// farther from its first loop than the segments that verified that one, fit, 0..1.
  double min_near_ratio = 0.55;
  /// ... of at least so many, >= 1; of fewer nothing can be said, and the maps are not tied.
  int min_near_tried = 12;
  /// Path between stretches of a map (of 10 m) that are laid on the others as they are drawn [m],
  /// >= 0; 0: none is, as a building that repeats itself was tied wrongly by them (mit-killian in
  /// docs/reports/2026-11-27-life-long.md).
  double place_interval = 0.0;
  /// A tie by places is borne out if at least this part of the scans along the common path that say
  /// something fit, 0..1, of min_near_tried or more.
  double min_place_near_ratio = 0.8;
  /// Of two sessions that share more than this part of the keyframes of the smaller one, 0..1, that
  /// one is left out: both hold the same recording.
  double max_shared_keyframes = 0.1;

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError
  void validate() const;
};

/// A saved map, by its name.
struct MapSession {
  std::string name;
  SlamState state;
};

/// A session that is not in the result, and why.
struct LeftOutSession {
  std::string name, reason;
};

/// What joins two sessions, or does not.
struct MapMeeting {
  std::size_t a = 0, b = 0;  ///< sessions as given, a < b
  int far_loops = 0;         ///< in the graph
  int near_loops = 0;
  /// Verified by the scans, but not believed: too few, or contradicted.
  int doubted = 0;
  double fit = 0.0;  ///< mean of the far loops, 0..1
};

/// Part of a session in a merged map.
struct MergedPart {
  std::size_t session = 0;                  ///< as given
  std::vector<std::uint32_t> runs;          ///< of the map
  std::vector<std::uint32_t> session_runs;  ///< the same as the session has them, without gaps
  std::vector<hyselam::StampedPose2> trajectory;  ///< of all its scans, in the map
  std::vector<std::size_t> scans;                 ///< their numbers in the session
};

struct MergedMap {
  SlamState state;
  std::vector<MergedPart> parts;  ///< in the order given
};

struct MapMergingCounters {
  int questions = 0;  ///< places of one map asked for in others
  int tried = 0;      ///< far loops
  int verified = 0;   ///< of them
  int near_tried = 0, near_verified = 0;
  int stretches = 0;       ///< laid on the drawn maps
  int place_ties = 0;      ///< by places there, not withdrawn
  int ties = 0;            ///< of maps, made
  int ties_withdrawn = 0;  ///< of them: wrong, or not borne out, or tried beside others
};

struct MergedMaps {
  std::vector<MergedMap> maps;       ///< the one of most keyframes first
  std::vector<MapMeeting> meetings;  ///< pairs of which some loop was verified
  std::vector<LeftOutSession> left_out;
  std::vector<LeftOutSession> doubtful;  ///< merged, but of another kind of laser
  MapMergingCounters counters;
};

/// Told now and then: what is done, how much of it. What it throws ends the merging.
using MergingProgress =
    std::function<void(const std::string& step, std::size_t done, std::size_t total)>;

/// Signatures find places of one map in the others (SignaturePlaces), the scans verify them
/// (verifyLoop()), and what SLAM believes of the loops of a run in a known map is believed of those
/// of two maps (believeFarLoops()): three that agree, are likelier right than wrong, and are not
/// contradicted, here by nothing in both maps. The best known tie first; it is borne out
/// by near loops along the common path, which go into the graph, or withdrawn. The graph is
/// optimized with all loops and robustly, as by SlamEngine.
///
/// What is apart then is laid on the other maps as they are drawn (KnownMaps), stretch by stretch,
/// all maps but the largest. Two places that no other one rivals, found by scans of their own
/// at different places of the map, and verified, are a hypothesis of where two maps lie; each one
/// is tried, and the only one that the scans along the common path bear out ties them.
///
/// Sessions without keyframes, that are inconsistent, or that hold a recording of another one are
/// left out. Maps that meet no other come back as they are. Runs of one session that no loop joins
/// are maps of their own here too. The result is consolidated (ConsolidationParams), but forgets no
/// scan. Deterministic, with threads too.
/// @throws hyselam::ParameterError
MergedMaps mergeMaps(std::vector<MapSession> sessions, const MapMergingParams& params = {},
                     const MergingProgress& progress = {});

}  // namespace ngram_slam
