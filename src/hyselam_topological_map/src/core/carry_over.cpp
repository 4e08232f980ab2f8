#include "hyselam_topological_map/carry_over.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "hyselam_common/errors.hpp"
#include "place_matching.hpp"

namespace hyselam_topo {
namespace {

void unite(const std::vector<PlaceTerm>& more, std::vector<PlaceTerm>& words) {
  for (const PlaceTerm& word : more) {
    const auto same = std::find_if(words.begin(), words.end(),
                                   [&](const PlaceTerm& w) { return w.text == word.text; });
    if (same == words.end()) {
      words.push_back(word);
    } else {
      same->confirmed = same->confirmed || word.confirmed;
    }
  }
}

/// What the new map knows goes before what the old one knew.
void unite(const Extras& more, Extras& extras) {
  for (const auto& attribute : more.attributes) {
    const bool known =
        std::any_of(extras.attributes.begin(), extras.attributes.end(),
                    [&](const auto& other) { return other.first == attribute.first; });
    if (!known) extras.attributes.push_back(attribute);
  }
  for (const std::string& element : more.elements) {
    if (std::find(extras.elements.begin(), extras.elements.end(), element) ==
        extras.elements.end()) {
      extras.elements.push_back(element);
    }
  }
}

void unite(const std::vector<VisualSignature>& more, std::vector<VisualSignature>& signatures) {
  for (const VisualSignature& signature : more) {
    if (std::find(signatures.begin(), signatures.end(), signature) == signatures.end()) {
      signatures.push_back(signature);
    }
  }
}

double dot(const Point3& a, const Point3& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

Point3 difference(const Point3& a, const Point3& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}

Point3 opposite(const Point3& p) {
  return {-p.x, -p.y, -p.z};
}

/// A possible pair of an old and a new thing; the smallest cost is taken first.
struct Pair {
  double cost;
  Id old_id;
  std::size_t old_index, new_index;
  bool operator<(const Pair& o) const {
    return std::tie(cost, old_id, new_index) < std::tie(o.cost, o.old_id, o.new_index);
  }
};

/// Gives each thing at most one partner.
template <typename Use>
void matchGreedily(std::vector<Pair> pairs, std::size_t old_count, std::size_t new_count,
                   const Use& use) {
  std::sort(pairs.begin(), pairs.end());
  std::vector<bool> old_used(old_count, false), new_used(new_count, false);
  for (const Pair& pair : pairs) {
    if (old_used[pair.old_index] || new_used[pair.new_index]) continue;
    old_used[pair.old_index] = new_used[pair.new_index] = true;
    use(pair.old_index, pair.new_index);
  }
}

class CarryOver {
 public:
  CarryOver(const AugmentedTopologicalMap& old, const AugmentedTopologicalMap& fresh,
            const CarryOverParams& params)
      : old_(old),
        fresh_(fresh),
        params_(params),
        matching_(matchPlaces(old, fresh, params.min_overlap)) {}

  AugmentedTopologicalMap run(CarryOverReport& report) {
    map_.frame_id = fresh_.frame_id;
    map_.stamp = fresh_.stamp;
    map_.extras = fresh_.extras;
    unite(old_.extras, map_.extras);
    map_.next_place_id = old_.next_place_id;
    map_.next_wall_id = old_.next_wall_id;
    map_.next_door_id = old_.next_door_id;
    places(report);
    walls();
    edges();
    doors();
    oldEdges();
    PlaceGrid grid = *fresh_.grid;
    for (Id& id : grid.places) id = newId(id);
    map_.grid = std::move(grid);
    normalize(map_);
    return std::move(map_);
  }

 private:
  /// Ids are never used again, and the next one must be a number as well.
  static Id takeId(Id& next) {
    if (next == std::numeric_limits<Id>::max()) {
      throw hyselam::InputError("old map", "", "it has no ids left for new places, walls or doors");
    }
    return next++;
  }

  /// The id in the result of a place of the fresh map; 0 if it has none.
  Id newId(Id fresh_id) const {
    const auto it = new_id_.find(fresh_id);
    return it == new_id_.end() ? 0 : it->second;
  }

  /// The id in the result of a place of the old map; 0 if it is lost.
  Id successor(Id old_id) const {
    if (matching_.described.count(old_id) != 0) return old_id;
    const auto it = matching_.heir.find(old_id);
    return it == matching_.heir.end() ? 0 : newId(it->second);
  }

  void places(CarryOverReport& report) {
    for (const Place& fresh : fresh_.places) {
      if (matching_.passed_over.count(fresh.id) != 0) {
        new_id_[fresh.id] = fresh.id;
        continue;
      }
      Place place = fresh;
      const auto ancestors = matching_.ancestors.find(fresh.id);
      if (ancestors == matching_.ancestors.end()) {
        place.id = takeId(map_.next_place_id);
        report.created.push_back(place.id);
        const auto touching = matching_.touching.find(fresh.id);
        if (touching != matching_.touching.end()) {
          report.split_off.emplace_back(place.id, touching->second.front());
        }
      } else {
        place.id = ancestors->second.front();
        report.kept.push_back(place.id);
        std::vector<PlaceTerm> words;
        std::vector<VisualSignature> signatures;
        for (const Id id : ancestors->second) {
          const Place& ancestor = *old_.findPlace(id);
          unite(ancestor.words, words);
          unite(ancestor.signatures, signatures);
          unite(ancestor.extras, place.extras);
          if (id != place.id) report.merged.emplace_back(id, place.id);
        }
        unite(place.words, words);
        unite(place.signatures, signatures);
        place.words = std::move(words);
        place.signatures = std::move(signatures);
      }
      new_id_[fresh.id] = place.id;
      map_.places.push_back(std::move(place));
    }
    for (const Place& place : old_.places) {
      if (matching_.described.count(place.id) != 0) {
        map_.places.push_back(place);
        report.kept.push_back(place.id);
      } else if (matching_.heir.count(place.id) == 0) {
        report.lost.push_back(place.id);
      }
    }
    std::sort(report.kept.begin(), report.kept.end());
    std::sort(report.merged.begin(), report.merged.end());
  }

  /// The length that two walls share if they may be the same, else nothing.
  std::optional<double> sharedLength(const Wall& old, const Wall& fresh) const {
    if (dot(old.normal, fresh.normal) < std::cos(params_.max_wall_turn)) return std::nullopt;
    const Point3 moved = difference(fresh.position, old.position);
    if (std::abs(dot(moved, old.normal)) > params_.max_wall_shift) return std::nullopt;
    const double along = std::abs(moved.x * old.normal.y - moved.y * old.normal.x);
    const double shorter = std::min(old.length, fresh.length);
    const double shared = std::min(shorter, 0.5 * (old.length + fresh.length) - along);
    if (shared < params_.min_wall_overlap * shorter) return std::nullopt;
    return shared;
  }

  void walls() {
    std::map<Id, std::vector<std::size_t>> of_old_place;
    std::vector<const Wall*> old_walls;
    std::vector<Id> owner;
    for (const Place& place : old_.places) {
      if (matching_.described.count(place.id) != 0) continue;
      for (const Wall& wall : place.walls) {
        of_old_place[place.id].push_back(old_walls.size());
        old_walls.push_back(&wall);
        owner.push_back(place.id);
      }
    }
    std::vector<Wall*> new_walls;
    std::vector<Pair> pairs;
    for (const Place& fresh : fresh_.places) {
      if (matching_.passed_over.count(fresh.id) != 0) continue;
      Place& place = *map_.findPlace(newId(fresh.id));
      for (Wall& wall : place.walls) {
        wall.id = 0;
        const auto touching = matching_.touching.find(fresh.id);
        if (touching != matching_.touching.end()) {
          for (const Id old_place : touching->second) {
            for (const std::size_t i : of_old_place[old_place]) {
              const auto shared = sharedLength(*old_walls[i], wall);
              if (shared) pairs.push_back({-*shared, old_walls[i]->id, i, new_walls.size()});
            }
          }
        }
        new_walls.push_back(&wall);
      }
    }
    std::vector<bool> found(old_walls.size(), false);
    matchGreedily(std::move(pairs), old_walls.size(), new_walls.size(),
                  [&](std::size_t i, std::size_t j) {
                    const Wall& from = *old_walls[i];
                    Wall& to = *new_walls[j];
                    found[i] = true;
                    to.id = from.id;
                    if (from.kind == WallKind::kGlass) to.kind = WallKind::kGlass;
                    if (to.height == 0.0) to.height = from.height;
                    unite(from.extras, to.extras);
                  });
    for (Wall* wall : new_walls) {
      if (wall->id == 0) wall->id = takeId(map_.next_wall_id);
    }
    for (std::size_t i = 0; i < old_walls.size(); ++i) {
      const Id place = successor(owner[i]);
      if (!found[i] && old_walls[i]->kind == WallKind::kGlass && place != 0) {
        map_.findPlace(place)->walls.push_back(*old_walls[i]);
      }
    }
  }

  void edges() {
    for (const Edge& fresh : fresh_.edges) {
      if (matching_.passed_over.count(fresh.a) + matching_.passed_over.count(fresh.b) != 0) {
        continue;
      }
      Edge edge = fresh;
      edge.a = newId(fresh.a);
      edge.b = newId(fresh.b);
      if (edge.a > edge.b) {
        std::swap(edge.a, edge.b);
        for (Door& door : edge.doors) door.normal = opposite(door.normal);
      }
      map_.edges.push_back(std::move(edge));
    }
  }

  bool isDescribed(const Edge& old_edge) const {
    return matching_.described.count(old_edge.a) + matching_.described.count(old_edge.b) != 0;
  }

  void doors() {
    std::vector<const Door*> old_doors;
    for (const Edge& edge : old_.edges) {
      if (isDescribed(edge)) continue;
      for (const Door& door : edge.doors) old_doors.push_back(&door);
    }
    std::vector<Door*> new_doors;
    for (Edge& edge : map_.edges) {
      for (Door& door : edge.doors) new_doors.push_back(&door);
    }
    std::vector<Pair> pairs;
    for (std::size_t j = 0; j < new_doors.size(); ++j) {
      for (std::size_t i = 0; i < old_doors.size(); ++i) {
        const Point3 moved = difference(new_doors[j]->position, old_doors[i]->position);
        const double shift = std::sqrt(dot(moved, moved));
        const double width = std::max(old_doors[i]->width, new_doors[j]->width);
        if (shift > std::max(params_.max_door_shift, 0.5 * width)) continue;
        // Of two doors at a corner the one that is not turned.
        const double turn = 1.0 - std::abs(dot(new_doors[j]->normal, old_doors[i]->normal));
        pairs.push_back({shift + turn, old_doors[i]->id, i, j});
      }
    }
    for (Door* door : new_doors) door->id = 0;
    matchGreedily(std::move(pairs), old_doors.size(), new_doors.size(),
                  [&](std::size_t i, std::size_t j) {
                    const Door& from = *old_doors[i];
                    Door& to = *new_doors[j];
                    to.id = from.id;
                    if (to.state == DoorState::kUnknown) to.state = from.state;
                    if (to.height == 0.0) to.height = from.height;
                    if (!to.appearance) to.appearance = from.appearance;
                    unite(from.extras, to.extras);
                  });
    for (Door* door : new_doors) {
      if (door->id == 0) door->id = takeId(map_.next_door_id);
    }
  }

  /// What people have said about connections.
  void oldEdges() {
    for (const Edge& old : old_.edges) {
      Id a = successor(old.a), b = successor(old.b);
      if (a == 0 || b == 0 || a == b) continue;
      const bool described = isDescribed(old);
      Edge* edge = map_.findEdge(a, b);
      if (edge == nullptr) {
        if (!described && old.words.empty()) continue;
        map_.edges.emplace_back();
        edge = &map_.edges.back();
        edge->a = std::min(a, b);
        edge->b = std::max(a, b);
      }
      unite(old.words, edge->words);
      unite(old.extras, edge->extras);
      if (!described) continue;
      for (Door door : old.doors) {
        if (a > b) door.normal = opposite(door.normal);
        edge->doors.push_back(std::move(door));
      }
    }
  }

  const AugmentedTopologicalMap& old_;
  const AugmentedTopologicalMap& fresh_;
  const CarryOverParams& params_;
  const PlaceMatching matching_;
  std::map<Id, Id> new_id_;  // place of the fresh map -> place of the result
  AugmentedTopologicalMap map_;
};

}  // namespace

void CarryOverParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("min_overlap", min_overlap, Range::aboveUpTo(0.0, 1.0), "",
        "part of the smaller of two places that they share to be the same");
  visit("max_door_shift", max_door_shift, Range::atLeast(0.0), "m", "of a door that is the same");
  visit("max_wall_shift", max_wall_shift, Range::atLeast(0.0), "m",
        "sideways, of a wall that is the same");
  visit("max_wall_turn", max_wall_turn, Range::between(0.0, 0.5 * hyselam::kPi), "rad",
        "of a wall that is the same");
  visit("min_wall_overlap", min_wall_overlap, Range::aboveUpTo(0.0, 1.0), "",
        "part of the shorter of two walls that they share to be the same");
}

void CarryOverParams::validate() const {
  hyselam::checkParameters(*this);
}

AugmentedTopologicalMap carryOver(const AugmentedTopologicalMap& old,
                                  const AugmentedTopologicalMap& fresh,
                                  const CarryOverParams& params, CarryOverReport& report) {
  params.validate();
  checkMap(old, "old map");
  checkMap(fresh, "new map");
  if (!old.grid || !fresh.grid) {
    throw hyselam::InputError(!old.grid ? "old map" : "new map", "", "it has no grid");
  }
  if (old.frame_id != fresh.frame_id) {
    throw hyselam::InputError(
        "new map", "frame_id",
        "it is '" + fresh.frame_id + "', that of the old map is '" + old.frame_id + "'");
  }
  report = {};
  return CarryOver(old, fresh, params).run(report);
}

AugmentedTopologicalMap carryOver(const AugmentedTopologicalMap& old,
                                  const AugmentedTopologicalMap& fresh,
                                  const CarryOverParams& params) {
  CarryOverReport report;
  return carryOver(old, fresh, params, report);
}

}  // namespace hyselam_topo
