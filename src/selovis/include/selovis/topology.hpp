// The augmented topological map as SeLoViS sees it: names that can be learnt, and where they are.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hyselam_common/pose2.hpp"
#include "hyselam_topo/topological_map.hpp"
#include "selovis/place_graph.hpp"

namespace selovis {

/// The map's places by name (hyselam_topo::nameOf) and its edges. Places of one name become one.
PlaceGraph graphOf(const hyselam_topo::AugmentedTopologicalMap& map);

/// Reads a graph of places: a topological map (hyselam_topo's XML, plain or gzip, told by its first
/// character '<'), else what readPlaceGraph() reads. Throws hyselam::InputError.
PlaceGraph readTopology(const std::string& path);

/// Names of the places at a point of the map: the one that it lies in first, then those that come
/// within `reach` [m] of it. Empty off the map and for a map without a grid of places.
std::vector<std::string> placesNear(const hyselam_topo::AugmentedTopologicalMap& map,
                                    hyselam::Point2 point, double reach);

/// Indices in `learnt` of the places that a robot may see which stands where `near`, from
/// placesNear(), says: those; all virtual places joined to its own, since somebody told where such
/// a place is, not where it ends; and what the map does not have, which may lie anywhere. Empty if
/// the place of the pose was never learnt: what is seen there says nothing about it.
std::vector<int> placesInSight(const hyselam_topo::AugmentedTopologicalMap& map,
                               const PlaceGraph& learnt, const std::vector<std::string>& near);

/// A guess of the pose of which nothing but the place is known.
struct PlaceSpread {
  hyselam::Pose2 mean;
  hyselam::Pose2 stddev;  ///< along x and y of the map [m]; theta [rad]: any heading
};

/// Mean and deviation of the cells of all places of that name; nothing if it has none.
std::optional<PlaceSpread> spreadOf(const hyselam_topo::AugmentedTopologicalMap& map,
                                    const std::string& name);

}  // namespace selovis
