#include "hyselam_objects/mapping/object_map.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

#include "check_words.hpp"
#include "hyselam_common/errors.hpp"

namespace hyselam_objects {
namespace {

static_assert(kOutlineDirections == 72, "as told in files and errors");

constexpr std::array<const char*, kRelationWords> kWords{
    "at",    "inside", "in",   "on",     "over",  "under",   "left",
    "right", "top",    "near", "behind", "front", "against", "between"};

auto fields(const Point3& p) {
  return std::tie(p.x, p.y, p.z);
}

bool same(const std::optional<Point3>& a, const std::optional<Point3>& b) {
  return a.has_value() == b.has_value() && (!a || fields(*a) == fields(*b));
}

bool same(const std::optional<ObjectPose>& a, const std::optional<ObjectPose>& b) {
  return a.has_value() == b.has_value() &&
         (!a || (fields(a->position) == fields(b->position) && a->size == b->size &&
                 a->yaw == b->yaw && a->covariance == b->covariance));
}

bool isFinite(const Point3& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

auto key(const ObjectRelation& r) {
  return std::make_tuple(r.object, r.word, r.other, r.place);
}

template <typename Items>
auto findId(Items& items, Id id) -> decltype(items.data()) {
  const auto found =
      std::find_if(items.begin(), items.end(), [id](const auto& each) { return each.id == id; });
  return found == items.end() ? nullptr : &*found;
}

std::string what(const ObjectInstance& object) {
  std::string text;
  for (const auto& [key, value] : object.properties) {
    if (key != "structure") text += value + " ";
  }
  return text + object.kind;
}

class Checker {
 public:
  Checker(const ObjectMap& map, const std::string& source) : map_(map), source_(source) {}

  void run() {
    require(isWord(map_.frame_id) && std::isfinite(map_.stamp), "", "frame or stamp is none");
    Id before = 0;
    for (const ObjectPlace& place : map_.places) {
      const std::string where = "place " + std::to_string(place.id);
      require(place.id > before, where, "its id is 0, stands twice or is out of order");
      require(place.id < map_.next_place_id, where, "its id is not below the next one");
      require(isWord(place.name), where, "its name is no word");
      before = place.id;
    }
    before = 0;
    for (const ObjectInstance& object : map_.objects) {
      check(object, before);
      before = object.id;
    }
    const ObjectRelation* last = nullptr;
    for (const ObjectRelation& relation : map_.relations) {
      const std::string where = "relation of object " + std::to_string(relation.object);
      check(relation, where);
      require(last == nullptr || key(*last) < key(relation), where,
              "it stands twice or is out of order");
      last = &relation;
    }
  }

 private:
  void require(bool good, const std::string& where, const char* reason) const {
    if (!good) throw hyselam::InputError(source_, where, reason);
  }
  static bool isShare(double value) { return value >= 0.0 && value <= 1.0; }

  void check(const ObjectInstance& object, Id before) const {
    const std::string where = "object " + std::to_string(object.id);
    require(object.id > before, where, "its id is 0, stands twice or is out of order");
    require(object.id < map_.next_object_id, where, "its id is not below the next one");
    require(isWord(object.kind), where, "its kind is no word");
    for (const auto& [name, value] : object.properties) {
      require(isWord(name) && isWord(value), where, "a property is no word");
    }
    require(isShare(object.existence), where, "its existence is not in 0 .. 1");
    require(object.detections >= 0 && object.missed_detections >= 0 && object.overlooked >= 0,
            where, "a count is negative");
    require(std::isfinite(object.last_seen), where, "the time it was last seen is not finite");
    const auto& d = object.descriptor;
    require(std::all_of(d.begin(), d.end(), [](float v) { return std::isfinite(v); }), where,
            "its descriptor is not finite");
    const Outline& outline = object.outline;
    require(outline.empty() || outline.size() == kOutlineDirections, where,
            "its outline has not 72 directions");
    require(std::all_of(outline.begin(), outline.end(), [](double v) { return std::isfinite(v); }),
            where, "its outline is not finite");
    for (const ObjectStay& stay : object.history) {
      require(isFinite(stay.position) && std::isfinite(stay.from) && stay.until >= stay.from, where,
              "a stay of its history is none");
    }
    if (!object.pose) return;
    const ObjectPose& pose = *object.pose;
    require(isFinite(pose.position) && std::isfinite(pose.yaw), where, "its pose is not finite");
    for (const double length : pose.size) {
      require(length >= 0.0 && std::isfinite(length), where, "its size is negative or not finite");
    }
    for (std::size_t i = 0; i < pose.covariance.size(); ++i) {
      const bool diagonal = i % 4 == 0;
      require(std::isfinite(pose.covariance[i]) && (!diagonal || pose.covariance[i] >= 0.0), where,
              "its covariance is none");
    }
  }

  void check(const ObjectRelation& relation, const std::string& where) const {
    require(map_.find(relation.object) != nullptr, where, "there is no such object");
    require((relation.other == 0) != (relation.place == 0), where,
            "it must have either an object or a place as its other end");
    if (relation.place != 0) {
      require(map_.findPlace(relation.place) != nullptr, where, "there is no such place");
      require(mayRelateToPlace(relation.word), where,
              "objects are only at, near, behind, between or beside a place");
    } else {
      require(map_.find(relation.other) != nullptr && relation.other != relation.object, where,
              "its other object does not exist or is itself");
      require(relation.word != RelationWord::kAt, where, "objects are not 'at' an object");
    }
    require(isShare(relation.movability), where, "its movability is not in 0 .. 1");
    require(!relation.vector || isFinite(*relation.vector), where, "its vector is not finite");
  }

  const ObjectMap& map_;
  const std::string& source_;
};

}  // namespace

const char* toString(RelationWord word) {
  return kWords.at(static_cast<std::size_t>(word));
}

std::optional<RelationWord> relationWordFromString(const std::string& text) {
  const auto found = std::find(kWords.begin(), kWords.end(), text);
  if (found == kWords.end()) return std::nullopt;
  return static_cast<RelationWord>(found - kWords.begin());
}

bool isSupport(RelationWord word) {
  return word == RelationWord::kInside || word == RelationWord::kIn || word == RelationWord::kOn ||
         word == RelationWord::kOver || word == RelationWord::kTop || word == RelationWord::kUnder;
}

bool mayRelateToPlace(RelationWord word) {
  return word == RelationWord::kAt || word == RelationWord::kNear ||
         word == RelationWord::kBehind || word == RelationWord::kFront ||
         word == RelationWord::kLeft || word == RelationWord::kRight ||
         word == RelationWord::kBetween;
}

const ObjectPlace* ObjectMap::findPlace(Id id) const {
  return findId(places, id);
}
const ObjectInstance* ObjectMap::find(Id id) const {
  return findId(objects, id);
}
ObjectInstance* ObjectMap::find(Id id) {
  return findId(objects, id);
}

Id ObjectMap::placeOf(Id object) const {
  for (const ObjectRelation& relation : relations) {
    if (relation.object == object && relation.word == RelationWord::kAt) return relation.place;
  }
  return 0;
}

std::vector<const ObjectRelation*> ObjectMap::relationsOf(Id object) const {
  std::vector<const ObjectRelation*> found;
  for (const ObjectRelation& relation : relations) {
    if (relation.object == object) found.push_back(&relation);
  }
  return found;
}

Id ObjectMap::addPlace(const std::string& name, Id topological) {
  places.push_back({next_place_id, name, topological});
  return next_place_id++;
}

Id ObjectMap::addObject(const std::string& kind) {
  ObjectInstance object;
  object.id = next_object_id++;
  object.kind = kind;
  objects.push_back(std::move(object));
  return objects.back().id;
}

void ObjectMap::relate(const ObjectRelation& relation) {
  const auto at = std::lower_bound(
      relations.begin(), relations.end(), relation,
      [](const ObjectRelation& a, const ObjectRelation& b) { return key(a) < key(b); });
  if (at != relations.end() && key(*at) == key(relation)) {
    *at = relation;
  } else {
    relations.insert(at, relation);
  }
}

void ObjectMap::remove(Id object) {
  const auto drop = [](auto& items, const auto& wanted) {
    items.erase(std::remove_if(items.begin(), items.end(), wanted), items.end());
  };
  drop(relations, [object](const auto& r) { return r.object == object || r.other == object; });
  drop(objects, [object](const auto& o) { return o.id == object; });
}

bool operator==(const ObjectPlace& a, const ObjectPlace& b) {
  return std::tie(a.id, a.name, a.topological) == std::tie(b.id, b.name, b.topological);
}

bool operator==(const ObjectInstance& a, const ObjectInstance& b) {
  const auto tied = [](const ObjectInstance& o) {
    return std::tie(o.id, o.kind, o.properties, o.described, o.outline, o.descriptor, o.detections,
                    o.missed_detections, o.overlooked, o.last_seen, o.existence);
  };
  return tied(a) == tied(b) && same(a.pose, b.pose) &&
         std::equal(a.history.begin(), a.history.end(), b.history.begin(), b.history.end(),
                    [](const ObjectStay& x, const ObjectStay& y) {
                      return x.from == y.from && x.until == y.until &&
                             fields(x.position) == fields(y.position);
                    });
}

bool operator==(const ObjectRelation& a, const ObjectRelation& b) {
  return key(a) == key(b) && same(a.vector, b.vector) && a.movability == b.movability &&
         a.described == b.described;
}

bool operator==(const ObjectMap& a, const ObjectMap& b) {
  return std::tie(a.frame_id, a.stamp, a.places, a.objects, a.relations, a.next_place_id,
                  a.next_object_id) == std::tie(b.frame_id, b.stamp, b.places, b.objects,
                                                b.relations, b.next_place_id, b.next_object_id);
}

void checkMap(const ObjectMap& map, const std::string& source) {
  Checker(map, source).run();
}

std::vector<std::string> summaryLines(const ObjectMap& map) {
  std::vector<std::string> lines;
  for (const ObjectInstance& object : map.objects) {
    std::string line = what(object);
    const ObjectPlace* place = map.findPlace(map.placeOf(object.id));
    if (place != nullptr) line += " at " + place->name;
    for (const ObjectRelation* relation : map.relationsOf(object.id)) {
      if (relation->word == RelationWord::kAt) continue;
      line += std::string(", ") + toString(relation->word) + " ";
      line += relation->other != 0 ? what(*map.find(relation->other))
                                   : map.findPlace(relation->place)->name;
    }
    lines.push_back(std::move(line));
  }
  std::sort(lines.begin(), lines.end());
  return lines;
}

}  // namespace hyselam_objects
