#include "hyselam_objects/mapping/object_mapper.hpp"

#include <algorithm>

#include "boxes.hpp"
#include "data_association.hpp"
#include "free_space_evidence.hpp"
#include "furniture.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_objects/recognition/object_descriptor.hpp"
#include "instance_traits.hpp"
#include "merge_duplicates.hpp"
#include "reassociate_moved.hpp"
#include "update_instance.hpp"

namespace hyselam_objects {

void MapperParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit.renamed("gate", "association_gate");
  visit.renamed("confirm", "min_views");
  visit("association_gate", association_gate, Range::between(0.01, 5.0), "m",
        "largest distance of a detection from its instance");
  visit("appearance_threshold", appearance_threshold, Range::above(0.0), "",
        "largest distance of the descriptors of a detection and its instance");
  visit("reidentification_threshold", reidentification_threshold, Range::above(0.0), "",
        "the same for an object that has moved");
  visit("p_detection", p_detection, Range::inside(0.0, 1.0), "",
        "probability to detect an object that is in view");
  visit("p_false_alarm", p_false_alarm, Range::inside(0.0, 1.0), "",
        "probability to detect an object that is not there; below p_detection");
  visit("position_sigma", position_sigma, Range::above(0.0), "m",
        "standard deviation of a detection's position");
  visit("min_views", min_views, Range::between(1, 100), "",
        "number of views before a new object is kept");
  visit("image_border_margin", image_border_margin, Range::between(0.0, 0.5), "",
        "share of the frame at each border in which missing objects are not counted");
  visit("depth_margin", depth_margin, Range::atLeast(0.0), "m",
        "points this far behind an object show that its place is free");
}

void MapperParams::validate() const {
  hyselam::checkParameters(*this);
  if (!(p_detection > p_false_alarm)) {
    throw hyselam::ParameterError("p_detection", p_detection, "above p_false_alarm");
  }
  relations.validate();
  movability.validate();
}

ObjectMapper::ObjectMapper(ObjectMap& map, ObjectDictionary dictionary, const MapperParams& params)
    : map_(map), dictionary_(std::move(dictionary)), params_(params) {
  params_.validate();
}

void ObjectMapper::update(const OrganizedCloud& cloud, const PinholeCamera& camera,
                          const std::vector<DetectedObject>& all, double stamp) {
  checkCloud(cloud);
  time_ = stamp;
  removeTopsOfObjects(map_);
  const auto [detections, merged] = separateDetections(map_, all, stamp, params_);
  const std::vector<int> instances = associateDetections(map_, detections, stamp, params_);
  resetMergedInstances(detections, instances);
  std::vector<Id> seen_now = merged;
  for (std::size_t d = 0; d < detections.size(); ++d) {
    const DetectedObject& seen = detections[d];
    const bool whole = !seen.partial || seen.furniture;
    const auto known = recognizeObject(seen.descriptor, dictionary_);
    const std::string kind = known ? known->name : "";
    if (instances[d] >= 0) {
      ObjectInstance& object = map_.objects[static_cast<std::size_t>(instances[d])];
      seen_now.push_back(object.id);
      if (whole) addDetection(object, seen, kind, stamp, params_);
    } else if (whole && (seen.furniture ||
                         !(isPartOfFurniture(map_, seen.center()) || isPartOfKnown(seen, kind)))) {
      seen_now.push_back(addInstance(seen, kind, stamp));
    }
  }
  for (ObjectInstance& object : map_.objects) {
    if (!object.pose || isFurniture(object)) continue;
    if (std::find(seen_now.begin(), seen_now.end(), object.id) != seen_now.end()) continue;
    const PlaceEvidence evidence = evidenceOf(cloud, camera, *object.pose, params_);
    if (evidence == PlaceEvidence::kFree) addMissedDetection(object, stamp, params_);
    object.overlooked += evidence == PlaceEvidence::kOverlooked;
  }
  map_.stamp = std::max(map_.stamp, stamp);
}

// What was taken for one object from afar turns out to be several.
void ObjectMapper::resetMergedInstances(const std::vector<DetectedObject>& detections,
                                        const std::vector<int>& instances) {
  for (std::size_t d = 0; d < detections.size(); ++d) {
    for (std::size_t e = 0; e < detections.size() && instances[d] < 0; ++e) {
      if (instances[e] < 0 || detections[d].furniture || detections[e].furniture) continue;
      ObjectInstance& object = map_.objects[static_cast<std::size_t>(instances[e])];
      const bool two = object.pose && contains(*object.pose, detections[d].center()) &&
                       contains(*object.pose, detections[e].center()) && !isWholeKind(object);
      if (two && !detections[e].partial) {
        object.pose.reset();
        object.outline.clear();
      }
    }
  }
}

