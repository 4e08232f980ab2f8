// Furniture in the object map: what belongs to a piece of it or lies on it is no piece of its own.
#pragma once

#include "hyselam_objects/object_map.hpp"

namespace hyselam_objects {

/// Whether something lies in the body of a piece of furniture: a part of it that was not told from
/// it.
bool isPartOfFurniture(const ObjectMap& map, const Point3& p);

/// Whether a level surface is that of things on a piece of furniture other than `except`.
bool isOnFurniture(const ObjectMap& map, const ObjectPose& top, Id except = 0);

/// Takes out tops of things that were taken for furniture while that which carries them was out of
/// view.
void dropTopsOfThings(ObjectMap* map);

/// Makes parts of one top one piece.
void joinFurniture(ObjectMap* map);

}  // namespace hyselam_objects
