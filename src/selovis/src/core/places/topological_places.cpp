#include "selovis/places/topological_places.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_topological_map/topological_map_xml.hpp"

namespace selovis {

using hyselam_topo::AugmentedTopologicalMap;
using hyselam_topo::Id;

namespace {

std::map<Id, std::string> namesOf(const AugmentedTopologicalMap& map) {
  std::map<Id, std::string> names;
  for (const auto& place : map.places) names[place.id] = hyselam_topo::nameOf(place);
  return names;
}

/// The place at a point of the map first, then those that come within `radius` of it.
std::vector<Id> idsNear(const AugmentedTopologicalMap& map, hyselam::Point2 point, double radius) {
  std::vector<Id> ids;
  if (!map.grid || !std::isfinite(point.x) || !std::isfinite(point.y)) return ids;
  const auto& grid = *map.grid;
  const hyselam::Pose2 in_grid =
      grid.geometry.origin.inverse() * hyselam::Pose2{point.x, point.y, 0.0};
  const double r = grid.geometry.resolution;
  if (std::abs(in_grid.x / r) > 1e8 || std::abs(in_grid.y / r) > 1e8) return ids;
  const int col = static_cast<int>(std::floor(in_grid.x / r)),
            row = static_cast<int>(std::floor(in_grid.y / r));
  const int cells = static_cast<int>(std::ceil(radius / r));
  std::vector<std::pair<int, Id>> found;  // squared distance, place
  for (int dy = -cells; dy <= cells; ++dy) {
    for (int dx = -cells; dx <= cells; ++dx) {
      const int square = dx * dx + dy * dy;
      if (square * r * r > radius * radius) continue;
      const Id id = grid.placeOf({col + dx, row + dy});
      if (id != 0) found.emplace_back(square, id);
    }
  }
  std::sort(found.begin(), found.end());
  for (const auto& [square, id] : found) {
    const bool known = std::find(ids.begin(), ids.end(), id) != ids.end();
    if (!known && map.findPlace(id) != nullptr) ids.push_back(id);
  }
  return ids;
}

bool isVirtual(const AugmentedTopologicalMap& map, Id id) {
  const auto* place = map.findPlace(id);
  return place != nullptr && place->kind == hyselam_topo::PlaceKind::kVirtual;
}

/// `start` and all places that are reached from there over the edges that `through` accepts.
template <typename Through>
std::set<Id> reached(const AugmentedTopologicalMap& map, const std::set<Id>& start,
                     const Through& through) {
  std::set<Id> found = start;
  std::vector<Id> open(start.begin(), start.end());
  while (!open.empty()) {
    const Id from = open.back();
    open.pop_back();
    for (const auto& edge : map.edges) {
      if (edge.a != from && edge.b != from) continue;
      const Id to = edge.a == from ? edge.b : edge.a;
      if (map.findPlace(to) != nullptr && through(from, to) && found.insert(to).second) {
        open.push_back(to);
      }
    }
  }
  return found;
}

/// The places that have walls: those of `ids`, and those around the virtual ones of `ids`. A
/// virtual place may lie inside another.
std::set<Id> roomsAround(const AugmentedTopologicalMap& map, const std::set<Id>& ids) {
  std::set<Id> rooms;
  for (const Id id : reached(map, ids, [&](Id from, Id) { return isVirtual(map, from); })) {
    if (!isVirtual(map, id)) rooms.insert(id);
  }
  return rooms;
}

/// The rooms and the virtual places inside of them.
std::set<Id> virtualPlacesOf(const AugmentedTopologicalMap& map, const std::set<Id>& rooms) {
  return reached(map, rooms, [&](Id, Id to) { return isVirtual(map, to); });
}

}  // namespace

PlaceTransitions transitionsOf(const AugmentedTopologicalMap& map) {
  PlaceTransitions transitions;
  const auto names = namesOf(map);
  for (const auto& [id, name] : names) {
    if (transitions.indexOf(name) < 0) transitions.places.push_back(name);
  }
  for (const auto& edge : map.edges) {
    const auto a = names.find(edge.a), b = names.find(edge.b);
    if (a == names.end() || b == names.end()) continue;
    const int i = transitions.indexOf(a->second), j = transitions.indexOf(b->second);
    if (i != j && !transitions.connected(i, j)) {
      transitions.pairs.emplace_back(std::min(i, j), std::max(i, j));
    }
  }
  return transitions;
}

PlaceTransitions readTopology(const std::string& path) {
  const std::string text = hyselam::readTextFile(path, hyselam::XmlLimits().max_bytes);
  const std::size_t first = text.find_first_not_of(" \t\r\n\xEF\xBB\xBF");
  if (first != std::string::npos && text[first] == '<') {
    return transitionsOf(hyselam_topo::fromXml(text, path));
  }
  return readPlaceTransitions(path);
}

std::vector<std::string> placesNear(const AugmentedTopologicalMap& map, hyselam::Point2 point,
                                    double radius) {
  std::vector<std::string> names;
  for (const Id id : idsNear(map, point, radius)) {
    const std::string name = hyselam_topo::nameOf(*map.findPlace(id));
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
  return names;
}

ExpectedPlaces expectedPlaces(const AugmentedTopologicalMap& map, const PlaceTransitions& learned,
                              hyselam::Point2 point, double radius) {
  ExpectedPlaces expected;
  const std::vector<Id> near = idsNear(map, point, radius);
  if (near.empty()) return expected;
  const auto names = namesOf(map);
  expected.own = names.at(near.front());
  // The room counts as learned if the place at the point is, or the room around a virtual one.
  const std::set<Id> own_rooms = roomsAround(map, {near.front()});
  const auto isLearned = [&](Id id) { return learned.indexOf(names.at(id)) >= 0; };
  if (!isLearned(near.front()) && std::none_of(own_rooms.begin(), own_rooms.end(), isLearned)) {
    return expected;
  }

  std::set<std::string> agree, on_map;
  for (const auto& [id, name] : names) on_map.insert(name);
  const std::set<Id> rooms = roomsAround(map, {near.begin(), near.end()});
  for (const Id id : virtualPlacesOf(map, rooms)) agree.insert(names.at(id));
  for (const Id id : rooms) agree.insert(names.at(id));
  for (const Id id : near) agree.insert(names.at(id));
  for (std::size_t i = 0; i < learned.places.size(); ++i) {
    const int place = static_cast<int>(i);
    if (agree.count(learned.places[i]) != 0) {
      expected.agreeing.push_back(place);
    } else if (on_map.count(learned.places[i]) == 0) {
      expected.unmapped.push_back(place);
    }
  }
  return expected;
}

std::vector<PlaceRenaming> renamedPlaces(const AugmentedTopologicalMap& before,
                                         const AugmentedTopologicalMap& after) {
  constexpr double kMaxShift = 0.5;  // [m] of the center of a place that is the same
  const auto names = namesOf(after);
  std::vector<PlaceRenaming> renamings;
  for (const auto& old : before.places) {
    const auto* now = after.findPlace(old.id);
    if (now == nullptr || !now->centre || !old.centre) continue;
    const PlaceRenaming r{hyselam_topo::nameOf(old), hyselam_topo::nameOf(*now)};
    const double moved = std::hypot(now->centre->x - old.centre->x, now->centre->y - old.centre->y);
    const bool name_in_use = std::any_of(names.begin(), names.end(),
                                         [&](const auto& place) { return place.second == r.from; });
    if (r.from != r.to && moved < kMaxShift && !name_in_use) renamings.push_back(r);
  }
  return renamings;
}

std::optional<PlacePosePrior> posePriorOf(const AugmentedTopologicalMap& map,
                                          const std::string& name) {
  if (!map.grid) return {};
  const auto& grid = *map.grid;
  const double r = grid.geometry.resolution;
  std::map<Id, bool> wanted;
  for (const auto& place : map.places) wanted[place.id] = hyselam_topo::nameOf(place) == name;
  double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, yy = 0.0;
  for (int row = 0; row < grid.geometry.height; ++row) {
    for (int col = 0; col < grid.geometry.width; ++col) {
      const Id id = grid.placeOf({col, row});
      if (id == 0 || !wanted[id]) continue;
      const hyselam::Point2 p =
          grid.geometry.origin * hyselam::Point2{(col + 0.5) * r, (row + 0.5) * r};
      n += 1.0;
      x += p.x;
      y += p.y;
      xx += p.x * p.x;
      yy += p.y * p.y;
    }
  }
  if (n == 0.0) return {};
  PlacePosePrior prior;
  prior.mean = {x / n, y / n, 0.0};
  prior.stddev = {std::sqrt(std::max(r * r, xx / n - x * x / (n * n))),
                  std::sqrt(std::max(r * r, yy / n - y * y / (n * n))), hyselam::kPi};
  return prior;
}

}  // namespace selovis
