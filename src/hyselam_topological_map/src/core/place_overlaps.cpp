#include "hyselam_topological_map/place_overlaps.hpp"

#include <cmath>
#include <cstdint>
#include <unordered_map>

namespace hyselam_topo {

PlaceAreas placeAreas(const PlaceGrid& grid) {
  std::vector<std::size_t> counts(65536, 0);
  for (const std::uint16_t label : grid.labels) ++counts[label];
  const double cell = grid.geometry.resolution * grid.geometry.resolution;
  PlaceAreas result;
  for (std::size_t k = 0; k < grid.places.size() && k < 65535; ++k) {
    if (grid.places[k] != 0 && counts[k + 1] > 0) {
      result[grid.places[k]] += cell * static_cast<double>(counts[k + 1]);
    }
  }
  return result;
}

SharedAreas sharedAreas(const PlaceGrid& old, const PlaceGrid& fresh) {
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
  SharedAreas overlaps;
  for (const auto& [key, count] : counts) {
    const Id a = old.places[(key >> 16) - 1u], b = fresh.places[(key & 0xffffu) - 1u];
    if (a != 0 && b != 0) {
      overlaps[{a, b}] += g.resolution * g.resolution * static_cast<double>(count);
    }
  }
  return overlaps;
}

}  // namespace hyselam_topo
