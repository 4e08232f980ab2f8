// Two instances of one thing, from views that were too different to be taken for it.
#pragma once

#include "hyselam_objects/object_mapper.hpp"

namespace hyselam_objects {

/// Makes instances in one spot, and faces of one thing of a known kind, one instance.
void joinTwins(ObjectMap* map, const ObjectDictionary& dictionary, const MapperParams& params);

/// Whether it is a part of a thing, or several things in one, that was seen now and then.
bool isShadow(const ObjectMap& map, const ObjectInstance& object);

}  // namespace hyselam_objects
