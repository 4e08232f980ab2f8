// How much room places have, and have in common with those of another map.
#pragma once

#include <map>
#include <utility>

#include "hyselam_topological_map/topological_map.hpp"

namespace hyselam_topo {

using PlaceAreas = std::map<Id, double>;                  ///< place -> area [m^2], above 0
using SharedAreas = std::map<std::pair<Id, Id>, double>;  ///< (old, new) -> area in common [m^2]

/// Of the cells of each place; a place without a cell is not in it.
PlaceAreas placeAreas(const PlaceGrid& grid);

/// What places of two grids in one frame have in common, at the centres of the new cells. The
/// geometries may differ. Pairs without a common cell are not in it.
SharedAreas sharedAreas(const PlaceGrid& old, const PlaceGrid& fresh);

}  // namespace hyselam_topo
