#include "hyselam_topo/dialogue/described_wall.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "hyselam_topological_map/map_geometry.hpp"
#include "plane.hpp"

namespace hyselam_topo {
namespace {

using hyselam::Cell;
using hyselam::OccupancyGrid;
using hyselam::Point2;

/// Two walls are one if their ends are within this [m].
constexpr double kSame = 0.3;

}  // namespace

double WallLine::length() const {
  return distanceBetween(a, b);
}

double WallLine::distanceTo(Point2 point) const {
  return distanceToSegment(point, a, b);
}

bool operator==(const WallLine& a, const WallLine& b) {
  return a.a.x == b.a.x && a.a.y == b.a.y && a.b.x == b.b.x && a.b.y == b.b.y;
}

bool sameWall(const WallLine& a, const WallLine& b) {
  const double straight = std::max(distanceBetween(a.a, b.a), distanceBetween(a.b, b.b));
  const double crossed = std::max(distanceBetween(a.a, b.b), distanceBetween(a.b, b.a));
  return std::min(straight, crossed) <= kSame;
}

bool operator==(const DescribedWall& a, const DescribedWall& b) {
  return a.line == b.line && a.kind == b.kind;
}

void drawWalls(const std::vector<WallLine>& walls, OccupancyGrid* grid) {
  const auto& g = grid->geometry;
  const auto draw = [&](int x, int y) {
    if (g.contains({x, y})) grid->at({x, y}) = OccupancyGrid::kOccupied;
  };
  for (const WallLine& wall : walls) {
    const Point2 a = g.origin.inverse() * wall.a, b = g.origin.inverse() * wall.b;
    const double length = wall.length() / g.resolution;
    if (!std::isfinite(length) || length > 1e6) continue;
    const int steps = std::max(1, static_cast<int>(std::ceil(4.0 * length)));
    std::optional<Cell> last;
    for (int i = 0; i <= steps; ++i) {
      const double t = static_cast<double>(i) / steps;
      const double fx = (a.x + t * (b.x - a.x)) / g.resolution;
      const double fy = (a.y + t * (b.y - a.y)) / g.resolution;
      if (!(std::abs(fx) < 1e9 && std::abs(fy) < 1e9)) continue;
      const Cell c{static_cast<int>(std::floor(fx)), static_cast<int>(std::floor(fy))};
      draw(c.x, c.y);
      // Across a corner of a cell a way of 8 neighbours would slip through.
      if (last && last->x != c.x && last->y != c.y) draw(last->x, c.y);
      last = c;
    }
  }
}

void putWall(const DescribedWall& described, AugmentedTopologicalMap* map) {
  const WallLine& line = described.line;
  if (!(line.length() > 0.0)) return;
  std::vector<Id> done;
  for (const bool turned : {false, true}) {
    Wall wall = turned ? straightWall(line.b, line.a) : straightWall(line.a, line.b);
    wall.kind = described.kind;
    constexpr double kBeside = 0.3;  // beyond posts and drawn cells [m]
    const Point2 beside{wall.position.x + kBeside * wall.normal.x,
                        wall.position.y + kBeside * wall.normal.y};
    const auto at = placeAt(*map, beside, kBeside);
    if (!at || std::find(done.begin(), done.end(), at->place) != done.end()) continue;
    done.push_back(at->place);
    Place* place = map->findPlace(at->place);
    const bool known = std::any_of(place->walls.begin(), place->walls.end(), [&](const Wall& w) {
      const auto ends = polyline(w);
      return w.kind == described.kind && sameWall({ends.front(), ends.back()}, line);
    });
    if (known) continue;
    wall.id = map->next_wall_id++;
    place->walls.push_back(wall);
  }
}

}  // namespace hyselam_topo
