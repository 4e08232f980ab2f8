// Things that are gone and things of the same looks that are new elsewhere are the same, moved.
#pragma once

#include "hyselam_objects/object_mapper.hpp"

namespace hyselam_objects {

/// Of things that look alike it cannot be told which is which; that as many are gone as are new
/// can. All are paired at once: the looks of all pairs together decide, then the shortest ways.
/// What was seen for the first time soon after the other one was seen for the last time, in a long
/// while until `now` [s] that nobody looked, was there already: it takes time to be moved.
void joinMoved(ObjectMap* map, double now, const MapperParams& params);

}  // namespace hyselam_objects
