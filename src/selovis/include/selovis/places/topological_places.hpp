// The places of the augmented topological map: their names, what a camera at a pose is expected to
// see, and where a recognized place is.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hyselam_common/pose2.hpp"
#include "hyselam_topological_map/topological_map.hpp"
#include "selovis/places/place_transitions.hpp"

namespace selovis {

/// The map's places by name (hyselam_topo::nameOf) and its edges. Places of one name become one.
PlaceTransitions transitionsOf(const hyselam_topo::AugmentedTopologicalMap& map);

/// Reads a topological map (XML, plain or gzip: its first character is '<'), else what
/// readPlaceTransitions() reads. @throws hyselam::InputError.
PlaceTransitions readTopology(const std::string& path);

/// Names of the places around a point of the map: that of the point first, then those within
/// `radius` [m] of it. Empty off the map and for a map without a grid of places.
std::vector<std::string> placesNear(const hyselam_topo::AugmentedTopologicalMap& map,
                                    hyselam::Point2 point, double radius);

/// Places that the camera is expected to see at a point of the map; learned places by index.
struct ExpectedPlaces {
  std::string
      own;  ///< name of the place at the point, or of the nearest; empty: none in the radius
  /// Places that agree with the point: its own, those within the radius, and all virtual places of
  /// their rooms, whose extent is not known. Empty if neither the point's own place nor, for a
  /// virtual one, the room around it was learned: nothing is expected then.
  std::vector<int> agreeing;
  /// Learned places that are not on the map. They may be a part of any place, so seeing one is
  /// evidence neither for nor against the point.
  std::vector<int> unmapped;
};
ExpectedPlaces expectedPlaces(const hyselam_topo::AugmentedTopologicalMap& map,
                              const PlaceTransitions& learned, hyselam::Point2 point,
                              double radius);

/// Places whose name has changed: the same id in both maps with a center that has moved by less
/// than 0.5 m, and no place of `after` has the old name. (Ids alone may be those of another
/// building.)
std::vector<PlaceRenaming> renamedPlaces(const hyselam_topo::AugmentedTopologicalMap& before,
                                         const hyselam_topo::AugmentedTopologicalMap& after);

/// The distribution of a pose of which only the place is known.
struct PlacePosePrior {
  hyselam::Pose2 mean;
  hyselam::Pose2 stddev;  ///< along x and y of the map [m]; theta: pi, any heading
};

/// Mean and standard deviation of the cells of all places of that name; empty if it has none.
std::optional<PlacePosePrior> posePriorOf(const hyselam_topo::AugmentedTopologicalMap& map,
                                          const std::string& name);

}  // namespace selovis
