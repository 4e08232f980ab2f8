// Furniture in the object map: what belongs to a piece of it or lies on it is no piece of its own.
#pragma once

#include "hyselam_objects/mapping/object_map.hpp"

namespace hyselam_objects {

/// Whether a point lies in the body of a piece of furniture: what is there is a part of it.
bool isPartOfFurniture(const ObjectMap& map, const Point3& p);

/// Whether a box reaches from above into the body of a piece of furniture: it is no object that
/// stands on it or beside it, but a view of both.
bool reachesIntoFurniture(const ObjectMap& map, const ObjectPose& box);

/// Whether a horizontal surface is that of objects on a piece of furniture other than `except`.
bool isOnFurniture(const ObjectMap& map, const ObjectPose& top, Id except = 0);

/// Removes tops of objects that were taken for furniture while the furniture under them was out of
/// view.
void removeTopsOfObjects(ObjectMap& map);

/// Merges parts of one top.
void mergeFurniture(ObjectMap& map);

}  // namespace hyselam_objects
