#include "hyselam_gr2to/map_builder/doors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

#include "hyselam_common/require.hpp"
#include "hyselam_gr2to/map_builder/borders.hpp"

namespace hyselam_topo {

using hyselam::Cell;
using hyselam::OccupancyGrid;
using hyselam::Point2;

namespace {

double length(cv::Point2d p) {
  return std::hypot(p.x, p.y);
}

double squared(cv::Point2d p) {
  return p.x * p.x + p.y * p.y;
}

// Lengths in cells, positions in cells from the outer corner of cell (0, 0).
class DoorFinder {
 public:
  DoorFinder(const OccupancyGrid& grid, const cv::Mat& labels, const DoorParams& params)
      : grid_(grid), labels_(labels), params_(params), cells_(1.0 / grid.geometry.resolution) {}

  DoorLine find(const Border& border) const {
    Line line{border.first, border.last, false, false};
    line.wall_a = atWall(border.first);
    line.wall_b = atWall(border.last);
    if (!border.closed && line.wall_a && line.wall_b) narrowest(line);
    DoorLine door;
    door.place_a = border.a;
    door.place_b = border.b;
    door.a = toMap(line.a);
    door.b = toMap(line.b);
    door.width = length(line.b - line.a) * grid_.geometry.resolution;
    door.real = !border.closed && line.wall_a && line.wall_b && door.width >= params_.min_width &&
                door.width <= params_.max_width && hasJambs(line, door);
    return door;
  }

  // Whether one end of the line is at something that stands free: less than `kIsland` across.
  bool endsAtIsland(const DoorLine& door) const {
    const Point2 u{(door.b.x - door.a.x) / std::max(door.width, 1e-9),
                   (door.b.y - door.a.y) / std::max(door.width, 1e-9)};
    const double r = 0.7 * grid_.geometry.resolution;
    return island(grid_.geometry.cellAt({door.a.x - r * u.x, door.a.y - r * u.y})) ||
           island(grid_.geometry.cellAt({door.b.x + r * u.x, door.b.y + r * u.y}));
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

  bool island(Cell start) const {
    constexpr double kIsland = 2.5;  // [m]
    if (!blocked(start.x, start.y)) return false;
    const int reach = static_cast<int>(kIsland * cells_);
    const int side = 2 * reach + 1;
    std::vector<char> seen(static_cast<std::size_t>(side) * static_cast<std::size_t>(side), 0);
    std::vector<Cell> front{start};
    Cell low = start, high = start;
    for (std::size_t i = 0; i < front.size(); ++i) {
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
          const Cell n{front[i].x + dx, front[i].y + dy};
          if (!grid_.geometry.contains(n)) return false;
          if (!blocked(n.x, n.y)) continue;
          low = {std::min(low.x, n.x), std::min(low.y, n.y)};
          high = {std::max(high.x, n.x), std::max(high.y, n.y)};
          if (high.x - low.x >= reach || high.y - low.y >= reach) return false;
          char& known = seen[static_cast<std::size_t>(n.y - start.y + reach) *
                                 static_cast<std::size_t>(side) +
                             static_cast<std::size_t>(n.x - start.x + reach)];
          if (known != 0) continue;
          known = 1;
          front.push_back(n);
        }
      }
    }
    return true;
  }

  bool surface(int x, int y) const {
    return blocked(x, y) &&
           (!blocked(x + 1, y) || !blocked(x - 1, y) || !blocked(x, y + 1) || !blocked(x, y - 1));
  }

