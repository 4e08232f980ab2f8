#include "hyselam_topo/dialogue/place_man.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/utf8.hpp"
#include "hyselam_topo/topomerg/place_words.hpp"
#include "hyselam_topological_map/map_geometry.hpp"
#include "plane.hpp"

namespace hyselam_topo {
namespace {

using hyselam::InputError;
using hyselam::Point2;

constexpr double kMaxRadius = 100.0;  // of a virtual place [m]
constexpr double kOnDoor = 0.3;       // from the middle of a wall to that of the door it shuts [m]
constexpr double kMaxTurned = 0.5;    // sine of the angle between them

bool isFinite(Point2 p) {
  return std::isfinite(p.x) && std::isfinite(p.y);
}

void checkWall(const DescribedWall& wall) {
  if (!isFinite(wall.line.a) || !isFinite(wall.line.b) || !(wall.line.length() > 0.0)) {
    throw InputError("wall", "", "its ends must be two different, finite points");
  }
  if (wall.kind == WallKind::kSolid) {
    throw InputError("wall", "kind", "walls that people tell of are of glass or virtual");
  }
}

void checkNames(const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    const std::string wrong = hyselam::wordError(name);
    if (!wrong.empty()) throw InputError("name", "", "it " + wrong);
  }
}

bool hasConfirmed(const Place& place) {
  return std::any_of(place.words.begin(), place.words.end(),
                     [](const PlaceTerm& word) { return word.confirmed; });
}

}  // namespace

std::string codeOf(const Place& place) {
  const char* kind = place.kind == PlaceKind::kCorridor  ? "CC"
                     : place.kind == PlaceKind::kVirtual ? "VV"
                                                         : "SS";
  char text[24];
  std::snprintf(text, sizeof text, "%s%02u", kind, static_cast<unsigned>(place.id));
  return text;
}

NameState nameStateOf(const Place& place) {
  if (place.words.empty()) return NameState::kNone;
  return hasConfirmed(place) ? NameState::kConfirmed : NameState::kUnconfirmed;
}

std::vector<std::string> namesOf(const Place& place) {
  const bool confirmed = hasConfirmed(place);
  std::vector<std::string> names;
  for (const PlaceTerm& word : place.words) {
    if (word.confirmed == confirmed) names.push_back(word.text);
  }
  return names;
}

std::vector<std::string> confirmedOf(const std::vector<PlaceTerm>& words) {
  std::vector<std::string> names;
  for (const PlaceTerm& word : words) {
    if (word.confirmed) names.push_back(word.text);
  }
  return names;
}

PlaceMan::PlaceMan(PlaceNames names) : names_(std::move(names)) {}

void PlaceMan::restore(State state) {
  if (!state.map.places.empty()) checkMap(state.map, "kept map");
  for (const DescribedWall& wall : state.walls) checkWall(wall);
  for (const ShelvedMap& map : state.shelf) checkMap(map, "shelved map");
  state_ = std::move(state);
}

Place& PlaceMan::at(Id id) {
  Place* place = state_.map.findPlace(id);
  if (place == nullptr) {
    throw InputError("places", "id " + std::to_string(id), "there is no such place in the map");
  }
  return *place;
}

PlaceMan::MapReport PlaceMan::setMap(const AugmentedTopologicalMap& fresh) {
  checkMap(fresh, "new map");
  MapReport report;
  const AugmentedTopologicalMap before = state_.map;
  std::vector<Id> unnamed;  // of before, whose words the new map does not have
  if (!hasMap() || state_.map.frame_id != fresh.frame_id || !state_.map.grid || !fresh.grid) {
    AugmentedTopologicalMap map = fresh;
    for (const Place& place : state_.map.places) report.lost.push_back(place.id);
    for (const Place& place : map.places) report.created.push_back(place.id);
    state_.map = std::move(map);
  } else {
    state_.map = carryOver(before, fresh, {}, report);
    unnamed = takeUnclear(before, report);
  }
  unnamed.insert(unnamed.end(), report.lost.begin(), report.lost.end());
  drawVirtualPlaces();
  putWalls();
  auto& rejected = state_.rejected;
  rejected.erase(
      std::remove_if(rejected.begin(), rejected.end(),
                     [&](const auto& r) { return state_.map.findPlace(r.first) == nullptr; }),
      rejected.end());
  report.seen_again = takeFromShelf();
  ShelvedMap lost = shelvedFrom(before, unnamed);
  report.shelved = lost.places.size();
  shelve(std::move(lost), &state_.shelf);
  return report;
}

