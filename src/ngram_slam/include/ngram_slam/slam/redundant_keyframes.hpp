// Which keyframes of later visits add nothing to a map.
#pragma once

#include <vector>

#include "hyselam_common/parameters.hpp"
#include "ngram_slam/slam/slam_types.hpp"

namespace ngram_slam {

/// When a keyframe says what those of earlier runs say.
struct RedundancyParams {
  double place_radius = 0.5;  ///< keyframes this near are at the same place [m], > 0
  /// Lasers that do not see all around look the same way up to this turn [rad], 0..pi.
  double look_angle = 0.5;
  double surroundings_radius = 2.0;  ///< of the keyframes whose surfaces explain a scan [m], > 0
  int surroundings_keyframes = 12;   ///< the nearest of them, >= 1
  /// A point this near to a surface is explained [m], > 0; where beams are farther apart, it is
  /// their distance more.
  double surface_distance = 0.15;
  double min_explained = 0.9;  ///< part of the points of a scan that is explained, 0..1
  /// Of the surfaces that a scan should see, the part that it does not see through, 0..1.
  double min_seen_again = 0.9;
  /// Runs that a place and direction is kept of where they saw different things: the newest, so
  /// that change can be learnt, and the first, on which the others were laid, >= 1.
  int max_looks = 3;

  void describe(hyselam::ParameterVisitor& visit);
};

/// The keyframes to drop, true for each. Only what a later run saw where an earlier one of the same
/// part of the graph had been: a part of one run keeps all. `fixed`: keyframes that must stay.
/// Dropping those of the answer leaves nothing more to drop.
std::vector<bool> redundantKeyframes(const std::vector<SlamKeyframe>& keyframes,
                                     const std::vector<int>& components,
                                     const std::vector<bool>& fixed,
                                     const RedundancyParams& params);

}  // namespace ngram_slam
