// Several instances of one object, from views that were too different to be associated.
#pragma once

#include "hyselam_objects/mapping/object_mapper.hpp"

namespace hyselam_objects {

/// Whether a box is no larger than objects of a kind are; nullptr and kinds whose size is not
/// known: it may be of any size.
bool fitsKind(const ObjectPose& box, const GenericObject* kind, double sigma);

/// Merges instances at one spot, and faces of one object of a known kind.
void mergeDuplicates(ObjectMap& map, const ObjectDictionary& dictionary,
                     const MapperParams& params);

/// Whether it is a part of an object, or several objects in one, that was detected now and then.
bool isSpurious(const ObjectMap& map, const ObjectInstance& object,
                const ObjectDictionary& dictionary, const MapperParams& params);

}  // namespace hyselam_objects