std::vector<Id> PlaceMan::takeUnclear(const AugmentedTopologicalMap& before,
                                      const CarryOverReport& report) {
  constexpr std::size_t kFewest = 4;  // with fewer a single one may be most of them
  const auto segmented = static_cast<std::size_t>(
      std::count_if(before.places.begin(), before.places.end(),
                    [](const Place& p) { return p.kind != PlaceKind::kVirtual; }));
  std::vector<Id> unclear;
  if (segmented < kFewest || 2 * report.lost.size() <= segmented) return unclear;
  const std::map<Id, Id> clear = clearSuccessors(before, state_.map);
  std::map<Id, Id> successor(report.merged.begin(), report.merged.end());
  for (const Id id : report.kept) successor[id] = id;
  std::map<Id, std::vector<PlaceTerm>> words;
  for (const auto& [id, place] : successor) {
    const Place& old = *before.findPlace(id);
    if (old.kind == PlaceKind::kVirtual) continue;
    auto& left = words[place];
    if (clear.count(id) == 0) {
      unclear.push_back(id);
    } else {
      left.insert(left.end(), old.words.begin(), old.words.end());
    }
  }
  for (auto& [place, left] : words) at(place).words = std::move(left);
  return unclear;
}

// ---- The shelf ----

std::vector<Id> PlaceMan::takeFromShelf() {
  std::vector<std::string> told;  // since
  for (const Place& place : state_.map.places) {
    for (std::string& name : confirmedOf(place.words)) told.push_back(std::move(name));
  }
  const AugmentedTopologicalMap map = state_.map;
  std::vector<Id> seen;
  for (std::size_t i = state_.shelf.size(); i-- > 0;) {  // what was shelved last goes first
    const ShelvedMap shelved = state_.shelf[i];
    std::vector<Id> found;
    for (const auto& [id, place] : foundAgain(shelved, map)) {
      const Place& known = *shelved.findPlace(id);
      const bool is_virtual = known.kind == PlaceKind::kVirtual;
      // Its name waits until its middle is on the map.
      if (is_virtual && !(known.centre && placeAt(map, {known.centre->x, known.centre->y})))
        continue;
      found.push_back(id);
      const bool renamed = !is_virtual && hasConfirmed(*map.findPlace(place));
      if (known.words.empty() || renamed) continue;
      nameFromShelf(known, place, told);
      if (hasConfirmed(at(place))) seen.push_back(place);
    }
    takeFrom(i, found, &state_.shelf);
  }
  std::sort(seen.begin(), seen.end());
  seen.erase(std::unique(seen.begin(), seen.end()), seen.end());
  return seen;
}

void PlaceMan::nameFromShelf(const Place& shelved, Id place, const std::vector<std::string>& told) {
  std::vector<std::string> names;
  for (const std::string& name : confirmedOf(shelved.words)) {
    const bool elsewhere = std::any_of(told.begin(), told.end(), [&](const std::string& each) {
      return sameSpelling(each, name);
    });
    if (!elsewhere && !isRejected(place, name)) names.push_back(name);
  }
  if (names.empty()) return;
  if (shelved.kind == PlaceKind::kVirtual) {
    const hyselam::Point2 centre{shelved.centre->x, shelved.centre->y};
    addVirtualPlace(centre, std::min(kMaxRadius, std::sqrt(shelved.area / hyselam::kPi)), names);
    return;
  }
  giveWords(names, true, &at(place));
}

bool PlaceMan::isShelved(const std::string& name) const {
  for (const ShelvedMap& map : state_.shelf) {
    for (const Place& place : map.places) {
      const auto names = confirmedOf(place.words);
      if (!names_.find(name, {names}).empty()) return true;
    }
  }
  return false;
}

bool PlaceMan::forgetShelved(const std::string& name) {
  const std::size_t before = wordedPlaces(state_.shelf);
  for (std::size_t i = state_.shelf.size(); i-- > 0;) {
    for (Place& place : state_.shelf[i].places) dropWord(&place, name, false);
    takeFrom(i, {}, &state_.shelf);
  }
  return wordedPlaces(state_.shelf) != before;
}

// ---- Names ----

void PlaceMan::dropWord(Place* place, const std::string& name, bool of_kind) {
  auto& words = place->words;
  const auto is_meant = [&](const PlaceTerm& word) {
    return of_kind ? sameName(word.text, name) : sameSpelling(word.text, name);
  };
  words.erase(std::remove_if(words.begin(), words.end(), is_meant), words.end());
}

