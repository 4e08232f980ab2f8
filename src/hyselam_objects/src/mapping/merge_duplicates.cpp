#include "merge_duplicates.hpp"

#include <algorithm>
#include <cmath>

#include "boxes.hpp"
#include "instance_traits.hpp"
#include "keep_described.hpp"

namespace hyselam_objects {
namespace {

/// Whether two objects of one kind touch and are together no larger than one of that kind.
bool areFacesOfOne(const ObjectInstance& a, const ObjectInstance& b,
                   const ObjectDictionary& dictionary, double sigma) {
  constexpr double kGap = 0.03, kDeviations = 3.0;
  if (a.kind != b.kind) return false;
  const GenericObject* kind = dictionary.find(a.kind);
  if (kind == nullptr || !(kind->shape.size[0] > 0.0)) return false;
  ObjectInstance both = a;
  unite(both, b);
  const auto& size = both.pose->size;
  const auto fits = [&](double value, std::size_t axis) {
    return value <= kind->shape.size[axis] + kDeviations * kind->shape.spread[axis] + sigma;
  };
  return fits(std::max(size[0], size[1]), 0) && fits(std::min(size[0], size[1]), 1) &&
         fits(size[2], 2) && gapBetween(groundOf(*a.pose), groundOf(*b.pose)) < kGap;
}

/// Adds what is known of the second one to the first one.
void merge(ObjectInstance& a, const ObjectInstance& b) {
  constexpr double kTaller = 1.4;  // the first one was only a part
  if (b.pose->size[2] > kTaller * a.pose->size[2] || b.detections > 2 * a.detections) {
    a.pose = b.pose;
    a.outline = b.outline;
    a.descriptor = b.descriptor;
    if (b.kind != kUnknownKind) a.kind = b.kind;
  }
  if (a.kind == kUnknownKind) a.kind = b.kind;
  a.detections += b.detections;
  a.last_seen = std::max(a.last_seen, b.last_seen);
  a.existence = std::max(a.existence, b.existence);
  a.described = a.described || b.described;
}

}  // namespace

void mergeDuplicates(ObjectMap& map, const ObjectDictionary& dictionary,
                     const MapperParams& params) {
  auto& objects = map.objects;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    for (std::size_t j = i + 1; j < objects.size();) {
      ObjectInstance &a = objects[i], &b = objects[j];
      const bool objects_seen = a.pose && b.pose && !isFurniture(a) && !isFurniture(b);
      const bool faces = objects_seen && areFacesOfOne(a, b, dictionary, params.position_sigma);
      if (!objects_seen || std::abs(a.last_seen - b.last_seen) > kMaxAbsence ||
          (!faces && !areAtSameSpot(*a.pose, *b.pose))) {
        ++j;
        continue;
      }
      if (faces) {
        unite(a, b);
        b.pose = a.pose;
        b.outline = a.outline;
      }
      merge(a, b);
      keepDescribedRelations(map, b.id, a.id);
      map.remove(b.id);
      j = i + 1;
    }
  }
}

bool isSpurious(const ObjectMap& map, const ObjectInstance& object) {
  constexpr double kMargin = 0.03, kContained = 0.8;
  int within = 0;
  for (const ObjectInstance& other : map.objects) {
    if (other.id == object.id || !other.pose || isFurniture(other) || isFurniture(object)) continue;
    if (other.existence < 0.5) continue;
    // Two objects do not share a place: of the same kind, one is a face of the other.
    const bool alike = object.kind == other.kind || object.kind == kUnknownKind;
    if (alike && object.detections <= other.detections &&
        containedFraction(*object.pose, *other.pose) > kContained &&
        containedFraction(*other.pose, *object.pose) < kContained) {
      return true;
    }
    if (2 * object.detections > other.detections) continue;
    const double away = std::abs(object.pose->position.z - other.pose->position.z);
    if (isWithinFootprint(*other.pose, object.pose->position) &&
        away < 0.5 * other.pose->size[2] + kMargin) {
      return true;
    }
    within += contains(*object.pose, other.pose->position);
  }
  return within >= 2;
}

}  // namespace hyselam_objects
