#include "hyselam_topo/topomerg/shared_walls.hpp"

#include <algorithm>
#include <optional>

namespace hyselam_topo {
namespace {

/// Walls of two places that may be the two faces of one lie back to back, ...
constexpr double kBackToBack = -0.9;  ///< product of their normals, at most
constexpr double kThickest = 0.6;     ///< as far apart at most [m]
/// ... and a door has room where they do.
constexpr double kDoorWidth = 0.7;  ///< [m]

/// Where wall `a` could have a door to what lies behind wall `b`: the middle of their common
/// stretch.
std::optional<hyselam::Point2> commonStretch(const Wall& a, const Wall& b) {
  if (a.kind == WallKind::kVirtual || b.kind == WallKind::kVirtual) return std::nullopt;
  if (a.normal.x * b.normal.x + a.normal.y * b.normal.y > kBackToBack) return std::nullopt;
  const double dx = b.position.x - a.position.x, dy = b.position.y - a.position.y;
  const double behind = -(a.normal.x * dx + a.normal.y * dy);
  if (behind < -0.5 * kThickest || behind > kThickest) return std::nullopt;
  const double offset = a.normal.x * dy - a.normal.y * dx;
  const double low = std::max(-0.5 * a.length, offset - 0.5 * b.length);
  const double high = std::min(0.5 * a.length, offset + 0.5 * b.length);
  if (high - low < kDoorWidth) return std::nullopt;
  const double along = 0.5 * (low + high);
  return hyselam::Point2{a.position.x - along * a.normal.y - 0.5 * behind * a.normal.x,
                         a.position.y + along * a.normal.x - 0.5 * behind * a.normal.y};
}

}  // namespace

std::vector<SharedWall> sharedWalls(const AugmentedTopologicalMap& map) {
  std::vector<SharedWall> all;
  for (std::size_t a = 0; a < map.places.size(); ++a) {
    for (std::size_t b = a + 1; b < map.places.size(); ++b) {
      if (map.findEdge(map.places[a].id, map.places[b].id) != nullptr) continue;
      for (const Wall& wall : map.places[a].walls) {
        for (const Wall& other : map.places[b].walls) {
          const auto middle = commonStretch(wall, other);
          if (!middle) continue;
          all.push_back({a, b, {-wall.normal.x, -wall.normal.y}, *middle});
        }
      }
    }
  }
  return all;
}

}  // namespace hyselam_topo
