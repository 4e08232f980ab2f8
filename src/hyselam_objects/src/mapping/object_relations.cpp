#include "hyselam_objects/mapping/object_relations.hpp"

#include <algorithm>
#include <cmath>

#include "boxes.hpp"

namespace hyselam_objects {
namespace {

struct Extent {
  Id id = 0;
  ObjectPose box;

  double low() const { return box.position.z - 0.5 * box.size[2]; }
  double high() const { return box.position.z + 0.5 * box.size[2]; }
};

bool isOver(const Extent& a, const Extent& b, double overhang) {
  return isWithinFootprint(b.box, a.box.position, overhang);
}

bool contains(const Extent& b, const Extent& a) {
  const auto corners = cornersOf(groundOf(a.box));
  return a.low() >= b.low() && a.high() <= b.high() &&
         std::all_of(corners.begin(), corners.end(), [&](const Eigen::Vector2d& p) {
           return isWithinFootprint(b.box, {p.x(), p.y(), 0.0}, 0.0);
         });
}

// Left and right need a viewer at least this far away [m].
constexpr double kMinViewDistance = 0.1;

class RelationBuilder {
 public:
  RelationBuilder(ObjectMap& map, const RelationParams& params) : map_(map), params_(params) {
    for (const ObjectInstance& object : map_.objects) {
      const bool believed = object.existence > 0.5 && object.detections >= params_.min_views;
      if (object.pose && believed) extents_.push_back({object.id, *object.pose});
    }
  }

  void run() {
    auto& all = map_.relations;
    all.erase(std::remove_if(all.begin(), all.end(),
                             [](const auto& r) { return !r.described && r.other != 0; }),
              all.end());
    for (const Extent& a : extents_) findSupport(a);
    for (const Extent& a : extents_) {
      for (const Extent& b : extents_) {
        if (a.id != b.id && !supportEachOther(a.id, b.id)) relateBeside(a, b);
      }
    }
    for (ObjectRelation& r : all) {
      if (r.other == 0) continue;
      const ObjectInstance *a = map_.find(r.object), *b = map_.find(r.other);
      if (!a->pose || !b->pose) continue;
      const Point3 &p = a->pose->position, &q = b->pose->position;
      r.vector = Point3{p.x - q.x, p.y - q.y, p.z - q.z};
    }
  }

 private:
  void relate(const Extent& a, RelationWord word, const Extent& b) {
    // A person's word for the same relation stays: "over the table" for what stands on it.
    for (const ObjectRelation* r : map_.relationsOf(a.id)) {
      if (r->described && r->other == b.id && isSupport(r->word) == isSupport(word)) return;
    }
    ObjectRelation relation;
    relation.object = a.id;
    relation.word = word;
    relation.other = b.id;
    map_.relate(relation);
  }

  bool supportEachOther(Id a, Id b) const {
    return std::any_of(map_.relations.begin(), map_.relations.end(), [&](const auto& r) {
      return isSupport(r.word) &&
             ((r.object == a && r.other == b) || (r.object == b && r.other == a));
    });
  }

  void findSupport(const Extent& a) {
    const Extent* on = nullptr;
    for (const Extent& b : extents_) {
      if (a.id == b.id || !isOver(a, b, params_.max_overhang)) continue;
      if (contains(b, a)) {
        relate(a, RelationWord::kInside, b);
        return;
      }
      const bool stands =
          std::abs(a.low() - b.high()) < params_.max_contact_gap && a.box.position.z > b.high();
      if (stands && (on == nullptr || b.high() > on->high())) on = &b;
      if (b.low() > a.high() + params_.max_contact_gap) relate(a, RelationWord::kUnder, b);
    }
    if (on != nullptr) relate(a, RelationWord::kOn, *on);
  }

  void relateBeside(const Extent& a, const Extent& b) {
    if (std::abs(a.low() - b.low()) > params_.max_level_difference ||
        gapBetween(groundOf(a.box), groundOf(b.box)) > params_.max_near_gap) {
      return;
    }
    relate(a, RelationWord::kNear, b);
    const ObjectRelation* at = nullptr;
    for (const ObjectRelation* r : map_.relationsOf(b.id)) {
      if (r->place != 0 && r->vector) at = r;
    }
    if (at == nullptr || map_.placeOf(a.id) != at->place) return;
    const double length = std::hypot(at->vector->x, at->vector->y);
    if (length < kMinViewDistance) return;
    // Seen from the center of the place: along and across the line of sight.
    const double vx = at->vector->x / length, vy = at->vector->y / length;
    const double dx = a.box.position.x - b.box.position.x, dy = a.box.position.y - b.box.position.y;
    const double aside = vx * dy - vy * dx, along = vx * dx + vy * dy;
    if (std::abs(aside) < 2.0 * std::abs(along)) return;
    relate(a, aside > 0.0 ? RelationWord::kLeft : RelationWord::kRight, b);
  }

  ObjectMap& map_;
  const RelationParams& params_;
  std::vector<Extent> extents_;
};

}  // namespace

void RelationParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("max_contact_gap", max_contact_gap, Range::atLeast(0.0), "m",
        "between the underside of an object and the top of what it stands on");
  visit("max_overhang", max_overhang, Range::atLeast(0.0), "m",
        "of the center of an object beyond the border of what it stands on");
  visit("max_near_gap", max_near_gap, Range::atLeast(0.0), "m",
        "between the boxes of two objects that are near each other");
  visit("max_level_difference", max_level_difference, Range::atLeast(0.0), "m",
        "of the undersides of objects side by side");
  visit("min_views", min_views, Range::atLeast(0), "", "number of views of each of the two");
}

void RelationParams::validate() const {
  hyselam::checkParameters(*this);
}

void MovabilityParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("min_move", min_move, Range::atLeast(0.0), "m", "distance of two stays that is a move");
  visit("prior_weight", prior_weight, Range::above(0.0), "", "of the size's prior, in visits");
  visit("stacking_factor", stacking_factor, Range::between(0.0, 1.0), "",
        "factor for each object that stands on it");
}

void MovabilityParams::validate() const {
  hyselam::checkParameters(*this);
}

void updateRelations(ObjectMap& map, const RelationParams& params) {
  RelationBuilder(map, params).run();
}

double movability(const ObjectMap& map, Id id, const MovabilityParams& params) {
  const ObjectInstance* object = map.find(id);
  if (object == nullptr) return 0.5;
  double prior = 0.5;
  if (object->pose) {
    const auto& size = object->pose->size;
    const double liters = 1000.0 * std::max(1e-6, size[0] * size[1] * size[2]);
    prior = std::clamp(0.7 - 0.2 * std::log10(liters), 0.1, 0.9);
  }
  const auto visits = static_cast<double>(object->history.size());
  double moves = 0.0;
  for (std::size_t i = 1; i < object->history.size(); ++i) {
    const Point3 &a = object->history[i - 1].position, &b = object->history[i].position;
    moves += std::hypot(a.x - b.x, a.y - b.y, a.z - b.z) > params.min_move;
  }
  double value = (params.prior_weight * prior + moves) / (params.prior_weight + visits);
  for (const ObjectRelation& r : map.relations) {
    if (r.other == id && (r.word == RelationWord::kOn || r.word == RelationWord::kTop)) {
      value *= params.stacking_factor;
    }
  }
  return std::clamp(value, 0.0, 1.0);
}

}  // namespace hyselam_objects