std::vector<Id> PlaceMan::confirm(Id id, const std::vector<std::string>& names) {
  Place& place = at(id);
  checkNames(names);
  std::vector<Id> losers;
  for (Place& other : state_.map.places) {
    if (other.id == id) continue;
    // Rooms may be cut into several places: those side by side may have one name.
    const bool beside = state_.map.findEdge(id, other.id) != nullptr;
    for (const std::string& name : names) {
      const bool had = std::any_of(
          other.words.begin(), other.words.end(),
          [&](const PlaceTerm& word) { return word.confirmed && sameSpelling(word.text, name); });
      if (had && beside) continue;
      if (had) losers.push_back(other.id);
      dropWord(&other, name, false);
    }
  }
  giveWords(names, true, &place);
  auto& rejected = state_.rejected;
  rejected.erase(std::remove_if(rejected.begin(), rejected.end(),
                                [&](const auto& r) {
                                  return r.first == id &&
                                         std::any_of(
                                             names.begin(), names.end(),
                                             [&](const auto& n) { return sameName(r.second, n); });
                                }),
                 rejected.end());
  std::sort(losers.begin(), losers.end());
  losers.erase(std::unique(losers.begin(), losers.end()), losers.end());
  return losers;
}

bool PlaceMan::confirmGuesses(Id id) {
  const Place& place = at(id);
  if (nameStateOf(place) != NameState::kUnconfirmed) return false;
  confirm(id, namesOf(place));
  return true;
}

void PlaceMan::reject(Id id, const std::vector<std::string>& names) {
  Place& place = at(id);
  for (const std::string& name : names) {
    dropWord(&place, name, true);
    if (!isRejected(id, name)) state_.rejected.emplace_back(id, name);
  }
}

bool PlaceMan::isRejected(Id id, const std::string& name) const {
  return std::any_of(state_.rejected.begin(), state_.rejected.end(),
                     [&](const auto& r) { return r.first == id && sameName(r.second, name); });
}

void PlaceMan::guess(const std::vector<std::pair<Id, std::vector<std::string>>>& guesses) {
  for (Place& place : state_.map.places) {
    auto& words = place.words;
    words.erase(std::remove_if(words.begin(), words.end(),
                               [](const PlaceTerm& word) { return !word.confirmed; }),
                words.end());
  }
  for (const auto& [id, names] : guesses) {
    Place& place = at(id);
    if (hasConfirmed(place)) continue;
    for (const std::string& name : names) {
      if (!isRejected(id, name)) place.words.push_back({name, false});
    }
  }
}

PlaceMan::Names PlaceMan::names() const {
  Names names;
  for (const Place& place : state_.map.places) names.words[place.id] = place.words;
  names.rejected = state_.rejected;
  return names;
}

void PlaceMan::restoreNames(const Names& before) {
  for (Place& place : state_.map.places) {
    const auto found = before.words.find(place.id);
    if (found != before.words.end()) place.words = found->second;
  }
  state_.rejected.clear();
  for (const auto& each : before.rejected) {
    if (state_.map.findPlace(each.first) != nullptr) state_.rejected.push_back(each);
  }
}

bool PlaceMan::forget(Id id) {
  Place& place = at(id);
  const bool had = !place.words.empty();
  place.words.clear();
  return had;
}

std::vector<Id> PlaceMan::forgetName(const std::string& name) {
  // "Forget the bathroom" means the one that is called so, and where none is, a "casa de banho".
  const auto hasSpelling = [&](const Place& place) {
    return std::any_of(place.words.begin(), place.words.end(),
                       [&](const PlaceTerm& word) { return sameSpelling(word.text, name); });
  };
  const auto& all = state_.map.places;
  const bool of_kind = std::none_of(all.begin(), all.end(), hasSpelling);
  std::vector<Id> had;
  for (Place& place : state_.map.places) {
    const std::size_t before = place.words.size();
    dropWord(&place, name, of_kind);
    if (place.words.size() != before) had.push_back(place.id);
  }
  return had;
}

void PlaceMan::forgetAllNames() {
  for (Place& place : state_.map.places) place.words.clear();
  state_.rejected.clear();
  state_.shelf.clear();
}

std::vector<Id> PlaceMan::rename(Id id, const std::vector<std::string>& names) {
  std::vector<Id> losers = confirm(id, names);
  auto& words = at(id).words;
  words.clear();
  for (const std::string& name : names) {
    const bool twice = std::any_of(words.begin(), words.end(),
                                   [&](const PlaceTerm& word) { return word.text == name; });
    if (!twice) words.push_back({name, true});
  }
  return losers;
}

