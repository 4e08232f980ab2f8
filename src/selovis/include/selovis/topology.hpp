// The augmented topological map as SeLoViS sees it: names that can be learnt, and where they are.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hyselam_common/pose2.hpp"
#include "hyselam_topological_map/topological_map.hpp"
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

/// What the camera of a robot at a point of the map is expected to see; places by their indices in
/// the graph of what was learnt.
struct ExpectedPlaces {
  std::string own;  ///< name of the place at the point, or of the nearest; empty: none in reach
  /// What agrees with the point: its place, places within reach, and all virtual places of their
  /// rooms, since somebody told where such a place is and not where it ends. Empty if neither the
  /// point's place nor, for a virtual one, the room around was learnt: nothing is expected then.
  std::vector<int> agree;
  /// What was learnt and is not on the map. It may be a part of any place, so seeing it speaks
  /// neither for nor against the point.
  std::vector<int> unmapped;
};
ExpectedPlaces expectedPlaces(const hyselam_topo::AugmentedTopologicalMap& map,
                              const PlaceGraph& learnt, hyselam::Point2 point, double reach);

/// Places that people call otherwise than they did: the same in both maps, by id and by a centre
/// that has moved by less than 0.5 m, with another name in `after`, where no place bears the old
/// one. (Ids alone may be those of another building.)
std::vector<Renaming> renamedPlaces(const hyselam_topo::AugmentedTopologicalMap& before,
                                    const hyselam_topo::AugmentedTopologicalMap& after);

/// A guess of the pose of which nothing but the place is known.
struct PlaceSpread {
  hyselam::Pose2 mean;
  hyselam::Pose2 stddev;  ///< along x and y of the map [m]; theta [rad]: any heading
};

/// Mean and deviation of the cells of all places of that name; nothing if it has none.
std::optional<PlaceSpread> spreadOf(const hyselam_topo::AugmentedTopologicalMap& map,
                                    const std::string& name);

}  // namespace selovis
