#include "hyselam_topological_map/map_geometry.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hyselam_topo {
namespace {

using hyselam::Cell;
using hyselam::Point2;

Point2 leftOf(Point2 a, Point2 b) {
  const double length = std::hypot(b.x - a.x, b.y - a.y);
  return length > 0.0 ? Point2{(a.y - b.y) / length, (b.x - a.x) / length} : Point2{1.0, 0.0};
}

template <typename T>
void placeBetween(Point2 a, Point2 b, T* thing) {
  const Point2 normal = leftOf(a, b);
  thing->normal = {normal.x, normal.y, 0.0};
  thing->position = {0.5 * (a.x + b.x), 0.5 * (a.y + b.y), 0.0};
}

/// The point of a line through `middle` at `along` to the right of its normal.
Point2 alongLine(const Point3& middle, const Point3& normal, double along) {
  return {middle.x + normal.y * along, middle.y - normal.x * along};
}

/// The nearest labelled cell within max_distance of a point that lies on no place.
std::optional<PlaceAt> nearestInGrid(const PlaceGrid& grid, Point2 point, double max_distance) {
  const auto& g = grid.geometry;
  const double reach = std::floor(max_distance / g.resolution) + 1.0;
  const Point2 in_grid = g.origin.inverse() * point;
  const double column = in_grid.x / g.resolution, row = in_grid.y / g.resolution;
  const auto clamped = [](double value, int size) {
    return static_cast<int>(std::clamp(std::floor(value), -1.0, static_cast<double>(size)));
  };
  const int x_begin = std::max(0, clamped(column - reach, g.width));
  const int y_begin = std::max(0, clamped(row - reach, g.height));
  const int x_end = std::min(g.width, clamped(column + reach, g.width) + 1);
  const int y_end = std::min(g.height, clamped(row + reach, g.height) + 1);
  std::optional<PlaceAt> nearest;
  for (int y = y_begin; y < y_end; ++y) {
    for (int x = x_begin; x < x_end; ++x) {
      const Id id = grid.placeOf({x, y});
      if (id == 0) continue;
      const double d = g.resolution * std::hypot(x + 0.5 - column, y + 0.5 - row);
      if (d <= max_distance && (!nearest || d < nearest->distance)) nearest = PlaceAt{id, d};
    }
  }
  return nearest;
}

}  // namespace

Wall straightWall(Point2 a, Point2 b) {
  Wall wall;
  placeBetween(a, b, &wall);
  wall.length = std::hypot(b.x - a.x, b.y - a.y);
  return wall;
}

Door doorBetween(Point2 a, Point2 b) {
  Door door;
  placeBetween(a, b, &door);
  door.width = std::hypot(b.x - a.x, b.y - a.y);
  return door;
}

Segment ends(const Door& door) {
  return {alongLine(door.position, door.normal, -0.5 * door.width),
          alongLine(door.position, door.normal, 0.5 * door.width)};
}

std::vector<Point2> polyline(const Wall& wall, double max_error) {
  const double half = 0.5 * std::abs(wall.curvature) * wall.length;  // half the arc's angle
  if (half < 1e-6) {
    return {alongLine(wall.position, wall.normal, -0.5 * wall.length),
            alongLine(wall.position, wall.normal, 0.5 * wall.length)};
  }
  const double radius = 1.0 / std::abs(wall.curvature);
  // The mass centre of an arc lies radius * sin(half) / half from the centre of its circle.
  const double inwards = wall.curvature > 0.0 ? 1.0 : -1.0;
  const double to_centre = radius * std::sin(half) / half;
  const Point2 centre{wall.position.x + inwards * to_centre * wall.normal.x,
                      wall.position.y + inwards * to_centre * wall.normal.y};
  const double step = 2.0 * std::acos(std::max(0.5, 1.0 - max_error / radius));
  const int pieces =
      static_cast<int>(std::min(1000.0, std::max(2.0, std::ceil(2.0 * half / step))));
  std::vector<Point2> points;
  for (int i = 0; i <= pieces; ++i) {
    const double angle = half * (2.0 * i / pieces - 1.0);
    const double outwards = -inwards * radius * std::cos(angle);
    const double along = radius * std::sin(angle);
    points.push_back({centre.x + outwards * wall.normal.x + along * wall.normal.y,
                      centre.y + outwards * wall.normal.y - along * wall.normal.x});
  }
  return points;
}

double signedArea(const std::vector<Point2>& polygon) {
  double twice = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point2& a = polygon[i];
    const Point2& b = polygon[(i + 1) % polygon.size()];
    twice += a.x * b.y - b.x * a.y;
  }
  return 0.5 * twice;
}

bool contains(const std::vector<Point2>& polygon, Point2 point) {
  if (polygon.size() < 3) return false;
  bool inside = false;
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const Point2& a = polygon[i];
    const Point2& b = polygon[j];
    if ((a.y > point.y) != (b.y > point.y) &&
        point.x < a.x + (b.x - a.x) * (point.y - a.y) / (b.y - a.y)) {
      inside = !inside;
    }
  }
  return inside;
}

std::optional<PlaceAt> placeAt(const AugmentedTopologicalMap& map, Point2 point,
                               double max_distance) {
  if (!std::isfinite(point.x) || !std::isfinite(point.y)) return std::nullopt;
  if (map.grid) {
    const Point2 in_grid = map.grid->geometry.origin.inverse() * point;
    const double side = map.grid->geometry.resolution;
    // cellAt() would overflow for points far away.
    if (in_grid.x >= 0.0 && in_grid.y >= 0.0 && in_grid.x < side * map.grid->geometry.width &&
        in_grid.y < side * map.grid->geometry.height) {
      const Id id = map.grid->placeOf(map.grid->geometry.cellAt(point));
      if (id != 0) return PlaceAt{id, 0.0};
    }
  }
  const Place* smallest = nullptr;
  for (const Place& place : map.places) {
    if (contains(place.outline, point) && (smallest == nullptr || place.area < smallest->area)) {
      smallest = &place;
    }
  }
  if (smallest != nullptr) return PlaceAt{smallest->id, 0.0};
  if (!map.grid) return std::nullopt;
  return nearestInGrid(*map.grid, point, std::max(0.0, max_distance));
}

}  // namespace hyselam_topo
