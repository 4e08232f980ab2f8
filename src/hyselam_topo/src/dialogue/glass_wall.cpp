#include "hyselam_topo/dialogue/glass_wall.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "hyselam_common/errors.hpp"
#include "hyselam_topological_map/map_geometry.hpp"
#include "plane.hpp"

namespace hyselam_topo {
namespace {

using hyselam::Cell;
using hyselam::OccupancyGrid;
using hyselam::Point2;

/// Two glass walls are the same if their ends are within this [m].
constexpr double kSame = 0.3;

double directionOf(Side side) {
  switch (side) {
    case Side::kFront:
      return 0.0;
    case Side::kLeft:
      return 0.5 * hyselam::kPi;
    case Side::kBack:
      return hyselam::kPi;
    case Side::kRight:
      return -0.5 * hyselam::kPi;
    case Side::kUnknown:
      break;
  }
  throw hyselam::InputError("glass wall", "side", "it is not told");
}

/// A grid map with occupied cells, in coordinates of cells.
struct Walls {
  const OccupancyGrid& grid;
  int occupied_min;

  bool occupied(Cell c) const { return grid.valueOr(c) >= occupied_min; }

  /// The first occupied cell from `from` in a direction (in the grid's frame); nothing within
  /// `range` cells. `end` gets where the beam ends.
  std::optional<Cell> hit(Point2 from, double angle, double range, Point2* end) const {
    const double dx = std::cos(angle), dy = std::sin(angle);
    constexpr double kStep = 0.25;
    for (int i = 0; i * kStep <= range; ++i) {
      const double r = i * kStep;
      *end = {from.x + r * dx, from.y + r * dy};
      const Cell c{static_cast<int>(std::floor(end->x)), static_cast<int>(std::floor(end->y))};
      if (occupied(c)) return c;
    }
    return std::nullopt;
  }

  /// The corner test: a beam of `radius` cells turns around the cell; free of walls is the angle
  /// between the last one on the right and the first one on the left of the direction to the robot.
  /// More than a half turn there are convex corners; 0 for a lone spot, which is no post that could
  /// hold a wall of glass.
  double freeAngle(Cell cell, Point2 robot, int radius) const {
    const int steps = 16 * radius;  // more than there are cells on the circle
    const double to_robot = std::atan2(robot.y - (cell.y + 0.5), robot.x - (cell.x + 0.5));
    const auto wallAt = [&](int step) {
      const double angle = to_robot + 2.0 * hyselam::kPi * step / steps;
      for (const double r : {static_cast<double>(radius), radius - 1.0}) {
        const Cell c{static_cast<int>(std::floor(cell.x + 0.5 + r * std::cos(angle))),
                     static_cast<int>(std::floor(cell.y + 0.5 + r * std::sin(angle)))};
        if (occupied(c)) return true;
      }
      return false;
    };
    int left = 0, right = 0;
    while (left < steps && !wallAt(left)) ++left;
    while (right < steps && !wallAt(-right)) ++right;
    return left == steps ? 0.0 : 2.0 * hyselam::kPi * (left + right - 1) / steps;
  }

