// What a robot finds around it along its way, at several scales: what the kinds of regions of
// furnished buildings are told by. The features of the thesis (semantic_features.hpp) look at one
// kernel of the map at that moment; these look at all that was seen some metres before and after a
// place, and at how it changes along the way.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "hyselam_common/pose2.hpp"
#include "ngram_slam/signatures/place_features.hpp"

namespace ngram_slam {

/// What a place by itself looks like, the same whichever way the robot faces. In the order of
/// wayFeatureNames(): quantiles of the distances of free sight [m]; magnitudes of the spectrum of
/// their logarithms (2 is strong in corridors, 3 and 4 where ways meet); the shortest and longest
/// line of sight through the place and the one across the longest [m]; for circles around it the
/// number of openings, the widest one [deg], the angle between the two widest [deg]; the free-space
/// densities of several kernels; the share of surfaces in what is seen within 4 and 8 m.
constexpr std::size_t kWayShape = 33;
using WayShape = std::array<float, kWayShape>;

WayShape wayShapeOf(const PlaceFeatures& features);

/// A place of a way.
struct WayPlace {
  double way = 0.0;     ///< from the beginning of the run, equal steps [m]
  hyselam::Pose2 pose;  ///< smooth odometry
  WayShape shape{};
};

/// Names of the values of wayFeaturesOf(), in order.
const std::vector<std::string>& wayFeatureNames();

/// For each place of a run: its shape; means of some of its values within 2 and 5 m of way; the
/// lower and the higher of their values 3 m before and after; how straight the way is within 2, 4
/// and 8 m, and how much the robot turns there. The same if the way is driven the other way round.
/// @throws hyselam::ParameterError unless the places follow each other in equal steps.
std::vector<std::vector<float>> wayFeaturesOf(const std::vector<WayPlace>& run);

}  // namespace ngram_slam