std::vector<Id> PlaceMan::find(const std::string& name) const {
  // The map's own name is that place whatever people call others.
  for (const Place& place : state_.map.places) {
    if (codeOf(place) == name) return {place.id};
  }
  for (const bool confirmed : {true, false}) {
    std::vector<std::vector<std::string>> lists;
    for (const Place& place : state_.map.places) {
      lists.emplace_back();
      if (confirmed) lists.back().push_back(codeOf(place));
      for (const PlaceTerm& word : place.words) {
        if (word.confirmed == confirmed) lists.back().push_back(word.text);
      }
    }
    std::vector<Id> found;
    for (const std::size_t i : names_.find(name, lists)) {
      found.push_back(state_.map.places[i].id);
    }
    if (!found.empty()) return found;
  }
  return {};
}

bool PlaceMan::sameSpelling(const std::string& a, const std::string& b) const {
  NameKey first = names_.key(a), second = names_.key(b);
  first.kind.clear();
  second.kind.clear();
  return a == b || compare(first, second) != SameName::kNo;
}

bool PlaceMan::sameName(const std::string& a, const std::string& b) const {
  return a == b || compare(names_.key(a), names_.key(b)) != SameName::kNo;
}

// ---- Virtual places and walls ----

Id PlaceMan::addVirtualPlace(Point2 centre, double radius, const std::vector<std::string>& names) {
  if (!(radius > 0.0 && radius <= kMaxRadius)) {
    throw InputError("virtual place", "radius", "it must be in (0, 100] m");
  }
  checkNames(names);  // nothing is added when they are refused
  const auto around = placeAt(state_.map, centre);
  if (!around) throw InputError("virtual place", "centre", "there is no place at this point");
  AugmentedTopologicalMap& map = state_.map;
  Place place;
  place.id = map.next_place_id++;
  place.kind = PlaceKind::kVirtual;
  place.area = hyselam::kPi * radius * radius;
  place.centre = Point3{centre.x, centre.y, 0.0};
  constexpr int kCorners = 24;
  for (int i = 0; i < kCorners; ++i) {
    const double angle = 2.0 * hyselam::kPi * i / kCorners;
    place.outline.push_back(
        {centre.x + radius * std::cos(angle), centre.y + radius * std::sin(angle)});
  }
  Wall wall;  // its limit is a circle, which it lies within
  wall.id = map.next_wall_id++;
  wall.kind = WallKind::kVirtual;
  wall.position = *place.centre;
  wall.length = 2.0 * hyselam::kPi * radius * (1.0 - 1e-9);  // never more than the full circle
  wall.curvature = 1.0 / radius;
  place.walls.push_back(wall);
  Edge edge;
  edge.a = around->place;
  edge.b = place.id;
  const Id id = place.id;
  map.places.push_back(std::move(place));
  map.edges.push_back(std::move(edge));
  normalize(map);
  drawVirtualPlaces();
  if (!names.empty()) confirm(id, names);
  return id;
}

bool PlaceMan::removeVirtualPlace(Id id) {
  AugmentedTopologicalMap& map = state_.map;
  const Place* place = map.findPlace(id);
  if (place == nullptr || place->kind != PlaceKind::kVirtual) return false;
  Id around = 0;
  for (const Edge& edge : map.edges) {
    if (edge.a == id || edge.b == id) around = edge.a == id ? edge.b : edge.a;
  }
  map.edges.erase(std::remove_if(map.edges.begin(), map.edges.end(),
                                 [&](const Edge& e) { return e.a == id || e.b == id; }),
                  map.edges.end());
  map.places.erase(std::remove_if(map.places.begin(), map.places.end(),
                                  [&](const Place& p) { return p.id == id; }),
                   map.places.end());
  if (map.grid) {
    // Two labels may mean one place.
    for (Id& meant : map.grid->places) {
      if (meant == id) meant = around;
    }
  }
  return true;
}