  /// No occupied cell between two corners; their own posts do not count.
  bool nothingBetween(Cell a, Cell b, double post) const {
    const double length = std::hypot(b.x - a.x, b.y - a.y);
    constexpr double kStep = 0.25;
    for (int i = 0; post + i * kStep <= length - post; ++i) {
      const double t = (post + i * kStep) / length;
      const Cell c{static_cast<int>(std::floor(a.x + 0.5 + t * (b.x - a.x))),
                   static_cast<int>(std::floor(a.y + 0.5 + t * (b.y - a.y)))};
      if (occupied(c)) return false;
    }
    return true;
  }
};

/// A cell that passes the corner test.
struct Corner {
  Cell cell;
  double free = 0.0;      ///< angle around it [rad]
  double nearness = 0.0;  ///< distance from the robot [cells]
};

/// The faces of one post pass the test in many cells: the sharpest one stands for it. The nearest
/// first.
std::vector<Cell> sharpestOfPosts(std::vector<Corner> found, int corner_cells) {
  std::stable_sort(found.begin(), found.end(),
                   [](const Corner& a, const Corner& b) { return a.nearness < b.nearness; });
  std::vector<std::vector<Corner>> posts;
  for (const Corner& c : found) {
    const auto post = std::find_if(posts.begin(), posts.end(), [&](const auto& p) {
      return std::hypot(c.cell.x - p[0].cell.x, c.cell.y - p[0].cell.y) <= corner_cells;
    });
    if (post == posts.end()) {
      posts.push_back({c});
    } else {
      post->push_back(c);
    }
  }
  std::vector<Cell> corners;
  for (const auto& p : posts) {
    const auto sharpest = std::max_element(
        p.begin(), p.end(), [](const Corner& a, const Corner& b) { return a.free < b.free; });
    corners.push_back(sharpest->cell);
  }
  return corners;
}

}  // namespace

void GlassWallParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("aperture", aperture, Range::between(0.1, 2.0 * hyselam::kPi), "rad",
        "aperture of the search for walls of glass (alpha_laser)");
  visit("range", range, Range::between(0.5, 50.0), "m", "range of that search (l_laser)");
  visit("corner_cells", corner_cells, Range::between(2, 100), "cells",
        "radius of the corner test (l_corner)");
  visit("corner_angle", corner_angle, Range::between(0.01, 3.14), "rad",
        "a convex corner has a free angle this much wider than a straight wall (alpha_corner)");
  visit("min_length", min_length, Range::between(0.05, 10.0), "m",
        "two corners nearer than this are one post");
  visit("max_length", max_length, Range::between(0.1, 50.0), "m", "of a wall of glass");
  visit("occupied_min", occupied_min, Range::between(1, 100), "",
        "cells of this or more are occupied");
}

void GlassWallParams::validate() const {
  hyselam::checkParameters(*this);
  if (!(max_length > min_length))
    throw hyselam::ParameterError("max_length", max_length, "> min_length");
}

double GlassWall::length() const {
  return distanceBetween(a, b);
}

double GlassWall::distanceTo(Point2 point) const {
  return distanceToSegment(point, a, b);
}

bool sameWall(const GlassWall& a, const GlassWall& b) {
  const double straight = std::max(distanceBetween(a.a, b.a), distanceBetween(a.b, b.b));
  const double crossed = std::max(distanceBetween(a.a, b.b), distanceBetween(a.b, b.a));
  return std::min(straight, crossed) <= kSame;
}

bool operator==(const GlassWall& a, const GlassWall& b) {
  return a.a.x == b.a.x && a.a.y == b.a.y && a.b.x == b.b.x && a.b.y == b.b.y;
}

GlassWallSearch::GlassWallSearch(const OccupancyGrid& grid, const hyselam::Pose2& robot, Side side,
                                 const GlassWallParams& params)
    : robot_(robot), side_(side), params_(params) {
  params.validate();
  const double direction = directionOf(side);
  const auto& g = grid.geometry;
  if (!robot.isFinite()) throw hyselam::InputError("glass wall", "pose", "it is not finite");
  const hyselam::Pose2 in_grid = g.origin.inverse() * robot;
  const Point2 from{in_grid.x / g.resolution, in_grid.y / g.resolution};
  if (!(from.x >= 0.0 && from.y >= 0.0 && from.x < g.width && from.y < g.height)) {
    throw hyselam::InputError("glass wall", "pose", "the robot is outside of the map");
  }
  const Walls walls{grid, params.occupied_min};
  const double range = params.range / g.resolution;
  // At its far end two neighbouring beams are a cell apart.
  const int beams = 1 + static_cast<int>(std::ceil(params.aperture * range));
  const double first = in_grid.theta + direction - 0.5 * params.aperture;
  std::vector<Corner> found;
  for (int i = 0; i < beams; ++i) {
    const double angle = first + params.aperture * i / (beams - 1);
    Point2 end = from;
    const auto hit = walls.hit(from, angle, range, &end);
    seen_.push_back(g.origin * Point2{end.x * g.resolution, end.y * g.resolution});
    if (!hit) continue;
    const bool known =
        std::any_of(found.begin(), found.end(), [&](const Corner& o) { return o.cell == *hit; });
    if (known) continue;
    const double free = walls.freeAngle(*hit, from, params.corner_cells);
    if (free - hyselam::kPi > params.corner_angle) {
      found.push_back({*hit, free, std::hypot(hit->x + 0.5 - from.x, hit->y + 0.5 - from.y)});
    }
  }
  const std::vector<Cell> corners = sharpestOfPosts(std::move(found), params.corner_cells);
  for (const Cell& cell : corners) corners_.push_back(g.center(cell));
  const double post = 0.5 * params.corner_cells + 1.0;
  joinCorners([&](std::size_t i, std::size_t j) {
    return walls.nothingBetween(corners[i], corners[j], post);
  });
}