bool ObjectMapper::isWholeKind(const ObjectInstance& object) const {
  const GenericObject* kind = dictionary_.find(object.kind);
  return object.pose && kind != nullptr && kind->shape.size[0] > 0.0 &&
         fitsKind(*object.pose, kind, params_.position_sigma);
}

bool ObjectMapper::isPartOfKnown(const DetectedObject& seen, const std::string& kind) const {
  return std::any_of(map_.objects.begin(), map_.objects.end(), [&](const ObjectInstance& object) {
    return isWholeKind(object) && object.detections >= params_.min_views &&
           object.existence > 0.5 && (kind.empty() || kind == object.kind) &&
           contains(*object.pose, boxOf(seen).position);
  });
}

Id ObjectMapper::addInstance(const DetectedObject& seen, const std::string& kind, double stamp) {
  Id id = findDescribed(seen, kind);
  if (id == 0) id = map_.addObject(seen.furniture ? kFurnitureKind : kUnknownKind);
  ObjectInstance& object = *map_.find(id);
  if (seen.furniture) object.properties[kFurnitureKind] = "yes";
  addDetection(object, seen, kind, stamp, params_);
  assignPlace(id);
  return id;
}

// Described, but not seen yet: an object of the same kind at the same place.
Id ObjectMapper::findDescribed(const DetectedObject& seen, const std::string& kind) const {
  if (kind.empty() || !place_lookup_) return 0;
  const auto here = place_lookup_(seen.center().x, seen.center().y);
  if (!here) return 0;
  for (const ObjectInstance& object : map_.objects) {
    const ObjectPlace* place = map_.findPlace(map_.placeOf(object.id));
    if (object.described && !object.pose && object.kind == kind && place != nullptr &&
        place->name == here->first) {
      return object.id;
    }
  }
  return 0;
}

void ObjectMapper::assignPlace(Id id) {
  if (!place_lookup_) return;
  const ObjectInstance& object = *map_.find(id);
  const Point3& p = object.pose->position;
  const auto here = place_lookup_(p.x, p.y);
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
  at.described = object.described;
  map_.relate(at);
}

void ObjectMapper::consolidate(double unconfirmed_before) {
  mergeFurniture(map_);
  removeTopsOfObjects(map_);
  mergeDuplicates(map_, dictionary_, params_);
  reassociateMoved(map_, time_, params_);
  removeUnconfirmed(unconfirmed_before);
  for (const ObjectInstance& object : map_.objects) {
    if (object.pose) assignPlace(object.id);
  }
  updateRelations(map_, params_.relations);
  for (ObjectRelation& relation : map_.relations) {
    relation.movability = movability(map_, relation.object, params_.movability);
  }
}

bool ObjectMapper::isUnconfirmed(const ObjectInstance& object, double before) const {
  return object.detections < params_.min_views && object.last_seen < before;
}

// By views that show its place free, or something else there.
bool ObjectMapper::isDenied(const ObjectInstance& object) const {
  constexpr double kGone = 0.45;       // below: it was there, and may be elsewhere now
  constexpr double kBelieved = 0.95;   // between: views contradict each other
  constexpr double kOverlooked = 1.5;  // times as often as it is detected
  constexpr int kKept = 6;  // views after which one that is gone is kept: it may be found elsewhere
  if (isFurniture(object)) return false;
  const bool missed = object.missed_detections > object.detections && object.existence < 0.5 &&
                      object.detections < kKept;
  const bool contradicted = object.missed_detections >= object.detections &&
                            object.existence > kGone && object.existence < kBelieved;
  return missed || contradicted || object.overlooked > kOverlooked * object.detections;
}

// It is a part of something, or several things in one.
bool ObjectMapper::isNoObject(const ObjectInstance& object) const {
  if (isFurniture(object)) return false;
  return isPartOfFurniture(map_, object.pose->position) ||
         reachesIntoFurniture(map_, *object.pose) || isSpurious(map_, object, dictionary_, params_);
}

void ObjectMapper::removeUnconfirmed(double unconfirmed_before) {
  std::vector<Id> removed;
  for (const ObjectInstance& object : map_.objects) {
    if (!object.pose || object.described) continue;
    if (isUnconfirmed(object, unconfirmed_before) || isDenied(object) || isNoObject(object)) {
      removed.push_back(object.id);
    }
  }
  for (const Id id : removed) map_.remove(id);
}

}  // namespace hyselam_objects
