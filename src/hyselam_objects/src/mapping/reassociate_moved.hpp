// Objects that are gone and objects of the same appearance that are new elsewhere are the same,
// moved.
#pragma once

#include "hyselam_objects/mapping/object_mapper.hpp"

namespace hyselam_objects {

/// Of objects that look alike it cannot be decided which is which, only that as many are gone as
/// are new. All are paired at once: by the sum of the descriptor distances, then by the shortest
/// moves. An object that was seen for the first time soon after the other one was seen for the last
/// time, compared with the time until `now` [s], was there already: it takes time to be moved.
void reassociateMoved(ObjectMap& map, double now, const MapperParams& params);

}  // namespace hyselam_objects
