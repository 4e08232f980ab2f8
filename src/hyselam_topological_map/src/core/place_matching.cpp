#include "place_matching.hpp"

#include <algorithm>
#include <tuple>

#include "hyselam_topological_map/place_overlaps.hpp"

namespace hyselam_topo {
namespace {

/// 2: a person has named the place, 1: there are guesses, 0: no words.
int nameRank(const Place& place) {
  const bool confirmed = std::any_of(place.words.begin(), place.words.end(),
                                     [](const PlaceTerm& word) { return word.confirmed; });
  return confirmed ? 2 : place.words.empty() ? 0 : 1;
}

}  // namespace

PlaceMatching matchPlaces(const AugmentedTopologicalMap& old, const AugmentedTopologicalMap& fresh,
                          double min_overlap) {
  PlaceMatching matching;
  const PlaceAreas old_area = placeAreas(*old.grid), fresh_area = placeAreas(*fresh.grid);
  for (const Place& place : old.places) {
    if (place.kind == PlaceKind::kVirtual || old_area.count(place.id) == 0) {
      matching.described.insert(place.id);
    }
  }
  for (const Place& place : fresh.places) {
    const bool described = place.kind == PlaceKind::kVirtual || fresh_area.count(place.id) == 0;
    if (described && matching.described.count(place.id) != 0) matching.passed_over.insert(place.id);
  }

  struct Share {
    double area;
    Id place;
  };
  const auto more_first = [](const Share& a, const Share& b) {
    return std::tie(b.area, a.place) < std::tie(a.area, b.place);
  };
  std::map<Id, std::vector<Share>> of_old, of_fresh;
  for (const auto& [pair, area] : sharedAreas(*old.grid, *fresh.grid)) {
    if (matching.described.count(pair.first) != 0 || matching.passed_over.count(pair.second) != 0) {
      continue;
    }
    of_old[pair.first].push_back({area, pair.second});
    of_fresh[pair.second].push_back({area, pair.first});
  }
  for (auto& [id, shares] : of_old) {
    const Share best = *std::min_element(shares.begin(), shares.end(), more_first);
    const double smaller = std::min(old_area.at(id), fresh_area.at(best.place));
    if (best.area < min_overlap * smaller) continue;
    matching.heir[id] = best.place;
    matching.ancestors[best.place].push_back(id);
  }
  for (auto& [id, shares] : of_fresh) {
    std::sort(shares.begin(), shares.end(), more_first);
    for (const Share& share : shares) matching.touching[id].push_back(share.place);
  }
  for (auto& [id, ancestors] : matching.ancestors) {
    std::stable_sort(ancestors.begin(), ancestors.end(), [&](Id a, Id b) {
      return nameRank(*old.findPlace(a)) > nameRank(*old.findPlace(b));
    });
  }
  return matching;
}

}  // namespace hyselam_topo
