#include "hyselam_topo/doors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <tuple>

#include "hyselam_common/errors.hpp"
#include "hyselam_topo/borders.hpp"

namespace hyselam_topo {

using hyselam::Cell;
using hyselam::OccupancyGrid;
using hyselam::Point2;

namespace {

void require(bool fine, const char* name, double value, const char* allowed) {
  if (!fine) throw hyselam::ParameterError(name, value, allowed);
}

double length(cv::Point2d p) {
  return std::hypot(p.x, p.y);
}

// Lengths in cells, positions in cells from the outer corner of cell (0, 0).
class DoorFinder {
 public:
  DoorFinder(const OccupancyGrid& grid, const DoorParams& params)
      : grid_(grid), params_(params), cells_(1.0 / grid.geometry.resolution) {}

  DoorLine find(const Border& border) const {
    Line line{border.first, border.last, false, false};
    line.wall_a = atWall(border.first);
    line.wall_b = atWall(border.last);
    if (!border.closed && line.wall_a && line.wall_b) narrowest(&line);
    DoorLine door;
    door.place_a = border.a;
    door.place_b = border.b;
    door.a = toMap(line.a);
    door.b = toMap(line.b);
    door.width = length(line.b - line.a) * grid_.geometry.resolution;
    door.real = !border.closed && line.wall_a && line.wall_b && door.width >= params_.min_width &&
                door.width <= params_.max_width && hasJambs(line);
    return door;
  }

 private:
  struct Line {
    cv::Point2d a, b;
    bool wall_a, wall_b;
  };

  bool blocked(int x, int y) const {
    const int v = grid_.valueOr({x, y});
    return v < 0 || v > params_.free_max;
  }
  bool blocked(cv::Point2d p) const {
    return blocked(static_cast<int>(std::floor(p.x)), static_cast<int>(std::floor(p.y)));
  }
  Point2 toMap(cv::Point2d p) const {
    const double r = grid_.geometry.resolution;
    return grid_.geometry.origin * Point2{p.x * r, p.y * r};
  }

  // Whether a corner of cells touches something that is not free.
  bool atWall(cv::Point p) const {
    return blocked(p.x, p.y) || blocked(p.x - 1, p.y) || blocked(p.x, p.y - 1) ||
           blocked(p.x - 1, p.y - 1);
  }

  // The way between two blocked cells, without themselves, is free.
  bool clear(Cell p, Cell q) const {
    const int dx = q.x - p.x, dy = q.y - p.y;
    const int steps = 2 * std::max(std::abs(dx), std::abs(dy));
    for (int i = 1; i < steps; ++i) {
      const double t = static_cast<double>(i) / steps;
      const int x = p.x + static_cast<int>(std::lround(t * dx)),
                y = p.y + static_cast<int>(std::lround(t * dy));
      if ((x == p.x && y == p.y) || (x == q.x && y == q.y)) continue;
      if (blocked(x, y)) return false;
    }
    return true;
  }

  // Blocked cells beside free ones within the radius of a point, at most half way to the other end.
  std::vector<Cell> surface(cv::Point2d at, cv::Point2d other, double radius) const {
    std::vector<Cell> out;
    const int r = static_cast<int>(std::ceil(radius));
    const int cx = static_cast<int>(std::floor(at.x)), cy = static_cast<int>(std::floor(at.y));
    for (int y = cy - r; y <= cy + r; ++y) {
      for (int x = cx - r; x <= cx + r; ++x) {
        if (!blocked(x, y)) continue;
        const cv::Point2d p{x + 0.5, y + 0.5};
        if (length(p - at) > radius || length(p - at) > length(p - other)) continue;
        if (!blocked(x + 1, y) || !blocked(x - 1, y) || !blocked(x, y + 1) || !blocked(x, y - 1)) {
          out.push_back({x, y});
        }
      }
    }
    return out;
  }

