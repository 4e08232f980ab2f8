#include "hyselam_objects/object_mapper.hpp"

#include <algorithm>

#include "add_view.hpp"
#include "associate.hpp"
#include "boxes.hpp"
#include "furniture.hpp"
#include "hyselam_common/require.hpp"
#include "hyselam_objects/object_descriptor.hpp"
#include "instance_traits.hpp"
#include "join_moved.hpp"
#include "join_twins.hpp"
#include "looks_through.hpp"

namespace hyselam_objects {

ObjectMapper::ObjectMapper(ObjectMap* map, ObjectDictionary dictionary, const MapperParams& params)
    : map_(*map), dictionary_(std::move(dictionary)), params_(params) {
  using hyselam::require;
  require("gate", params.gate, params.gate > 0.0, "> 0");
  require("look", params.look, params.look > 0.0, "> 0");
  require("refind_look", params.refind_look, params.refind_look > 0.0, "> 0");
  require("seen_if_there", params.seen_if_there,
          params.seen_if_there > params.seen_if_not && params.seen_if_there < 1.0,
          "above seen_if_not and below 1");
  require("seen_if_not", params.seen_if_not, params.seen_if_not > 0.0, "> 0");
  require("sigma", params.sigma, params.sigma > 0.0, "> 0");
  require("confirm", params.confirm, params.confirm >= 1, ">= 1");
}

void ObjectMapper::update(const OrganisedCloud& cloud, const PinholeCamera& camera,
                          const std::vector<DetectedObject>& all, double stamp) {
  checkCloud(cloud);
  time_ = stamp;
  dropTopsOfThings(&map_);
  std::vector<Id> met;
  const std::vector<DetectedObject> detections = singleThings(map_, all, stamp, params_, &met);
  const std::vector<int> of = associate(map_, detections, stamp, params_);
  forgetGroups(detections, of);
  for (std::size_t d = 0; d < detections.size(); ++d) {
    const DetectedObject& seen = detections[d];
    const bool whole = !seen.cut || seen.furniture;
    const auto known = recognise(seen.descriptor, dictionary_);
    const std::string kind = known ? known->name : "";
    if (of[d] >= 0) {
      ObjectInstance& object = map_.objects[static_cast<std::size_t>(of[d])];
      met.push_back(object.id);
      if (whole) addView(&object, seen, kind, stamp, params_);
    } else if (whole && (seen.furniture || !isPartOfFurniture(map_, seen.center()))) {
      met.push_back(add(seen, kind, stamp));
    }
  }
  for (ObjectInstance& object : map_.objects) {
    if (!object.pose || isFurniture(object)) continue;
    if (std::find(met.begin(), met.end(), object.id) != met.end()) continue;
    if (looksThrough(cloud, camera, *object.pose, params_)) addMiss(&object, stamp, params_);
  }
  map_.stamp = std::max(map_.stamp, stamp);
}

// What was taken for one thing from afar turns out to be several.
void ObjectMapper::forgetGroups(const std::vector<DetectedObject>& detections,
                                const std::vector<int>& of) {
  for (std::size_t d = 0; d < detections.size(); ++d) {
    for (std::size_t e = 0; e < detections.size() && of[d] < 0; ++e) {
      if (of[e] < 0 || detections[d].furniture || detections[e].furniture) continue;
      ObjectInstance& object = map_.objects[static_cast<std::size_t>(of[e])];
      const bool two = object.pose && isIn(*object.pose, detections[d].center()) &&
                       isIn(*object.pose, detections[e].center());
      if (two && !detections[e].cut) object.pose.reset();
    }
  }
}

Id ObjectMapper::add(const DetectedObject& seen, const std::string& kind, double stamp) {
  Id id = findTold(seen, kind);
  if (id == 0) id = map_.addObject(seen.furniture ? kFurniture : kUnknown);
  ObjectInstance& object = *map_.find(id);
  if (seen.furniture) object.properties[kFurniture] = "yes";
  addView(&object, seen, kind, stamp, params_);
  place(id);
  return id;
}

// Told of, but not seen yet: the same kind at the same place.
Id ObjectMapper::findTold(const DetectedObject& seen, const std::string& kind) const {
  if (kind.empty() || !place_at_) return 0;
  const auto here = place_at_(seen.center().x, seen.center().y);
  if (!here) return 0;
  for (const ObjectInstance& object : map_.objects) {
    const ObjectPlace* place = map_.findPlace(map_.placeOf(object.id));
    if (object.told && !object.pose && object.kind == kind && place != nullptr &&
        place->name == here->first) {
      return object.id;
    }
  }
  return 0;
}

void ObjectMapper::place(Id id) {
  if (!place_at_) return;
  const ObjectInstance& object = *map_.find(id);
  const Point3& p = object.pose->position;
  const auto here = place_at_(p.x, p.y);
  auto& all = map_.relations;
  all.erase(std::remove_if(all.begin(), all.end(),
                           [id](const auto& r) { return r.object == id && r.place != 0; }),
            all.end());
  if (!here) return;
  ObjectRelation at;
  at.object = id;
  for (const ObjectPlace& each : map_.places) {
    if (each.name == here->first) at.place = each.id;
  }
  if (at.place == 0) at.place = map_.addPlace(here->first);
  at.vector = Point3{p.x - here->second.x, p.y - here->second.y, p.z - here->second.z};
  at.told = object.told;
  map_.relate(at);
}

void ObjectMapper::finish(double weak_before) {
  joinFurniture(&map_);
  dropTopsOfThings(&map_);
  joinTwins(&map_, dictionary_, params_);
  joinMoved(&map_, time_, params_);
  dropDoubtful(weak_before);
  for (const ObjectInstance& object : map_.objects) {
    if (object.pose) place(object.id);
  }
  updateRelations(&map_, params_.relations);
  for (ObjectRelation& relation : map_.relations) {
    relation.movability = movability(map_, relation.object, params_.movability);
  }
}

void ObjectMapper::dropDoubtful(double weak_before) {
  std::vector<Id> dropped;
  for (const ObjectInstance& object : map_.objects) {
    if (!object.pose || object.told) continue;
    const bool weak = object.seen < params_.confirm && object.last_seen < weak_before;
    const bool part = !isFurniture(object) && isPartOfFurniture(map_, object.pose->position);
    const bool doubtful = object.missed > object.seen && object.existence < 0.5;
    if (weak || part || doubtful || isShadow(map_, object)) dropped.push_back(object.id);
  }
  for (const Id id : dropped) map_.remove(id);
}

}  // namespace hyselam_objects
