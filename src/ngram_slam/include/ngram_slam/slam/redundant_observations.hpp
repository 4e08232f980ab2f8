// Which observations of density later visits made where the words of others are known.
#pragma once

#include <vector>

#include "hyselam_common/parameters.hpp"
#include "ngram_slam/slam/slam_types.hpp"

namespace ngram_slam {

/// When words of a stretch of path say what those of another run say.
struct ObservationRedundancyParams {
  double observation_radius = 1.0;  ///< observations this near are of the same place [m], > 0
  /// Fewer of them in a row make no n-gram: a stretch so short is not worth remembering where
  /// others were, >= 1.
  int min_observations = 50;

  void describe(hyselam::ParameterVisitor& visit);
};

/// The observations to forget, true for each: those made at `dropped` keyframes (true for each
/// keyframe) where another run has some that stay, and what is left of a run between them in
/// stretches that are too short. Only what lies in the same part of the graph counts: by keyframe,
/// `components`. Another run's observations are within the radius when one is forgotten; that run
/// may lose these in turn where a third has some. The newest runs are judged first, so that of two
/// visits the words of the earlier one stay.
std::vector<bool> redundantObservations(const SlamState& state, const std::vector<bool>& dropped,
                                        const std::vector<int>& components,
                                        const ObservationRedundancyParams& params);

}  // namespace ngram_slam