void GlassWallSearch::joinCorners(const std::function<bool(std::size_t, std::size_t)>& is_free) {
  for (std::size_t i = 0; i < corners_.size(); ++i) {
    const auto distanceTo = [&](std::size_t j) {
      return distanceBetween(corners_[i], corners_[j]);
    };
    std::vector<std::size_t> partners;
    for (std::size_t j = 0; j < corners_.size(); ++j) {
      if (j == i || distanceTo(j) < params_.min_length || distanceTo(j) > params_.max_length)
        continue;
      if (is_free(i, j)) partners.push_back(j);
    }
    std::stable_sort(partners.begin(), partners.end(),
                     [&](std::size_t a, std::size_t b) { return distanceTo(a) < distanceTo(b); });
    for (const std::size_t j : partners) {
      const GlassWall wall{corners_[i], corners_[j]};
      const bool known = std::any_of(pairs_.begin(), pairs_.end(), [&](const GlassWall& o) {
        return o == GlassWall{wall.b, wall.a};
      });
      if (!known) pairs_.push_back(wall);
    }
  }
}

bool GlassWallSearch::rejected(const GlassWall& wall) const {
  return std::any_of(rejected_.begin(), rejected_.end(),
                     [&](const GlassWall& other) { return sameWall(wall, other); });
}

std::optional<GlassWall> GlassWallSearch::likeliest() const {
  for (const GlassWall& wall : pairs_) {
    if (!rejected(wall)) return wall;
  }
  return std::nullopt;
}

std::optional<GlassWall> GlassWallSearch::ofLength(double length) const {
  const auto error = [&](const GlassWall& wall) { return std::abs(wall.length() - length); };
  const GlassWall* best = nullptr;  // of those that were not rejected
  const GlassWall* of_all = nullptr;
  for (const GlassWall& wall : pairs_) {
    if (of_all == nullptr || error(wall) < error(*of_all) - 1e-9) of_all = &wall;
    if (rejected(wall)) continue;
    if (best == nullptr || error(wall) < error(*best) - 1e-9) best = &wall;
  }
  if (of_all == nullptr) return std::nullopt;
  // A person may say no by mistake: a rejected wall that fits much better is asked about again.
  if (best == nullptr || error(*of_all) + kSame < error(*best)) best = of_all;
  return *best;
}

void GlassWallSearch::reject(const GlassWall& wall) {
  rejected_.push_back(wall);
}

void drawGlassWalls(const std::vector<GlassWall>& walls, OccupancyGrid* grid) {
  const auto& g = grid->geometry;
  const auto draw = [&](int x, int y) {
    if (g.contains({x, y})) grid->at({x, y}) = OccupancyGrid::kOccupied;
  };
  for (const GlassWall& wall : walls) {
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

void addGlassWalls(const std::vector<GlassWall>& walls, AugmentedTopologicalMap* map,
                   WallKind kind) {
  for (const GlassWall& glass : walls) {
    if (!(glass.length() > 0.0)) continue;
    std::vector<Id> done;
    for (const bool turned : {false, true}) {
      const Point2 a = turned ? glass.b : glass.a, b = turned ? glass.a : glass.b;
      Wall wall = straightWall(a, b);
      wall.kind = kind;
      constexpr double kBeside = 0.3;  // beyond posts and drawn cells [m]
      const Point2 beside{wall.position.x + kBeside * wall.normal.x,
                          wall.position.y + kBeside * wall.normal.y};
      const auto at = placeAt(*map, beside, kBeside);
      if (!at || std::find(done.begin(), done.end(), at->place) != done.end()) continue;
      done.push_back(at->place);
      Place* place = map->findPlace(at->place);
      const bool known = std::any_of(place->walls.begin(), place->walls.end(), [&](const Wall& w) {
        const auto line = polyline(w);
        return w.kind == kind && sameWall({line.front(), line.back()}, glass);
      });
      if (known) continue;
      wall.id = map->next_wall_id++;
      place->walls.push_back(wall);
    }
  }
}

}  // namespace hyselam_topo
