// Geometry of boxes around objects; they stand upright and may be turned.
#pragma once

#include "hyselam_objects/mapping/object_map.hpp"
#include "hyselam_objects/segmentation/detect_objects.hpp"

namespace hyselam_objects {

/// Between two points [m].
double distance(const Point3& a, const Point3& b);

/// The footprint of a box.
GroundBox groundOf(const ObjectPose& box);
/// Gives a box another footprint.
void setGround(ObjectPose& box, const GroundBox& ground);

/// Turned as the object is; aligned with the axes of the map if its outline is not known.
ObjectPose boxOf(const DetectedObject& seen);
/// Its outline, or that of its box.
Outline outlineOf(const DetectedObject& seen);
Outline outlineOf(const ObjectInstance& object);

/// Enlarges the first object to the box around both.
void unite(ObjectInstance& a, const ObjectInstance& b);
void unite(ObjectInstance& a, const DetectedObject& b);

/// Intersection of the footprints of two boxes over the area of the smaller one, 0 .. 1.
double footprintOverlap(const ObjectPose& a, const ObjectPose& b);

/// Share of the first box's volume that lies in the second one, 0 .. 1.
double containedFraction(const ObjectPose& a, const ObjectPose& b);

/// Whether a point lies over or under the box (with a margin of 2 cm), or in it.
bool isWithinFootprint(const ObjectPose& box, const Point3& p, double margin = 0.02);
bool contains(const ObjectPose& box, const Point3& p);

/// Whether two boxes overlap so much that they must be of one object, or of a part of it.
bool areAtSameSpot(const ObjectPose& a, const ObjectPose& b);

}  // namespace hyselam_objects
