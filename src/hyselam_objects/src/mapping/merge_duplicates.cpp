#include "merge_duplicates.hpp"

#include <algorithm>
#include <cmath>

#include "boxes.hpp"
#include "instance_traits.hpp"
#include "keep_described.hpp"

namespace hyselam_objects {
namespace {

/// Whether two objects of one kind are together no larger than one of that kind.
bool areFacesOfOne(const ObjectInstance& a, const ObjectInstance& b,
                   const ObjectDictionary& dictionary, double sigma) {
  const GenericObject* kind = dictionary.find(a.kind);
  if (a.kind != b.kind || kind == nullptr || !(kind->shape.size[0] > 0.0)) return false;
  ObjectInstance both = a;
  unite(both, b);
  return fitsKind(*both.pose, kind, sigma);
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
  a.overlooked = std::min(a.overlooked, b.overlooked);
  a.last_seen = std::max(a.last_seen, b.last_seen);
  a.existence = std::max(a.existence, b.existence);
  a.described = a.described || b.described;
}

}  // namespace

bool fitsKind(const ObjectPose& box, const GenericObject* kind, double sigma) {
  constexpr double kDeviations = 3.0, kMaxMargin = 0.06;  // [m]
  if (kind == nullptr || !(kind->shape.size[0] > 0.0)) return true;
  const std::array<double, 3> size{std::max(box.size[0], box.size[1]),
                                   std::min(box.size[0], box.size[1]), box.size[2]};
  for (std::size_t k = 0; k < 3; ++k) {
    const double margin = std::min(kMaxMargin, kDeviations * kind->shape.spread[k]) + sigma;
    if (size[k] > kind->shape.size[k] + margin) return false;
  }
  return true;
}

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

bool isSpurious(const ObjectMap& map, const ObjectInstance& object,
                const ObjectDictionary& dictionary, const MapperParams& params) {
  constexpr double kMargin = 0.03, kContained = 0.8, kShared = 0.5;
  if (isFurniture(object)) return false;
  const auto isTooLarge = [&](const ObjectInstance& each) {
    return !fitsKind(*each.pose, dictionary.find(each.kind), params.position_sigma);
  };
  const bool is_too_large = isTooLarge(object);
  int within = 0;
  for (const ObjectInstance& other : map.objects) {
    if (other.id == object.id || !other.pose || isFurniture(other)) continue;
    if (other.existence < 0.5) continue;
    // Two objects do not share a place: of the same kind, one is a face of the other.
    // One that is too large to be what it is taken for proves nothing.
    const bool alike =
        (object.kind == other.kind || object.kind == kUnknownKind) && !isTooLarge(other);
    const double of_other = containedFraction(*other.pose, *object.pose);
    if (alike && object.detections <= other.detections && of_other < kContained &&
        containedFraction(*object.pose, *other.pose) > kContained) {
      return true;
    }
    // What holds most of another one is both, seen as one.
    const bool is_rare = 2 * object.detections <= other.detections;
    if (of_other > kShared && (is_rare || (is_too_large && other.detections >= params.min_views)))
      return true;
    if (!is_rare || isTooLarge(other)) continue;
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
