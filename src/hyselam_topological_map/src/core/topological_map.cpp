#include "hyselam_topological_map/topological_map.hpp"

#include <algorithm>
#include <tuple>

namespace hyselam_topo {
namespace {

auto values(const Point3& p) {
  return std::tie(p.x, p.y, p.z);
}
auto values(const hyselam::Point2& p) {
  return std::tie(p.x, p.y);
}
auto values(const hyselam::GridGeometry& g) {
  return std::tie(g.width, g.height, g.resolution, g.origin.x, g.origin.y, g.origin.theta);
}
template <typename T>
bool same(const T& a, const T& b) {
  return values(a) == values(b);
}
template <typename T>
bool same(const std::optional<T>& a, const std::optional<T>& b) {
  return a.has_value() == b.has_value() && (!a || same(*a, *b));
}
template <typename T>
bool same(const std::vector<T>& a, const std::vector<T>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const T& x, const T& y) { return same(x, y); });
}

template <typename E>
struct NamedValue {
  E value;
  const char* name;
};
constexpr NamedValue<PlaceKind> kPlaceKinds[] = {{PlaceKind::kRoom, "room"},
                                                 {PlaceKind::kCorridor, "corridor"},
                                                 {PlaceKind::kVirtual, "virtual"}};
constexpr NamedValue<DoorState> kDoorStates[] = {
    {DoorState::kUnknown, "unknown"}, {DoorState::kOpen, "open"}, {DoorState::kClosed, "closed"}};

template <typename E, std::size_t N>
const char* nameOf(const NamedValue<E> (&table)[N], E value) {
  for (const auto& row : table) {
    if (row.value == value) return row.name;
  }
  return table[0].name;
}

template <typename E, std::size_t N>
std::optional<E> valueOf(const NamedValue<E> (&table)[N], const std::string& name) {
  for (const auto& row : table) {
    if (name == row.name) return row.value;
  }
  return std::nullopt;
}

/// Sorts by id and returns the first number that is free above all of them and not below `next`.
template <typename T>
Id sortById(std::vector<T>* things, Id next) {
  std::stable_sort(things->begin(), things->end(),
                   [](const T& a, const T& b) { return a.id < b.id; });
  return things->empty() ? next : std::max(next, things->back().id + 1);
}

}  // namespace

const Place* AugmentedTopologicalMap::findPlace(Id id) const {
  const auto it =
      std::find_if(places.begin(), places.end(), [&](const Place& p) { return p.id == id; });
  return it == places.end() ? nullptr : &*it;
}

Place* AugmentedTopologicalMap::findPlace(Id id) {
  return const_cast<Place*>(static_cast<const AugmentedTopologicalMap*>(this)->findPlace(id));
}

const Edge* AugmentedTopologicalMap::findEdge(Id a, Id b) const {
  if (a > b) std::swap(a, b);
  const auto it =
      std::find_if(edges.begin(), edges.end(), [&](const Edge& e) { return e.a == a && e.b == b; });
  return it == edges.end() ? nullptr : &*it;
}

Edge* AugmentedTopologicalMap::findEdge(Id a, Id b) {
  return const_cast<Edge*>(static_cast<const AugmentedTopologicalMap*>(this)->findEdge(a, b));
}

bool operator==(const PlaceTerm& a, const PlaceTerm& b) {
  return a.text == b.text && a.confirmed == b.confirmed;
}

bool operator==(const Appearance& a, const Appearance& b) {
  return a.type == b.type && a.rows == b.rows && a.cols == b.cols && a.values == b.values;
}

bool operator==(const Wall& a, const Wall& b) {
  const auto rest = [](const Wall& w) {
    return std::tie(w.id, w.kind, w.position_covariance, w.normal_covariance, w.length, w.height,
                    w.size_covariance, w.curvature, w.vertical_curvature, w.extras);
  };
  return rest(a) == rest(b) && same(a.position, b.position) && same(a.normal, b.normal);
}

