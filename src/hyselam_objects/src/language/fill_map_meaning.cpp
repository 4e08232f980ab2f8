// What phrases mean in the map, and what becomes of what they mean.
#include <algorithm>
#include <set>

#include "fill_map_target.hpp"
#include "hyselam_objects/fill_map.hpp"
#include "object_words.hpp"

namespace hyselam_objects {

// ---- What is meant ----

std::string FillMap::placeName(const hyselam_topo::SaidName& said) const {
  if (said.reference.empty()) return said.text;
  if (said.reference == "there" && place_ != 0) return map_.findPlace(place_)->name;
  return said.reference == "here" ? here_ : "";
}

Id FillMap::findPlace(const std::string& said) const {
  for (const ObjectPlace& place : map_.places) {
    if (lowerCase(place.name) == lowerCase(said)) return place.id;
  }
  return 0;
}

bool FillMap::fits(const ObjectInstance& object, const ObjectPhrase& said) const {
  if (object.kind != said.kind) return false;
  return std::all_of(said.properties.begin(), said.properties.end(), [&](const auto& property) {
    const auto found = object.properties.find(property.first);
    // "the red pen" is not just any pen, "a red pen" may be the one whose colour nobody has told.
    return found == object.properties.end() ? !said.definite : found->second == property.second;
  });
}

std::vector<Id> FillMap::candidates(const ObjectPhrase& said) const {
  std::vector<Id> ids;
  for (const ObjectInstance& object : map_.objects) {
    if (fits(object, said)) ids.push_back(object.id);
  }
  return ids;
}

std::vector<Id> FillMap::resolve(const ObjectPhrase& said, Id place, bool only_there) const {
  if (!said.reference.empty()) {
    if (said.reference == "it" && subjects_.size() != 1) return {};
    return subjects_;
  }
  std::vector<Id> all = candidates(said);
  if (all.size() <= 1) return all;
  std::vector<Id> mentioned, here;
  for (const Id id : all) {
    if (std::find(subjects_.begin(), subjects_.end(), id) != subjects_.end()) {
      mentioned.push_back(id);
    }
    if (place != 0 && map_.placeOf(id) == place) here.push_back(id);
  }
  if (only_there) return here;
  if (said.plural) return !mentioned.empty() ? mentioned : !here.empty() ? here : all;
  if (mentioned.size() == 1) return mentioned;
  return here.empty() ? all : here;
}

bool FillMap::restsOn(Id object, Id other) const {
  std::set<Id> seen;
  std::vector<Id> open{object};
  while (!open.empty()) {
    const Id id = open.back();
    open.pop_back();
    if (id == other) return true;
    if (!seen.insert(id).second) continue;
    for (const ObjectRelation* r : map_.relationsOf(id)) {
      if (isSupport(r->word) && r->other != 0) open.push_back(r->other);
    }
  }
  return false;
}

std::string FillMap::contradiction(Id object, const Target& target) const {
  const Id place = map_.placeOf(object);
  bool against = place != 0 && target.place != 0 && place != target.place;
  if (target.word && target.landmark != 0) {
    if (target.landmark == object ||
        (isSupport(*target.word) && restsOn(target.landmark, object))) {
      against = true;
    }
    for (const ObjectRelation* r : map_.relationsOf(object)) {
      if (r->other == 0) continue;
      if (isSupport(r->word) && isSupport(*target.word)) {
        const bool same = r->other == target.landmark;
        const bool below = *target.word == RelationWord::kUnder;
        against = against || (same ? (r->word == RelationWord::kUnder) != below
                                   : !restsOn(object, target.landmark) || below);
      }
      const bool opposite =
          r->other == target.landmark &&
          ((r->word == RelationWord::kLeft && *target.word == RelationWord::kRight) ||
           (r->word == RelationWord::kRight && *target.word == RelationWord::kLeft));
      against = against || opposite;
    }
  }
  return against ? name(object) + " " + whereIs(object) : "";
}

// ---- Changes ----

void FillMap::put(Id object, const Target& target) {
  auto& all = map_.relations;
  const Id place = map_.placeOf(object);
  if (target.place != 0 && place != target.place) {
    // It has gone somewhere else, and with it what rests on it.
    all.erase(std::remove_if(all.begin(), all.end(),
                             [&](const ObjectRelation& r) {
                               return r.object == object ||
                                      (r.other == object &&
                                       (!isSupport(r.word) || r.word == RelationWord::kUnder));
                             }),
              all.end());
    ObjectRelation at;
    at.object = object;
    at.place = target.place;
    at.told = true;
    map_.relate(at);
    // What lies under it stays.
    std::vector<Id> carried{object};
    for (std::size_t i = 0; i < carried.size(); ++i) {
      for (const ObjectRelation& r : all) {
        const bool rests = r.other == carried[i] && isSupport(r.word) &&
                           r.word != RelationWord::kUnder && r.object != object;
        if (rests && std::find(carried.begin(), carried.end(), r.object) == carried.end()) {
          carried.push_back(r.object);
        }
      }
    }
    for (ObjectRelation& r : all) {
      const bool goes = std::find(carried.begin() + 1, carried.end(), r.object) != carried.end();
      if (goes && r.place != 0) r.place = target.place;
    }
  }
  if (!target.word || target.landmark == 0 || target.landmark == object) return;
  const auto gives_way = [&](const ObjectRelation& r) {
    if (r.object != object || r.other == 0) return false;
    const bool opposite =
        r.other == target.landmark &&
        ((r.word == RelationWord::kLeft && *target.word == RelationWord::kRight) ||
         (r.word == RelationWord::kRight && *target.word == RelationWord::kLeft));
    const bool rests = isSupport(r.word) && isSupport(*target.word) && r.other != target.landmark;
    return opposite || (rests && !restsOn(r.other, target.landmark));
  };
  bool has = false;  // "over the table" adds nothing to "on the table"
  all.erase(std::remove_if(all.begin(), all.end(), gives_way), all.end());
  for (const ObjectRelation& r : all) {
    has = has || (r.object == object && isSupport(r.word) && isSupport(*target.word) &&
                  (r.word == RelationWord::kUnder) == (*target.word == RelationWord::kUnder) &&
                  restsOn(object, target.landmark));
  }
  if (has) return;
  all.erase(std::remove_if(all.begin(), all.end(),
                           [&](const ObjectRelation& r) {
                             return r.object == object && r.other == target.landmark &&
                                    isSupport(r.word) && isSupport(*target.word);
                           }),
            all.end());
  ObjectRelation relation;
  relation.object = object;
  relation.word = *target.word;
  relation.other = target.landmark;
  relation.told = true;
  map_.relate(relation);
}

Id FillMap::add(const ObjectPhrase& said, const Target& target) {
  const Id id = map_.addObject(said.kind);
  ObjectInstance& object = *map_.find(id);
  object.properties = said.properties;
  object.told = true;
  put(id, target);
  return id;
}

}  // namespace hyselam_objects
