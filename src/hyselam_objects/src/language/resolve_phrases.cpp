// FillMap: which objects of the map a phrase means, and what contradicts a statement.
#include <algorithm>
#include <iterator>
#include <set>
#include <utility>

#include "object_words.hpp"
#include "statement_meaning.hpp"

namespace hyselam_objects {
namespace {

bool areOpposite(RelationWord a, RelationWord b) {
  const auto are = [&](RelationWord one, RelationWord other) {
    return (a == one && b == other) || (a == other && b == one);
  };
  return are(RelationWord::kLeft, RelationWord::kRight) ||
         are(RelationWord::kFront, RelationWord::kBehind);
}

}  // namespace

std::string FillMap::resolvePlaceName(const hyselam_topo::SaidName& said) const {
  if (said.reference.empty()) return said.text;
  if (said.reference == "there" && last_place_ != 0) return map_.findPlace(last_place_)->name;
  return said.reference == "here" ? robot_place_ : "";
}

Id FillMap::findPlace(const std::string& name) const {
  for (const ObjectPlace& place : map_.places) {
    if (lowerCase(place.name) == lowerCase(name)) return place.id;
  }
  return 0;
}

bool FillMap::matchesPhrase(const ObjectInstance& object, const ObjectPhrase& phrase) const {
  if (!parser_.isSameKind(object.kind, phrase.kind)) return false;
  const auto& wanted = phrase.properties;
  return std::all_of(wanted.begin(), wanted.end(), [&](const auto& property) {
    const auto found = object.properties.find(property.first);
    // "the red pen" is not just any pen, "a red pen" may be one whose color is not known.
    return found == object.properties.end() ? !phrase.definite : found->second == property.second;
  });
}

std::vector<Id> FillMap::candidates(const ObjectPhrase& phrase) const {
  if (!phrase.chosen.empty()) return stillThere(phrase.chosen);
  std::vector<Id> ids;
  for (const ObjectInstance& object : map_.objects) {
    if (matchesPhrase(object, phrase)) ids.push_back(object.id);
  }
  if (!ids.empty() || phrase.properties.count("owner") == 0) return ids;
  // "my pen": one of which nobody has said whose it is
  ObjectPhrase anyones = phrase;
  anyones.properties.erase("owner");
  for (const ObjectInstance& object : map_.objects) {
    const bool owned = object.properties.count("owner") != 0;
    if (!owned && matchesPhrase(object, anyones)) ids.push_back(object.id);
  }
  return ids;
}

std::vector<Id> FillMap::resolveReference(const ObjectPhrase& phrase, Id place,
                                          bool only_there) const {
  if (!phrase.chosen.empty()) return stillThere(phrase.chosen);
  if (!phrase.reference.empty()) {
    if (phrase.reference == "it" && last_objects_.size() != 1) return {};
    return last_objects_;
  }
  std::vector<Id> all = candidates(phrase);
  if (phrase.other) {
    all.erase(std::remove_if(all.begin(), all.end(),
                             [this](Id id) {
                               return std::find(last_objects_.begin(), last_objects_.end(), id) !=
                                      last_objects_.end();
                             }),
              all.end());
  }
  if (all.size() <= 1) return all;
  std::vector<Id> mentioned, there;
  for (const Id id : all) {
    const auto isIn = [id](const std::vector<Id>& ids) {
      return std::find(ids.begin(), ids.end(), id) != ids.end();
    };
    if (isIn(last_objects_) || isIn(landmarks_told_)) mentioned.push_back(id);
    if (place != 0 && map_.placeOf(id) == place) there.push_back(id);
  }
  if (only_there) return there;
  if (phrase.plural) return !mentioned.empty() ? mentioned : !there.empty() ? there : all;
  if (mentioned.size() == 1) return mentioned;
  return there.empty() ? all : there;
}

/// "in front of room 3": what is at no place that is known.
bool FillMap::isRelatedToRoom(Id object) const {
  const auto all = map_.relationsOf(object);
  return std::any_of(all.begin(), all.end(), [](const ObjectRelation* r) {
    return r->place != 0 && r->word != RelationWord::kAt;
  });
}

/// Whether an object may be related so to two others: "on the floor under the table", "in the
/// corner on the chair".
bool FillMap::areCompatible(RelationWord a, Id other_a, RelationWord b, Id other_b) const {
  const auto isPart = [this](Id id) {
    const ObjectInstance* object = map_.find(id);
    return object != nullptr && object->properties.count("structure") != 0;
  };
  const auto isIn = [](RelationWord word) {
    return word == RelationWord::kIn || word == RelationWord::kInside;
  };
  if (isPart(other_a) && (isIn(a) || b == RelationWord::kUnder)) return true;
  return isPart(other_b) && (isIn(b) || a == RelationWord::kUnder);
}

/// Directly, or by others in between. Relations that people described may form a circle.
bool FillMap::isSupportedBy(Id object, Id other) const {
  std::set<Id> visited;
  std::vector<Id> open{object};
  while (!open.empty()) {
    const Id id = open.back();
    open.pop_back();
    if (id == other) return true;
    if (!visited.insert(id).second) continue;
    for (const ObjectRelation* r : map_.relationsOf(id)) {
      if (isSupport(r->word) && r->other != 0) open.push_back(r->other);
    }
  }
  return false;
}

/// What is known of the object, in words, if it contradicts the target; else "".
std::string FillMap::contradiction(Id object, const Target& target) const {
  const Id place = map_.placeOf(object);
  bool against = place != 0 && target.place != 0 && place != target.place;
  if (target.word && target.landmark != 0) {
    if (target.landmark == object ||
        (isSupport(*target.word) && isSupportedBy(target.landmark, object))) {
      against = true;
    }
    for (const ObjectRelation* r : map_.relationsOf(object)) {
      if (r->other == 0) continue;
      if (isSupport(r->word) && isSupport(*target.word) &&
          !areCompatible(r->word, r->other, *target.word, target.landmark)) {
        const bool same = r->other == target.landmark;
        const bool below = *target.word == RelationWord::kUnder;
        against = against || (same ? (r->word == RelationWord::kUnder) != below
                                   : !isSupportedBy(object, target.landmark) || below);
      }
      against = against || (r->other == target.landmark && areOpposite(r->word, *target.word));
    }
  }
  return against ? factsOf({object}, true).front() : "";
}

// ---- Changes of the map ----

void FillMap::applyTarget(Id object, const Target& target) {
  if (target.place != 0 && map_.placeOf(object) != target.place) moveToPlace(object, target.place);
  if (target.word && target.landmark != 0 && target.landmark != object) {
    relateToLandmark(object, target);
  }
  if (target.word && target.room != 0) {
    ObjectRelation relation;
    relation.object = object;
    relation.word = *target.word;
    relation.place = target.room;
    relation.described = true;
    map_.relate(relation);
  }
}

/// It has moved, and with it what rests on it; what lies under it stays.
void FillMap::moveToPlace(Id object, Id place) {
  const auto rests = [](const ObjectRelation& r) {
    return isSupport(r.word) && r.word != RelationWord::kUnder;
  };
  auto& all = map_.relations;
  all.erase(std::remove_if(all.begin(), all.end(),
                           [&](const ObjectRelation& r) {
                             return r.object == object || (r.other == object && !rests(r));
                           }),
            all.end());
  ObjectRelation at;
  at.object = object;
  at.place = place;
  at.described = true;
  map_.relate(at);
  std::vector<Id> carried{object};  // in the order found
  for (std::size_t i = 0; i < carried.size(); ++i) {
    for (const ObjectRelation& r : all) {
      if (r.other == carried[i] && rests(r) && r.object != object &&
          std::find(carried.begin(), carried.end(), r.object) == carried.end()) {
        carried.push_back(r.object);
      }
    }
  }
  for (ObjectRelation& r : all) {
    const bool moves = std::find(carried.begin() + 1, carried.end(), r.object) != carried.end();
    if (moves && r.word == RelationWord::kAt) r.place = place;
  }
}

/// Replaces relations that contradict the new one; "over the table" adds nothing to "on the table".
void FillMap::relateToLandmark(Id object, const Target& target) {
  const RelationWord word = *target.word;
  auto& all = map_.relations;
  const auto isReplaced = [&](const ObjectRelation& r) {
    if (r.object != object || r.other == 0) return false;
    if (r.other == target.landmark) return areOpposite(r.word, word);
    return isSupport(r.word) && isSupport(word) && !isSupportedBy(r.other, target.landmark) &&
           !areCompatible(r.word, r.other, word, target.landmark);
  };
  std::vector<ObjectRelation> kept;  // isReplaced() looks at all of them
  std::remove_copy_if(all.begin(), all.end(), std::back_inserter(kept), isReplaced);
  all = std::move(kept);
  const bool is_known = std::any_of(all.begin(), all.end(), [&](const ObjectRelation& r) {
    return r.object == object && isSupport(r.word) && isSupport(word) &&
           (r.word == RelationWord::kUnder) == (word == RelationWord::kUnder) &&
           isSupportedBy(object, target.landmark);
  });
  if (is_known) return;
  all.erase(std::remove_if(all.begin(), all.end(),
                           [&](const ObjectRelation& r) {
                             return r.object == object && r.other == target.landmark &&
                                    isSupport(r.word) && isSupport(word);
                           }),
            all.end());
  ObjectRelation relation;
  relation.object = object;
  relation.word = word;
  relation.other = target.landmark;
  relation.described = true;
  map_.relate(relation);
}

Id FillMap::addObject(const ObjectPhrase& phrase, const Target& target) {
  const Id id = map_.addObject(phrase.kind);
  ObjectInstance& object = *map_.find(id);
  object.properties = phrase.properties;
  if (parser_.isStructure(phrase.kind)) object.properties["structure"] = "yes";
  object.described = true;
  applyTarget(id, target);
  return id;
}

}  // namespace hyselam_objects
