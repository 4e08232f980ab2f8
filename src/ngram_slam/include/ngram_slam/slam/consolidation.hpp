// A map of many visits becomes as large as the building, not as the years.
#pragma once

#include "hyselam_common/parameters.hpp"
#include "ngram_slam/slam/present_map.hpp"
#include "ngram_slam/slam/redundant_keyframes.hpp"
#include "ngram_slam/slam/redundant_observations.hpp"
#include "ngram_slam/slam/slam_types.hpp"

namespace ngram_slam {

struct ConsolidationParams {
  bool enabled = true;
  RedundancyParams keyframes;
  /// Loops are counted by pairs of pieces of path of this length [m], > 0.
  double place_length = 2.0;
  int max_loops = 2;  ///< between two such pieces, >= 1; more are averaged
  /// A piece that ends so many loops gets no more from dropped keyframes to pieces of its own run
  /// that it had none to, >= 1: without a limit they would grow with every visit.
  int max_place_loops = 12;
  ObservationRedundancyParams observations;
  /// Scans whose poses are remembered, the newest; those of the last run always are. 0: all.
  int max_scans = 50000;
  PresentMapParams present;    ///< what is remembered of dropped keyframes, see SettledCell
  double settled_cell = 0.05;  ///< [m], 0.01..1
  /// How maps are drawn of scans, but for the side of their cells: what is settled must be what
  /// was shown. Not described: it is what the parameters of the map say.
  hyselam::OccupancyMapperParams map;

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError
  void validate() const;
};

/// The state without the keyframes of later runs that add nothing to what earlier ones saw (see
/// redundantKeyframes()). A state of one run is returned as it is, and so is one that was
/// consolidated before. Poses of keyframes and of scans stay where they are.
///
/// Where the map as it is now would be another one without the dropped keyframes, it is settled:
/// SlamState::settled, which moves with the keyframes.
///
/// What dropped keyframes said of the others stays in the graph: their edges are marginalized (see
/// marginalizedEdges()), loops that have lost their weight are left out. Their scans, and the
/// observations and matches that no other run has there (see redundantObservations()), go to the
/// nearest keyframe that stays.
///
/// To be called between runs: a state of which a run goes on loses nothing that it needs, but the
/// engine would have to be made again. A map that is too large to be drawn is not settled.
/// Deterministic. @throws hyselam::ParameterError, hyselam::InputError for a state that is not
/// consistent.
SlamState consolidated(SlamState state, const ConsolidationParams& params = {});

}  // namespace ngram_slam
