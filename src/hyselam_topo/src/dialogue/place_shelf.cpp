#include "hyselam_topo/dialogue/place_shelf.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include "hyselam_topological_map/carry_over.hpp"
#include "hyselam_topological_map/place_overlaps.hpp"

namespace hyselam_topo {
namespace {

constexpr std::size_t kMostPlaces = 500;
constexpr double kClear = 0.75;       // shared part of the cells of both
constexpr double kClearAlone = 0.85;  // ... where no other place bears witness
constexpr double kMostFound = 0.6;    // part of the places
constexpr std::size_t kFewest = 2;    // places

std::size_t wordedPlaces(const ShelvedMap& map) {
  return static_cast<std::size_t>(std::count_if(map.places.begin(), map.places.end(),
                                                [](const Place& p) { return !p.words.empty(); }));
}

/// Only the cells of the places that are left.
PlaceGrid cutOut(const PlaceGrid& grid, const std::set<Id>& places) {
  const hyselam::GridGeometry& g = grid.geometry;
  int left = g.width, right = -1, bottom = g.height, top = -1;
  for (int y = 0; y < g.height; ++y) {
    for (int x = 0; x < g.width; ++x) {
      if (places.count(grid.placeOf({x, y})) == 0) continue;
      left = std::min(left, x);
      right = std::max(right, x);
      bottom = std::min(bottom, y);
      top = std::max(top, y);
    }
  }
  if (right < 0) left = right = bottom = top = 0;  // of places without a cell
  PlaceGrid cut;
  cut.geometry = g;
  cut.geometry.width = right - left + 1;
  cut.geometry.height = top - bottom + 1;
  cut.geometry.origin = g.origin * hyselam::Pose2{left * g.resolution, bottom * g.resolution, 0.0};
  cut.labels.assign(cut.geometry.cellCount(), 0);
  cut.places.assign(places.begin(), places.end());
  for (int y = bottom; y <= top; ++y) {
    for (int x = left; x <= right; ++x) {
      const auto found = places.find(grid.placeOf({x, y}));
      if (found == places.end()) continue;
      cut.labels[cut.geometry.index({x - left, y - bottom})] =
          static_cast<std::uint16_t>(std::distance(places.begin(), found) + 1);
    }
  }
  return cut;
}

/// The new place that a place shares most with, and the shared part of the cells of both.
struct Successor {
  Id place = 0;
  double shared = 0.0;  ///< [m^2]
  double clearness = 0.0;
};

std::map<Id, Successor> successors(const AugmentedTopologicalMap& old,
                                   const AugmentedTopologicalMap& fresh) {
  std::map<Id, Successor> best;
  if (!old.grid || !fresh.grid || old.frame_id != fresh.frame_id) return best;
  const PlaceAreas old_areas = placeAreas(*old.grid), areas = placeAreas(*fresh.grid);
  for (const auto& [pair, shared] : sharedAreas(*old.grid, *fresh.grid)) {
    Successor& successor = best[pair.first];
    if (shared <= successor.shared) continue;
    const double all = old_areas.at(pair.first) + areas.at(pair.second) - shared;
    successor = {pair.second, shared, shared / all};
  }
  return best;
}

}  // namespace

ShelvedMap shelvedFrom(const AugmentedTopologicalMap& map, const std::vector<Id>& places) {
  ShelvedMap shelved;
  shelved.frame_id = map.frame_id;
  shelved.stamp = map.stamp;
  shelved.next_place_id = map.next_place_id;
  std::set<Id> ids;
  for (const Place& place : map.places) {
    if (std::find(places.begin(), places.end(), place.id) == places.end()) continue;
    Place kept;
    kept.id = place.id;
    kept.kind = place.kind;
    for (const PlaceTerm& word : place.words) {
      if (word.confirmed) kept.words.push_back(word);
    }
    if (kept.words.empty()) continue;
    kept.area = place.area;
    kept.centre = place.centre;
    kept.outline = place.outline;
    ids.insert(kept.id);
    shelved.places.push_back(std::move(kept));
  }
  if (map.grid && !ids.empty()) shelved.grid = cutOut(*map.grid, ids);
  return shelved;
}

std::size_t wordedPlaces(const Shelf& shelf) {
  std::size_t count = 0;
  for (const ShelvedMap& map : shelf) count += wordedPlaces(map);
  return count;
}

void shelve(ShelvedMap lost, Shelf* shelf) {
  if (wordedPlaces(lost) == 0) return;
  shelf->push_back(std::move(lost));
  for (std::size_t count = wordedPlaces(*shelf); count > kMostPlaces;) {
    // The oldest map loses as many as are too many, the last of its places first.
    std::vector<Id> too_many;
    const auto& places = shelf->front().places;
    for (std::size_t i = places.size(); i-- > 0 && count > kMostPlaces;) {
      if (places[i].words.empty()) continue;
      too_many.push_back(places[i].id);
      --count;
    }
    takeFrom(0, too_many, shelf);
  }
}

void takeFrom(std::size_t shelved, const std::vector<Id>& places, Shelf* shelf) {
  ShelvedMap& map = (*shelf)[shelved];
  for (const Id id : places) {
    if (Place* place = map.findPlace(id)) place->words.clear();
  }
  if (wordedPlaces(map) == 0) shelf->erase(shelf->begin() + static_cast<std::ptrdiff_t>(shelved));
}

std::map<Id, Id> clearSuccessors(const AugmentedTopologicalMap& old,
                                 const AugmentedTopologicalMap& fresh) {
  std::map<Id, Id> clear;
  for (const auto& [id, successor] : successors(old, fresh)) {
    if (successor.clearness >= kClear) clear[id] = successor.place;
  }
  return clear;
}

std::map<Id, Id> foundAgain(const ShelvedMap& shelved, const AugmentedTopologicalMap& fresh) {
  const auto best = successors(shelved, fresh);
  // Virtual places are found by no segmentation.
  const auto& places = shelved.places;
  const auto all = static_cast<std::size_t>(std::count_if(
      places.begin(), places.end(), [](const Place& p) { return p.kind != PlaceKind::kVirtual; }));
  const double least = all == 1 ? kClearAlone : kClear;
  const auto clear =
      static_cast<std::size_t>(std::count_if(best.begin(), best.end(), [&](const auto& each) {
        return each.second.clearness >= least &&
               shelved.findPlace(each.first)->kind != PlaceKind::kVirtual;
      }));
  const bool most = static_cast<double>(clear) >= kMostFound * static_cast<double>(all);
  if (all == 0 || !most || clear < std::min(kFewest, all)) return {};
  // It is the same map: what is less clear goes on as in any new segmentation.
  const PlaceAreas areas = placeAreas(*fresh.grid), old_areas = placeAreas(*shelved.grid);
  std::map<Id, Id> found;
  for (const auto& [id, successor] : best) {
    const double smaller = std::min(old_areas.at(id), areas.at(successor.place));
    if (successor.shared >= CarryOverParams().min_overlap * smaller) found[id] = successor.place;
  }
  return found;
}

}  // namespace hyselam_topo
