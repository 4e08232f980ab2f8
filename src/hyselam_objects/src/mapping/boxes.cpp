#include "boxes.hpp"

#include <algorithm>
#include <cmath>

namespace hyselam_objects {
namespace {

/// Length that two intervals of heights have in common [m].
double commonHeight(const ObjectPose& a, const ObjectPose& b) {
  const double low = std::max(a.position.z - 0.5 * a.size[2], b.position.z - 0.5 * b.size[2]);
  const double high = std::min(a.position.z + 0.5 * a.size[2], b.position.z + 0.5 * b.size[2]);
  return high - low;
}

void unite(ObjectInstance& a, const Outline& outline, const ObjectPose& box) {
  const double low =
      std::min(a.pose->position.z - 0.5 * a.pose->size[2], box.position.z - 0.5 * box.size[2]);
  const double high =
      std::max(a.pose->position.z + 0.5 * a.pose->size[2], box.position.z + 0.5 * box.size[2]);
  a.outline = outlineOf(a);
  hyselam_objects::unite(a.outline, outline);
  setGround(*a.pose, boxAround(a.outline));
  a.pose->position.z = 0.5 * (low + high);
  a.pose->size[2] = high - low;
}

}  // namespace

double distance(const Point3& a, const Point3& b) {
  return std::hypot(a.x - b.x, a.y - b.y, a.z - b.z);
}

GroundBox groundOf(const ObjectPose& box) {
  return {box.position.x, box.position.y, box.size[0], box.size[1], box.yaw};
}

void setGround(ObjectPose& box, const GroundBox& ground) {
  box.position.x = ground.x;
  box.position.y = ground.y;
  box.size[0] = ground.length;
  box.size[1] = ground.width;
  box.yaw = ground.yaw;
}

ObjectPose boxOf(const DetectedObject& seen) {
  ObjectPose box{seen.center(),
                 {seen.high.x - seen.low.x, seen.high.y - seen.low.y, seen.high.z - seen.low.z},
                 0.0,
                 {}};
  if (!seen.outline.empty()) setGround(box, boxAround(seen.outline));
  return box;
}

Outline outlineOf(const DetectedObject& seen) {
  return seen.outline.empty() ? outlineOf(groundOf(boxOf(seen))) : seen.outline;
}

Outline outlineOf(const ObjectInstance& object) {
  return object.outline.empty() && object.pose ? outlineOf(groundOf(*object.pose)) : object.outline;
}

void unite(ObjectInstance& a, const ObjectInstance& b) {
  unite(a, outlineOf(b), *b.pose);
}

void unite(ObjectInstance& a, const DetectedObject& b) {
  unite(a, outlineOf(b), boxOf(b));
}

double footprintOverlap(const ObjectPose& a, const ObjectPose& b) {
  const double least = std::min(a.size[0] * a.size[1], b.size[0] * b.size[1]);
  return least > 0.0 ? commonArea(groundOf(a), groundOf(b)) / least : 0.0;
}

double containedFraction(const ObjectPose& a, const ObjectPose& b) {
  const double area = std::max(a.size[0] * a.size[1], 1e-9);
  return commonArea(groundOf(a), groundOf(b)) / area * std::max(0.0, commonHeight(a, b)) /
         std::max(a.size[2], 1e-6);
}

bool isWithinFootprint(const ObjectPose& box, const Point3& p, double margin) {
  const double c = std::cos(box.yaw), s = std::sin(box.yaw);
  const double dx = p.x - box.position.x, dy = p.y - box.position.y;
  return std::abs(c * dx + s * dy) < 0.5 * box.size[0] + margin &&
         std::abs(c * dy - s * dx) < 0.5 * box.size[1] + margin;
}

bool contains(const ObjectPose& box, const Point3& p) {
  return isWithinFootprint(box, p) && std::abs(p.z - box.position.z) < 0.5 * box.size[2];
}

bool areAtSameSpot(const ObjectPose& a, const ObjectPose& b) {
  return isWithinFootprint(a, b.position) && isWithinFootprint(b, a.position) &&
         commonHeight(a, b) > 0.5 * std::min(a.size[2], b.size[2]);
}

}  // namespace hyselam_objects