void PlaceMan::drawVirtualPlaces() {
  AugmentedTopologicalMap& map = state_.map;
  if (!map.grid) return;
  PlaceGrid& grid = *map.grid;
  for (const Place& place : map.places) {
    if (place.kind != PlaceKind::kVirtual || place.outline.size() < 3) continue;
    if (std::find(grid.places.begin(), grid.places.end(), place.id) != grid.places.end()) continue;
    if (grid.places.size() >= std::numeric_limits<std::uint16_t>::max()) return;
    // Only what belongs to the place around its middle: no circle reaches through a wall.
    const auto cell = place.centre ? grid.geometry.cellAt({place.centre->x, place.centre->y})
                                   : hyselam::Cell{-1, -1};
    const Id around = grid.placeOf(cell);
    if (around == 0) continue;
    const auto label = static_cast<std::uint16_t>(grid.places.size() + 1);
    bool any = false;
    for (int y = 0; y < grid.geometry.height; ++y) {
      for (int x = 0; x < grid.geometry.width; ++x) {
        if (grid.placeOf({x, y}) != around) continue;
        if (!contains(place.outline, grid.geometry.center({x, y}))) continue;
        grid.labels[grid.geometry.index({x, y})] = label;
        any = true;
      }
    }
    if (any) grid.places.push_back(place.id);
    if (map.findEdge(place.id, around) == nullptr) {
      Edge edge;
      edge.a = std::min(place.id, around);
      edge.b = std::max(place.id, around);
      map.edges.push_back(edge);
    }
  }
  normalize(map);
}

void PlaceMan::putWalls() {
  for (const DescribedWall& wall : state_.walls) putWall(wall, &state_.map);
}

void PlaceMan::addWall(const DescribedWall& wall) {
  checkWall(wall);
  const bool known = std::any_of(
      state_.walls.begin(), state_.walls.end(),
      [&](const DescribedWall& w) { return w.kind == wall.kind && sameWall(w.line, wall.line); });
  if (known) return;
  state_.walls.push_back(wall);
  putWalls();
}

bool PlaceMan::removeWall(std::size_t index) {
  if (index >= state_.walls.size()) return false;
  const DescribedWall gone = state_.walls[index];
  state_.walls.erase(state_.walls.begin() + static_cast<std::ptrdiff_t>(index));
  for (Place& place : state_.map.places) {
    auto& walls = place.walls;
    walls.erase(std::remove_if(walls.begin(), walls.end(),
                               [&](const Wall& wall) {
                                 if (wall.kind != gone.kind || wall.curvature != 0.0) return false;
                                 const auto line = polyline(wall);
                                 return sameWall({line.front(), line.back()}, gone.line);
                               }),
                walls.end());
  }
  return true;
}

bool PlaceMan::removeWall(const DescribedWall& wall) {
  const auto found = std::find_if(
      state_.walls.begin(), state_.walls.end(),
      [&](const DescribedWall& w) { return w.kind == wall.kind && sameWall(w.line, wall.line); });
  return removeWall(static_cast<std::size_t>(found - state_.walls.begin()));
}

const Door* PlaceMan::doorShutBy(const DescribedWall& wall) const {
  if (wall.kind != WallKind::kVirtual) return nullptr;
  const WallLine& line = wall.line;
  const double length = line.length();
  const Point2 middle{0.5 * (line.a.x + line.b.x), 0.5 * (line.a.y + line.b.y)};
  for (const Edge& edge : state_.map.edges) {
    for (const Door& door : edge.doors) {
      const double across =
          std::abs((line.b.x - line.a.x) * door.normal.x + (line.b.y - line.a.y) * door.normal.y);
      const bool lies_along = across <= kMaxTurned * length;
      const double off = distanceBetween(middle, {door.position.x, door.position.y});
      const bool is_as_wide =
          length >= door.width - kOnDoor && length <= door.width + 2.0 * kOnDoor;
      if (door.real && lies_along && is_as_wide && off <= kOnDoor) return &door;
    }
  }
  return nullptr;
}

std::vector<bool> PlaceMan::wallsOnDoors() const {
  std::vector<bool> on_doors;
  for (const DescribedWall& wall : state_.walls) on_doors.push_back(doorShutBy(wall) != nullptr);
  return on_doors;
}

std::vector<Id> PlaceMan::shutDoors() const {
  std::vector<Id> shut;
  for (const DescribedWall& wall : state_.walls) {
    if (const Door* door = doorShutBy(wall)) shut.push_back(door->id);
  }
  return shut;
}

hyselam::OccupancyGrid PlaceMan::withWalls(const hyselam::OccupancyGrid& grid) const {
  hyselam::OccupancyGrid copy = grid;
  std::vector<WallLine> lines;
  for (const DescribedWall& wall : state_.walls) {
    if (doorShutBy(wall) == nullptr) lines.push_back(wall.line);
  }
  drawWalls(lines, &copy);
  return copy;
}

}  // namespace hyselam_topo
