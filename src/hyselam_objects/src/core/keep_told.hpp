// When two instances become one, what people have told of either holds for that one.
#pragma once

#include "hyselam_objects/object_map.hpp"

namespace hyselam_objects {

/// Relations that were told of `from` are told of `to`; where `to` is, is not changed once known.
void keepTold(Id from, Id to, ObjectMap* map);

}  // namespace hyselam_objects
