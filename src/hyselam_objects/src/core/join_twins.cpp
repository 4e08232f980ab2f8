#include "join_twins.hpp"

#include <algorithm>
#include <cmath>

#include "boxes.hpp"
#include "instance_traits.hpp"
#include "keep_told.hpp"

namespace hyselam_objects {
namespace {

/// Whether two things of one kind touch and are together no larger than one of that kind.
bool areFacesOfOne(const ObjectInstance& a, const ObjectInstance& b,
                   const ObjectDictionary& dictionary, double sigma) {
  constexpr double kGap = 0.03, kDeviations = 3.0;
  if (a.kind != b.kind) return false;
  const GenericObject* kind = dictionary.find(a.kind);
  if (kind == nullptr || !(kind->shape.size[0] > 0.0)) return false;
  ObjectPose both = *a.pose;
  unite(&both, *b.pose);
  const double most = std::max(both.size[0], both.size[1]);
  if (most > kind->shape.size[0] + kDeviations * kind->shape.spread[0] + sigma ||
      both.size[2] > kind->shape.size[2] + kDeviations * kind->shape.spread[2] + sigma) {
    return false;
  }
  return both.size[0] < a.pose->size[0] + b.pose->size[0] + kGap &&
         both.size[1] < a.pose->size[1] + b.pose->size[1] + kGap;
}

/// Adds what is known of the second one to the first one.
void join(ObjectInstance* a, const ObjectInstance& b) {
  const bool second = b.pose->size[2] > 1.4 * a->pose->size[2] || b.seen > 2 * a->seen;
  if (second) {
    a->pose = b.pose;
    a->descriptor = b.descriptor;
    if (b.kind != kUnknown) a->kind = b.kind;
  }
  if (a->kind == kUnknown) a->kind = b.kind;
  a->seen += b.seen;
  a->last_seen = std::max(a->last_seen, b.last_seen);
  a->existence = std::max(a->existence, b.existence);
  a->told = a->told || b.told;
}

}  // namespace

void joinTwins(ObjectMap* map, const ObjectDictionary& dictionary, const MapperParams& params) {
  auto& objects = map->objects;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    for (std::size_t j = i + 1; j < objects.size();) {
      ObjectInstance &a = objects[i], &b = objects[j];
      const bool things = a.pose && b.pose && !isFurniture(a) && !isFurniture(b);
      const bool faces = things && areFacesOfOne(a, b, dictionary, params.sigma);
      if (!things || std::abs(a.last_seen - b.last_seen) > kAbsence ||
          (!faces && !isSameSpot(*a.pose, *b.pose))) {
        ++j;
        continue;
      }
      if (faces) {
        unite(&*a.pose, *b.pose);
        b.pose = a.pose;
      }
      join(&a, b);
      keepTold(b.id, a.id, map);
      map->remove(b.id);
      j = i + 1;
    }
  }
}

bool isShadow(const ObjectMap& map, const ObjectInstance& object) {
  constexpr double kMargin = 0.03;
  int within = 0;
  for (const ObjectInstance& other : map.objects) {
    if (other.id == object.id || !other.pose || isFurniture(other) || isFurniture(object)) continue;
    if (other.existence < 0.5) continue;
    // Two bodies are not in one place: of the same kind, one is a face of the other.
    const bool alike = object.kind == other.kind || object.kind == kUnknown;
    if (alike && object.seen <= other.seen && shareWithin(*object.pose, *other.pose) > 0.8 &&
        shareWithin(*other.pose, *object.pose) < 0.8) {
      return true;
    }
    if (2 * object.seen > other.seen) continue;
    const double away = std::abs(object.pose->position.z - other.pose->position.z);
    if (isOn(*other.pose, object.pose->position) && away < 0.5 * other.pose->size[2] + kMargin) {
      return true;
    }
    within += isIn(*object.pose, other.pose->position);
  }
  return within >= 2;
}

}  // namespace hyselam_objects
