#include "place_matching.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <unordered_map>

namespace hyselam_topo {
namespace {

using Cells = std::map<Id, double>;                    // place -> area [m^2]
using Overlaps = std::map<std::pair<Id, Id>, double>;  // (old, new) -> area in common [m^2]

Cells areas(const PlaceGrid& grid) {
  std::vector<std::size_t> counts(65536, 0);
  for (const std::uint16_t label : grid.labels) ++counts[label];
  const double cell = grid.geometry.resolution * grid.geometry.resolution;
  Cells result;
  for (std::size_t k = 0; k < grid.places.size() && k < 65535; ++k) {
    if (grid.places[k] != 0 && counts[k + 1] > 0) {
      result[grid.places[k]] += cell * static_cast<double>(counts[k + 1]);
    }
  }
  return result;
}

/// How often each pair of labels meets, at the centres of the new cells.
Overlaps overlapsOf(const PlaceGrid& old, const PlaceGrid& fresh) {
  const auto& g = fresh.geometry;
  const hyselam::Pose2 to_old = hyselam::between(old.geometry.origin, g.origin);
  const double scale = g.resolution / old.geometry.resolution;
  const double c = scale * std::cos(to_old.theta), s = scale * std::sin(to_old.theta);
  const double x0 = to_old.x / old.geometry.resolution, y0 = to_old.y / old.geometry.resolution;
  std::unordered_map<std::uint32_t, std::size_t> counts;
  std::uint32_t last_key = 0;
  std::size_t* last = nullptr;  // neighbours mostly have the same labels
  for (int y = 0; y < g.height; ++y) {
    const std::uint16_t* row = &fresh.labels[g.index({0, y})];
    for (int x = 0; x < g.width; ++x) {
      if (row[x] == 0) continue;
      const double column = x0 + c * (x + 0.5) - s * (y + 0.5);
      const double line = y0 + s * (x + 0.5) + c * (y + 0.5);
      if (!(column >= 0.0 && line >= 0.0 && column < old.geometry.width &&
            line < old.geometry.height)) {
        continue;
      }
      const std::uint16_t label =
          old.labels[old.geometry.index({static_cast<int>(column), static_cast<int>(line)})];
      if (label == 0) continue;
      const std::uint32_t key = std::uint32_t{label} << 16 | row[x];
      if (last == nullptr || key != last_key) last = &counts[key];
      last_key = key;
      ++*last;
    }
  }
  Overlaps overlaps;
  for (const auto& [key, count] : counts) {
    const Id a = old.places[(key >> 16) - 1u], b = fresh.places[(key & 0xffffu) - 1u];
    if (a != 0 && b != 0) {
      overlaps[{a, b}] += g.resolution * g.resolution * static_cast<double>(count);
    }
  }
  return overlaps;
}

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
  const Cells old_area = areas(*old.grid), fresh_area = areas(*fresh.grid);
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
  for (const auto& [pair, area] : overlapsOf(*old.grid, *fresh.grid)) {
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
