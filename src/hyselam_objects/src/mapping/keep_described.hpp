// When two instances become one, what people have described of either holds for that one.
#pragma once

#include "hyselam_objects/mapping/object_map.hpp"

namespace hyselam_objects {

/// Copies the described relations of `from` to `to`; a known place of `to` stays.
void keepDescribedRelations(ObjectMap& map, Id from, Id to);

}  // namespace hyselam_objects
