// Boxes around things, with the directions of the map's axes: how two of them lie to each other.
#pragma once

#include "hyselam_objects/detect_objects.hpp"
#include "hyselam_objects/object_map.hpp"

namespace hyselam_objects {

/// Between two points [m].
double distance(const Point3& a, const Point3& b);

ObjectPose boxOf(const DetectedObject& seen);

/// Makes the first box large enough for both.
void unite(ObjectPose* a, const ObjectPose& b);

/// Share of the smaller one's ground that two boxes have in common.
double overlap(const ObjectPose& a, const DetectedObject& b);

/// Share of the first box's volume that lies in the second one.
double shareWithin(const ObjectPose& a, const ObjectPose& b);

/// Whether a point lies in the box of a thing, seen from above.
bool isOn(const ObjectPose& box, const Point3& p);
bool isIn(const ObjectPose& box, const Point3& p);

/// Whether two boxes are so much in one spot that they must be of one thing, or of a part of it.
bool isSameSpot(const ObjectPose& a, const ObjectPose& b);

}  // namespace hyselam_objects