bool operator==(const Door& a, const Door& b) {
  const auto rest = [](const Door& d) {
    return std::tie(d.id, d.real, d.state, d.position_covariance, d.width, d.height, d.appearance,
                    d.extras);
  };
  return rest(a) == rest(b) && same(a.position, b.position) && same(a.normal, b.normal);
}

bool operator==(const Edge& a, const Edge& b) {
  const auto all = [](const Edge& e) { return std::tie(e.a, e.b, e.words, e.doors, e.extras); };
  return all(a) == all(b);
}

bool operator==(const VisualSignature& a, const VisualSignature& b) {
  const auto rest = [](const VisualSignature& v) {
    return std::tie(v.appearance, v.position_covariance, v.heading, v.aperture_x, v.aperture_y,
                    v.stamp, v.extras);
  };
  return rest(a) == rest(b) && same(a.position, b.position);
}

bool operator==(const Place& a, const Place& b) {
  const auto rest = [](const Place& p) {
    return std::tie(p.id, p.kind, p.words, p.walls, p.signatures, p.area, p.extras);
  };
  return rest(a) == rest(b) && same(a.centre, b.centre) && same(a.outline, b.outline);
}

bool operator==(const PlaceGrid& a, const PlaceGrid& b) {
  return same(a.geometry, b.geometry) && a.labels == b.labels && a.places == b.places;
}

bool operator==(const AugmentedTopologicalMap& a, const AugmentedTopologicalMap& b) {
  const auto all = [](const AugmentedTopologicalMap& m) {
    return std::tie(m.frame_id, m.stamp, m.places, m.edges, m.grid, m.next_place_id, m.next_wall_id,
                    m.next_door_id, m.extras);
  };
  return all(a) == all(b);
}

std::string nameOf(const Place& place) {
  const auto confirmed = std::find_if(place.words.begin(), place.words.end(),
                                      [](const PlaceTerm& word) { return word.confirmed; });
  if (confirmed != place.words.end()) return confirmed->text;
  if (!place.words.empty()) return place.words.front().text;
  return std::string(toString(place.kind)) + " " + std::to_string(place.id);
}

const char* toString(PlaceKind kind) {
  return nameOf(kPlaceKinds, kind);
}

std::optional<PlaceKind> placeKindFromString(const std::string& text) {
  return valueOf(kPlaceKinds, text);
}

const char* toString(DoorState state) {
  return nameOf(kDoorStates, state);
}

std::optional<DoorState> doorStateFromString(const std::string& text) {
  return valueOf(kDoorStates, text);
}

double existence(WallKind kind) {
  switch (kind) {
    case WallKind::kVirtual:
      return 0.0;
    case WallKind::kGlass:
      return 0.5;
    case WallKind::kSolid:
      break;
  }
  return 1.0;
}

std::optional<WallKind> wallKindFromExistence(double existence_of_wall) {
  for (const WallKind kind : {WallKind::kVirtual, WallKind::kGlass, WallKind::kSolid}) {
    if (existence(kind) == existence_of_wall) return kind;
  }
  return std::nullopt;
}

void normalize(AugmentedTopologicalMap& map) {
  map.next_place_id = sortById(&map.places, map.next_place_id);
  for (Place& place : map.places) map.next_wall_id = sortById(&place.walls, map.next_wall_id);
  for (Edge& edge : map.edges) {
    if (edge.a > edge.b) {
      std::swap(edge.a, edge.b);
      for (Door& door : edge.doors) {
        door.normal = {-door.normal.x, -door.normal.y, -door.normal.z};
      }
    }
    map.next_door_id = sortById(&edge.doors, map.next_door_id);
  }
  std::stable_sort(map.edges.begin(), map.edges.end(), [](const Edge& a, const Edge& b) {
    return std::tie(a.a, a.b) < std::tie(b.a, b.b);
  });
}

}  // namespace hyselam_topo
