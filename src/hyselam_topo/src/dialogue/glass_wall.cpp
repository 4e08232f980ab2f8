#include "hyselam_topo/dialogue/glass_wall.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "hyselam_common/errors.hpp"
#include "hyselam_topo/side_angle.hpp"
#include "plane.hpp"

namespace hyselam_topo {
namespace {

using hyselam::Cell;
using hyselam::OccupancyGrid;
using hyselam::Point2;

/// A wall that was rejected fits better only by more than this [m].
constexpr double kMuchBetter = 0.3;

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

GlassWallSearch::GlassWallSearch(const OccupancyGrid& grid, const hyselam::Pose2& robot, Side side,
                                 const GlassWallParams& params)
    : robot_(robot), side_(side), params_(params) {
  params.validate();
  if (side == Side::kUnknown) throw hyselam::InputError("glass wall", "side", "it is not told");
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
  const double first = in_grid.theta + angleOf(side) - 0.5 * params.aperture;
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
      const WallLine wall{corners_[i], corners_[j]};
      const bool known = std::any_of(pairs_.begin(), pairs_.end(), [&](const WallLine& o) {
        return o == WallLine{wall.b, wall.a};
      });
      if (!known) pairs_.push_back(wall);
    }
  }
}

bool GlassWallSearch::rejected(const WallLine& wall) const {
  return std::any_of(rejected_.begin(), rejected_.end(),
                     [&](const WallLine& other) { return sameWall(wall, other); });
}

std::optional<WallLine> GlassWallSearch::likeliest() const {
  for (const WallLine& wall : pairs_) {
    if (!rejected(wall)) return wall;
  }
  return std::nullopt;
}

std::optional<WallLine> GlassWallSearch::ofLength(double length) const {
  const auto error = [&](const WallLine& wall) { return std::abs(wall.length() - length); };
  const WallLine* best = nullptr;  // of those that were not rejected
  const WallLine* of_all = nullptr;
  for (const WallLine& wall : pairs_) {
    if (of_all == nullptr || error(wall) < error(*of_all) - 1e-9) of_all = &wall;
    if (rejected(wall)) continue;
    if (best == nullptr || error(wall) < error(*best) - 1e-9) best = &wall;
  }
  if (of_all == nullptr) return std::nullopt;
  // A person may say no by mistake: a rejected wall that fits much better is asked about again.
  if (best == nullptr || error(*of_all) + kMuchBetter < error(*best)) best = of_all;
  return *best;
}

void GlassWallSearch::reject(const WallLine& wall) {
  rejected_.push_back(wall);
}

}  // namespace hyselam_topo