  // The face of the wall at one end of the line: blocked cells beside free ones that are connected
  // with it (over gaps of a cell), within the radius and nearer to this end than to the other. What
  // stands free in a place is no part of it: a line to it would not part the places.
  std::vector<Cell> face(cv::Point2d at, cv::Point2d other, double radius) const {
    const int r = static_cast<int>(std::ceil(radius)) + 1, side = 2 * r + 1;
    const int x0 = static_cast<int>(std::floor(at.x)) - r,
              y0 = static_cast<int>(std::floor(at.y)) - r;
    std::vector<char> seen(static_cast<std::size_t>(side * side), 0);
    std::vector<Cell> out;
    const auto take = [&](int x, int y, double limit) {
      if (x < x0 || y < y0 || x >= x0 + side || y >= y0 + side) return;
      char& known = seen[static_cast<std::size_t>((y - y0) * side + x - x0)];
      const cv::Point2d p{x + 0.5, y + 0.5};
      const double off = squared(p - at);
      if (known != 0 || off > limit * limit || off > squared(p - other)) return;
      known = 1;
      if (surface(x, y)) out.push_back({x, y});
    };
    for (int y = -2; y <= 2; ++y) {
      for (int x = -2; x <= 2; ++x) take(x0 + r + x, y0 + r + y, 2.0);
    }
    for (std::size_t i = 0; i < out.size(); ++i) {
      const Cell c = out[i];
      for (int dy = -2; dy <= 2; ++dy) {
        for (int dx = -2; dx <= 2; ++dx) take(c.x + dx, c.y + dy, radius);
      }
    }
    return out;
  }

  // Moves the line to where the passage is narrowest between the walls at its ends. Its length
  // counts most, but a line that is about as short as others stays where it is.
  void narrowest(Line& line) const {
    constexpr double kPerMove = 0.1;
    const double reach = params_.search_radius * cells_;
    const cv::Point2d start = 0.5 * (line.a + line.b);
    const auto middle = [](const Cell& p, const Cell& q) {
      return cv::Point2d(0.5 * (p.x + q.x + 1), 0.5 * (p.y + q.y + 1));
    };
    for (int round = 0; round < 3; ++round) {
      const std::vector<Cell> left = face(line.a, line.b, reach),
                              right = face(line.b, line.a, reach);
      double least = std::numeric_limits<double>::infinity();
      std::vector<std::tuple<double, Cell, Cell>> pairs;
      for (const Cell& p : left) {
        for (const Cell& q : right) {
          const cv::Point2d way(q.x - p.x, q.y - p.y);
          if (squared(way) > (least + 1.0) * (least + 1.0)) continue;  // most pairs
          const double moved = length(middle(p, q) - start);
          const double cost = length(way) + kPerMove * moved;
          if (cost > least + 1.0 || moved > reach || !clear(p, q)) continue;
          least = std::min(least, cost);
          pairs.push_back({cost, p, q});
        }
      }
      if (pairs.empty()) return;
      // Of about equally short lines the one in their middle: the middle of a thick wall.
      cv::Point2d mean{0.0, 0.0};
      double count = 0.0;
      for (const auto& [cost, p, q] : pairs) {
        if (cost > least + 1.0) continue;
        mean += middle(p, q);
        count += 1.0;
      }
      mean *= 1.0 / count;
      double best = std::numeric_limits<double>::infinity();
      Line found = line;
      for (const auto& [cost, p, q] : pairs) {
        if (cost > least + 1.0) continue;
        const double d = std::hypot(p.x - q.x, p.y - q.y);
        // The straightest of those around the middle.
        const double off = length(middle(p, q) - mean) + 2.0 * (cost - least);
        if (off >= best) continue;
        best = off;
        // From face to face: half a cell less at either end.
        const cv::Point2d from{p.x + 0.5, p.y + 0.5}, to{q.x + 0.5, q.y + 0.5};
        const cv::Point2d u = (1.0 / std::max(d, 1e-9)) * (to - from);
        const double half = 0.5 / std::max({std::abs(u.x), std::abs(u.y), 1e-9});
        found.a = from + half * u;
        found.b = to - half * u;
      }
      const double moved = length(found.a - line.a) + length(found.b - line.b);
      line.a = found.a;
      line.b = found.b;
      if (moved < 1.0) return;
    }
  }

  // How far the floor of the two places reaches from a point along a direction, up to a limit. A
  // door at the side leads into a third place and makes neither of them wider.
  double freeWay(cv::Point2d from, cv::Point2d along, double limit, const DoorLine& door) const {
    double s = 0.0;
    while (s < limit) {
      const cv::Point2d p = from + (s + 0.5) * along;
      if (blocked(p)) break;
      const int label = labels_.at<std::uint16_t>(static_cast<int>(std::floor(p.y)),
                                                  static_cast<int>(std::floor(p.x)));
      if (label != 0 && label != door.place_a && label != door.place_b) break;
      s += 0.5;
    }
    return std::min(s, limit);
  }

