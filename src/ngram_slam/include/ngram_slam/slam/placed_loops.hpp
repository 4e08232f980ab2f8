// Loops at places that were found on drawn maps (KnownMaps): of a run that begins in a known map,
// and between the maps of several sessions.
#pragma once

#include <vector>

#include "ngram_slam/slam/known_maps.hpp"
#include "ngram_slam/slam/run_connections.hpp"
#include "ngram_slam/slam/slam_params.hpp"
#include "ngram_slam/slam/slam_types.hpp"

namespace ngram_slam {

/// Path that is laid on drawn maps [m]; over more, even refined odometry bends.
constexpr double kSubmapPath = 10.0;
/// Around a place that was found the scans are asked within this window [m], [rad].
constexpr double kPlaceWindow = 0.5, kPlaceAngle = 0.15;

/// The scans along `length` [m] of path before keyframe `last`, of its run, the newest last.
std::vector<SubmapScan> lastMetres(const std::vector<SlamKeyframe>& keyframes, int last,
                                   double length = kSubmapPath);

/// A verified loop to a place found on a drawn map.
struct PlacedLoop {
  SlamLoop loop;
  double place_probability = 0.0;  ///< KnownPlace::probability
};

/// Whether no other place rivals that of the loop (RunStartParams::sure_place_probability), it and
/// what the scans say together leave no doubt (min_tie_probability), and nothing of `others`
/// contradicts it. `found_otherwise`: loops that the search of drawn maps did not find, which may
/// support it; along a corridor that search finds the same again, right or wrong.
bool isSurePlace(const PlacedLoop& placed, const std::vector<SlamLoop>& others,
                 const std::vector<SlamLoop>& found_otherwise,
                 const std::vector<SlamKeyframe>& keyframes, const RunConnections& connections,
                 const SlamParams& params);

}  // namespace ngram_slam