  // Moves the line to where it is shortest between the walls at its ends, in short steps, so that
  // it slides along a passage and does not jump to another one.
  void narrowest(Line* line) const {
    const double reach = params_.search * cells_;
    const double step = std::clamp(0.35 * cells_, 2.0, 12.0);
    const cv::Point2d start = 0.5 * (line->a + line->b);
    double best = std::numeric_limits<double>::infinity();
    for (int round = 0; round < 12; ++round) {
      const std::vector<Cell> left = surface(line->a, line->b, step),
                              right = surface(line->b, line->a, step);
      double shortest = std::numeric_limits<double>::infinity();
      std::vector<std::tuple<double, Cell, Cell>> pairs;
      for (const Cell& p : left) {
        for (const Cell& q : right) {
          const double d = std::hypot(p.x - q.x, p.y - q.y);
          if (d > shortest + 0.5) continue;
          const cv::Point2d middle{0.5 * (p.x + q.x + 1), 0.5 * (p.y + q.y + 1)};
          if (length(middle - start) > reach || !clear(p, q)) continue;
          shortest = std::min(shortest, d);
          pairs.push_back({d, p, q});
        }
      }
      if (shortest > best - 0.25) break;
      best = shortest;
      // Of about equally short lines the one in their middle: the middle of a thick wall.
      cv::Point2d mean{0.0, 0.0};
      double count = 0.0;
      for (const auto& [d, p, q] : pairs) {
        if (d > shortest + 0.5) continue;
        mean += cv::Point2d(0.5 * (p.x + q.x + 1), 0.5 * (p.y + q.y + 1));
        count += 1.0;
      }
      mean *= 1.0 / count;
      double nearest = std::numeric_limits<double>::infinity();
      for (const auto& [d, p, q] : pairs) {
        if (d > shortest + 0.5) continue;
        const cv::Point2d middle{0.5 * (p.x + q.x + 1), 0.5 * (p.y + q.y + 1)};
        // A little weight on the length prefers the straight line among those around the middle.
        const double cost = length(middle - mean) + 2.0 * (d - shortest);
        if (cost >= nearest) continue;
        nearest = cost;
        // From face to face: half a cell less at either end.
        const cv::Point2d from{p.x + 0.5, p.y + 0.5}, to{q.x + 0.5, q.y + 0.5};
        const cv::Point2d u = (1.0 / std::max(d, 1e-9)) * (to - from);
        const double face = 0.5 / std::max({std::abs(u.x), std::abs(u.y), 1e-9});
        line->a = from + face * u;
        line->b = to - face * u;
      }
    }
  }

  // How far the floor reaches from a point along a direction, up to a limit.
  double freeWay(cv::Point2d from, cv::Point2d along, double limit) const {
    double s = 0.0;
    while (s < limit && !blocked(from + (s + 0.5) * along)) s += 0.5;
    return std::min(s, limit);
  }

  // Whether the place on one side of the line is wider than the line.
  bool widens(const Line& line, cv::Point2d across) const {
    const double width = length(line.b - line.a);
    const cv::Point2d u = (1.0 / width) * (line.b - line.a), middle = 0.5 * (line.a + line.b);
    const double more = std::max(params_.jambs * cells_, 1.5);
    const double limit = 0.5 * width + more;
    int wide = 0;
    for (double t = 1.0; t <= params_.depth * cells_; t += 1.0) {
      const cv::Point2d p = middle + t * across;
      if (blocked(p)) break;
      // Both sides together: a door in the corner of a room has a jamb on one side only.
      const double reached = freeWay(p, u, 2.0 * limit) + freeWay(p, -u, 2.0 * limit);
      if (reached >= width + more && ++wide >= 2) return true;
    }
    return false;
  }

  bool hasJambs(const Line& line) const {
    const cv::Point2d u = line.b - line.a;
    const double width = length(u);
    if (width < 1e-9) return false;
    const cv::Point2d across{-u.y / width, u.x / width};
    return widens(line, across) && widens(line, -across);
  }

  const OccupancyGrid& grid_;
  const DoorParams& params_;
  double cells_;  // in a metre
};

Point2 middleOf(const DoorLine& d) {
  return {0.5 * (d.a.x + d.b.x), 0.5 * (d.a.y + d.b.y)};
}

}  // namespace

std::vector<DoorLine> refineDoors(const OccupancyGrid& grid, const cv::Mat& labels,
                                  const DoorParams& params) {
  require(params.min_width > 0.0, "door_min_width", params.min_width, "> 0 m");
  require(params.max_width > params.min_width, "door_max_width", params.max_width,
          "> door_min_width");
  require(params.search >= 0.0 && params.search <= 10.0, "door_search", params.search, "0 .. 10 m");
  require(params.jambs > 0.0, "door_jambs", params.jambs, "> 0 m");
  require(params.depth > 0.0 && params.depth <= 10.0, "door_depth", params.depth, "0 .. 10 m");
  if (labels.cols != grid.geometry.width || labels.rows != grid.geometry.height) {
    throw std::invalid_argument("the labels do not have the size of the grid");
  }
  const DoorFinder finder(grid, params);
  std::vector<DoorLine> out;
  for (const Border& border : findBorders(labels)) {
    const DoorLine door = finder.find(border);
    const bool known = std::any_of(out.begin(), out.end(), [&](const DoorLine& d) {
      const Point2 p = middleOf(d), q = middleOf(door);
      return d.place_a == door.place_a && d.place_b == door.place_b &&
             std::hypot(p.x - q.x, p.y - q.y) < std::max(0.3, 2.0 * grid.geometry.resolution);
    });
    if (!known) out.push_back(door);
  }
  std::sort(out.begin(), out.end(), [](const DoorLine& p, const DoorLine& q) {
    return std::tie(p.place_a, p.place_b, p.a.x, p.a.y) <
           std::tie(q.place_a, q.place_b, q.a.x, q.a.y);
  });
  return out;
}

}  // namespace hyselam_topo
