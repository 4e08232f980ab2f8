// Keeps what is known about places, doors and walls when the map is segmented again.
#pragma once

#include <utility>
#include <vector>

#include "hyselam_common/parameters.hpp"
#include "hyselam_topological_map/topological_map.hpp"

namespace hyselam_topo {

struct CarryOverParams {
  /// An old place continues as the new place that covers most of it, if they share at least this
  /// part of the smaller of the two. (0, 1]
  double min_overlap = 0.3;
  /// A door is the same if its middle has moved by no more than this, or half its width. [m] >= 0
  double max_door_shift = 0.5;
  /// A wall is the same if it has moved sideways by no more than this, [m] >= 0, ...
  double max_wall_shift = 0.3;
  /// ... turned by no more than this, [rad] 0 .. pi/2, ...
  double max_wall_turn = hyselam::radians(20.0);
  /// ... and shares at least this part of the shorter of the two. (0, 1]
  double min_wall_overlap = 0.3;

  void describe(hyselam::ParameterVisitor& visit);
  void validate() const;  ///< @throws hyselam::ParameterError
};

/// Report on the places: which ids continue, are new, merged, split off or lost.
struct CarryOverReport {
  std::vector<Id> kept;                      ///< old ids that continue
  std::vector<Id> created;                   ///< new ids
  std::vector<std::pair<Id, Id>> merged;     ///< (old id, id of the place that contains it now)
  std::vector<std::pair<Id, Id>> split_off;  ///< (created id, old id of the place around it)
  std::vector<Id> lost;                      ///< old ids without a successor
};

/// The new map with the ids, words, signatures and extras of the old one.
///
/// Where places, walls and doors are comes from `fresh`; its ids are ignored. Both maps need a
/// grid (their geometries may differ) in one frame. Places continue by the share of cells that they
/// have in common: of a place that is split the largest part keeps the id, of places that are
/// merged the named one (confirmed before guessed), else the oldest, and the words and signatures
/// of all are united. Doors keep id, state, height, appearance, walls keep id and height. Kept from
/// the old map although `fresh` does not have them: virtual places and their edges, words of
/// edges (without a door if it is gone), and walls of glass, which range sensors do not detect,
/// as long as their place exists. Ids are never reused. Equal input gives equal output; a map
/// carried over to itself is unchanged.
///
/// @throws hyselam::InputError for maps that checkMap() refuses or without a grid,
/// hyselam::ParameterError for parameters out of range.
AugmentedTopologicalMap carryOver(const AugmentedTopologicalMap& old,
                                  const AugmentedTopologicalMap& fresh,
                                  const CarryOverParams& params = {});
/// The same, with a report on the places.
AugmentedTopologicalMap carryOver(const AugmentedTopologicalMap& old,
                                  const AugmentedTopologicalMap& fresh,
                                  const CarryOverParams& params, CarryOverReport& report);

}  // namespace hyselam_topo
