#include "furniture.hpp"

#include <algorithm>
#include <cmath>

#include "boxes.hpp"
#include "instance_traits.hpp"
#include "keep_described.hpp"

namespace hyselam_objects {
namespace {

bool isPartOf(const ObjectPose& furniture, const Point3& p) {
  constexpr double kMargin = 0.08, kBelowTop = 0.03;
  return isWithinFootprint(furniture, p, kMargin) &&
         p.z < furniture.position.z + 0.5 * furniture.size[2] - kBelowTop;
}

/// Two parts of one top: of the same height, overlapping or hardly apart.
bool isOneTop(const ObjectPose& a, const ObjectPose& b) {
  constexpr double kStep = 0.04, kGap = 0.15;
  const double height = a.position.z + 0.5 * a.size[2] - b.position.z - 0.5 * b.size[2];
  return std::abs(height) < kStep && gapBetween(groundOf(a), groundOf(b)) < kGap;
}

/// Whether a horizontal surface is that of objects on a piece of furniture, not of another piece.
bool isTopOfObjects(const ObjectPose& top, const ObjectPose& furniture) {
  constexpr double kMinStep = 0.03, kMaxStep = 0.6;  // [m], as in SegmentParams
  constexpr double kMargin = 0.05, kMaxArea = 0.7, kMinContained = 0.8;
  const double step =
      top.position.z + 0.5 * top.size[2] - furniture.position.z - 0.5 * furniture.size[2];
  if (step < kMinStep || step > kMaxStep) return false;
  if (top.size[0] * top.size[1] > kMaxArea * furniture.size[0] * furniture.size[1]) {
    return false;
  }
  ObjectPose ground = top, body = furniture;  // of equal height: only the footprints count
  body.size[0] += 2.0 * kMargin, body.size[1] += 2.0 * kMargin;
  ground.position.z = body.position.z = 0.0;
  ground.size[2] = body.size[2] = 1.0;
  return containedFraction(ground, body) > kMinContained;
}

}  // namespace

bool isPartOfFurniture(const ObjectMap& map, const Point3& p) {
  return std::any_of(map.objects.begin(), map.objects.end(), [&](const auto& o) {
    return o.pose && isFurniture(o) && isPartOf(*o.pose, p);
  });
}

bool reachesIntoFurniture(const ObjectMap& map, const ObjectPose& box) {
  constexpr double kDepth = 0.1, kShare = 0.4;  // below the top [m]; of its footprint
  return std::any_of(map.objects.begin(), map.objects.end(), [&](const ObjectInstance& o) {
    if (!o.pose || !isFurniture(o)) return false;
    const double top = o.pose->position.z + 0.5 * o.pose->size[2];
    return box.position.z - 0.5 * box.size[2] < top - kDepth &&
           commonArea(groundOf(box), groundOf(*o.pose)) > kShare * box.size[0] * box.size[1];
  });
}

bool isOnFurniture(const ObjectMap& map, const ObjectPose& top, Id except) {
  return std::any_of(map.objects.begin(), map.objects.end(), [&](const auto& o) {
    return o.id != except && o.pose && isFurniture(o) && isTopOfObjects(top, *o.pose);
  });
}

void removeTopsOfObjects(ObjectMap& map) {
  std::vector<Id> removed;
  for (const ObjectInstance& object : map.objects) {
    if (object.pose && !object.described && isFurniture(object) &&
        isOnFurniture(map, *object.pose, object.id)) {
      removed.push_back(object.id);
    }
  }
  for (const Id id : removed) map.remove(id);
}

void mergeFurniture(ObjectMap& map) {
  auto& objects = map.objects;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    for (std::size_t j = i + 1; j < objects.size();) {
      ObjectInstance &a = objects[i], &b = objects[j];
      if (!a.pose || !b.pose || !isFurniture(a) || !isFurniture(b) || !isOneTop(*a.pose, *b.pose)) {
        ++j;
        continue;
      }
      unite(a, b);
      a.detections += b.detections;
      a.described = a.described || b.described;
      keepDescribedRelations(map, b.id, a.id);
      map.remove(b.id);
      j = i + 1;
    }
  }
}

}  // namespace hyselam_objects