  // Whether the place on one side of the line is wider than the line.
  bool widens(const Line& line, cv::Point2d across, const DoorLine& door) const {
    const double width = length(line.b - line.a);
    const cv::Point2d u = (1.0 / width) * (line.b - line.a), middle = 0.5 * (line.a + line.b);
    const double more = std::max(params_.min_jambs * cells_, 1.5);
    const double limit = 0.5 * width + more;
    int wide = 0;
    for (int t = 1; t <= params_.jamb_depth * cells_; ++t) {
      const cv::Point2d p = middle + t * across;
      if (blocked(p)) break;
      // Both sides together: a door in the corner of a room has a jamb on one side only.
      const double reached = freeWay(p, u, 2.0 * limit, door) + freeWay(p, -u, 2.0 * limit, door);
      if (reached >= width + more && ++wide >= 2) return true;
    }
    return false;
  }

  bool hasJambs(const Line& line, const DoorLine& door) const {
    const cv::Point2d u = line.b - line.a;
    const double width = length(u);
    if (width < 1e-9) return false;
    const cv::Point2d across{-u.y / width, u.x / width};
    return widens(line, across, door) && widens(line, -across, door);
  }

  const OccupancyGrid& grid_;
  const cv::Mat& labels_;
  const DoorParams& params_;
  double cells_;  // in a metre
};

Point2 middleOf(const DoorLine& d) {
  return {0.5 * (d.a.x + d.b.x), 0.5 * (d.a.y + d.b.y)};
}

// Borders too narrow to pass (behind the leaf of a door, through a gap in a wall) count only where
// no wider one joins the same places.
void dropChinks(double min_width, std::vector<DoorLine>& doors) {
  const std::vector<DoorLine> all = doors;
  doors.erase(std::remove_if(doors.begin(), doors.end(),
                             [&](const DoorLine& d) {
                               return d.width < 0.5 * min_width &&
                                      std::any_of(all.begin(), all.end(), [&](const DoorLine& o) {
                                        return o.place_a == d.place_a && o.place_b == d.place_b &&
                                               o.width >= min_width;
                                      });
                             }),
              doors.end());
}

}  // namespace

void DoorParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("min_width", min_width, Range::above(0.0), "m", "width of a real door, at least");
  visit("max_width", max_width, Range::above(0.0), "m", "width of a real door, at most");
  visit("search_radius", search_radius, Range::between(0.0, 10.0), "m",
        "of the line's way to where the passage is narrowest");
  visit("min_jambs", min_jambs, Range::above(0.0), "m",
        "by which both places are wider than a real door");
  visit("jamb_depth", jamb_depth, Range::aboveUpTo(0.0, 10.0), "m",
        "from the door within which the places become wider");
  visit("free_max", free_max, Range::between(0, 99), "", "cells of 0 .. this value are free");
}

void DoorParams::validate() const {
  hyselam::checkParameters(*this);
  hyselam::require("max_width", max_width, max_width > min_width, "> min_width");
}

std::vector<DoorLine> refineDoors(const OccupancyGrid& grid, const cv::Mat& labels,
                                  const DoorParams& params) {
  params.validate();
  if (labels.type() != CV_16UC1 || labels.cols != grid.geometry.width ||
      labels.rows != grid.geometry.height) {
    throw hyselam::InputError("labels", "", "they do not fit the grid");
  }
  const DoorFinder finder(grid, labels, params);
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
  dropChinks(params.min_width, out);
  // Ways past a table on either side of it are no doors.
  std::map<std::pair<int, int>, int> ways;
  for (const DoorLine& d : out) ++ways[{d.place_a, d.place_b}];
  for (DoorLine& d : out) {
    if (d.real && ways[{d.place_a, d.place_b}] > 1 && finder.endsAtIsland(d)) d.real = false;
  }
  std::sort(out.begin(), out.end(), [](const DoorLine& p, const DoorLine& q) {
    return std::tie(p.place_a, p.place_b, p.a.x, p.a.y) <
           std::tie(q.place_a, q.place_b, q.a.x, q.a.y);
  });
  return out;
}

}  // namespace hyselam_topo
