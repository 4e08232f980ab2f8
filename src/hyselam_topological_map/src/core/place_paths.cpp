#include "hyselam_topological_map/place_paths.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

namespace hyselam_topo {
namespace {

using hyselam::Cell;
using hyselam::Point2;

constexpr int kNone = -1;
constexpr float kDiagonal = 1.41421356f;
constexpr double kRoom = 0.8;    // [m] from the limits of the place nothing is gained any more
constexpr float kAtWall = 4.0f;  // a step along a wall is so many times as long

/// The part of the grid around a place.
class Window {
 public:
  Window(const PlaceGrid& grid, Id place, const CellBox& box)
      : grid_(grid),
        x0_(box.x_begin),
        y0_(box.y_begin),
        width_(box.x_end - box.x_begin),
        height_(box.y_end - box.y_begin) {
    inside_.resize(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
    for (int i = 0; i < static_cast<int>(inside_.size()); ++i) {
      const Cell c = cell(i);
      inside_[static_cast<std::size_t>(i)] = grid.placeOf({c.x + x0_, c.y + y0_}) == place;
    }
    weigh();
  }

  std::size_t size() const { return inside_.size(); }
  Cell cell(int index) const { return {index % width_, index / width_}; }
  int index(Cell c) const { return c.y * width_ + c.x; }
  bool inside(Cell c) const {
    return c.x >= 0 && c.y >= 0 && c.x < width_ && c.y < height_ &&
           inside_[static_cast<std::size_t>(index(c))];
  }
  Point2 center(Cell c) const { return grid_.geometry.center({c.x + x0_, c.y + y0_}); }

  /// The cell of the place nearest to a point; kNone without cells.
  int nearest(Point2 point) const {
    const auto& g = grid_.geometry;
    const Point2 p = g.origin.inverse() * point;
    int best = kNone;
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i < static_cast<int>(inside_.size()); ++i) {
      if (!inside_[static_cast<std::size_t>(i)]) continue;
      const Cell c = cell(i);
      const double dx = (c.x + x0_ + 0.5) * g.resolution - p.x;
      const double dy = (c.y + y0_ + 0.5) * g.resolution - p.y;
      if (dx * dx + dy * dy < least) {
        least = dx * dx + dy * dy;
        best = i;
      }
    }
    return best;
  }

  /// How much longer than it is a step to this cell counts.
  float weight(int index) const { return weights_[static_cast<std::size_t>(index)]; }

  /// What the straight line between two cells costs; infinite if it leaves the place.
  float straight(Cell a, Cell b) const {
    const int dx = b.x - a.x, dy = b.y - a.y;
    const int steps = std::max(std::abs(dx), std::abs(dy));
    float sum = 0.0f;
    for (int i = 1; i <= steps; ++i) {
      const double share = static_cast<double>(i) / steps;
      const Cell c{static_cast<int>(std::lround(a.x + share * dx)),
                   static_cast<int>(std::lround(a.y + share * dy))};
      if (!inside(c)) return std::numeric_limits<float>::infinity();
      sum += weight(index(c));
    }
    return sum * static_cast<float>(std::hypot(dx, dy) / std::max(1, steps));
  }

 private:
  /// From the distance to the nearest cell that is not in the place, in two passes.
  void weigh() {
    const float room = static_cast<float>(std::max(1.0, kRoom / grid_.geometry.resolution));
    weights_.assign(inside_.size(), 0.0f);
    const auto distance = [&](int x, int y) {
      return inside({x, y}) ? weights_[static_cast<std::size_t>(index({x, y}))] : 0.0f;
    };
    const auto pass = [&](int x, int y, int before) {
      if (!inside({x, y})) return;
      float& own = weights_[static_cast<std::size_t>(index({x, y}))];
      own = std::min({before < 0 ? room : own, distance(x + before, y) + 1.0f,
                      distance(x, y + before) + 1.0f, distance(x - 1, y + before) + kDiagonal,
                      distance(x + 1, y + before) + kDiagonal});
    };
    for (int y = 0; y < height_; ++y)
      for (int x = 0; x < width_; ++x) pass(x, y, -1);
    for (int y = height_ - 1; y >= 0; --y)
      for (int x = width_ - 1; x >= 0; --x) pass(x, y, 1);
    for (float& w : weights_) w = 1.0f + (kAtWall - 1.0f) * (1.0f - w / room);
  }

  const PlaceGrid& grid_;
  int x0_, y0_, width_, height_;
  std::vector<bool> inside_;
  std::vector<float> weights_;
};

/// For each cell the next one on the cheapest way to the goal (eight neighbours), and its cost.
struct WaysTo {
  std::vector<int> next;
  std::vector<float> cost;
};

WaysTo waysTo(const Window& window, int goal) {
  WaysTo ways{std::vector<int>(window.size(), kNone),
              std::vector<float>(window.size(), std::numeric_limits<float>::infinity())};
  std::vector<int>& next = ways.next;
  std::vector<float>& distance = ways.cost;
  using Entry = std::pair<float, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<Entry>> queue;
  distance[static_cast<std::size_t>(goal)] = 0.0f;
  next[static_cast<std::size_t>(goal)] = goal;
  queue.emplace(0.0f, goal);
  while (!queue.empty()) {
    const auto [d, index] = queue.top();
    queue.pop();
    if (d > distance[static_cast<std::size_t>(index)]) continue;
    const Cell c = window.cell(index);
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const Cell n{c.x + dx, c.y + dy};
        if ((dx == 0 && dy == 0) || !window.inside(n)) continue;
        const auto i = static_cast<std::size_t>(window.index(n));
        const float step = dx != 0 && dy != 0 ? kDiagonal : 1.0f;
        const float through = d + step * window.weight(index);
        if (through < distance[i]) {
          distance[i] = through;
          next[i] = index;
          queue.emplace(through, window.index(n));
        }
      }
    }
  }
  return ways;
}

/// The corners that remain when a way of cells is pulled taut, where that makes it no costlier.
std::vector<Cell> pulledTaut(const Window& window, const WaysTo& ways,
                             const std::vector<Cell>& way) {
  constexpr float kRounding = 1.02f;
  const auto cost = [&](std::size_t i) {
    return ways.cost[static_cast<std::size_t>(window.index(way[i]))];
  };
  const auto sees = [&](std::size_t i, std::size_t j) {
    return window.straight(way[i], way[j]) <= kRounding * (cost(i) - cost(j)) + 1.0f;
  };
  std::vector<Cell> corners{way.front()};
  std::size_t from = 0;
  while (from + 1 < way.size()) {
    // What is seen first and hidden later is seldom seen again: halve, then creep.
    std::size_t seen = from + 1, step = 1;
    while (step > 0) {
      if (seen + step < way.size() && sees(from, seen + step)) {
        seen += step;
        step *= 2;
      } else {
        step /= 2;
      }
    }
    corners.push_back(way[seen]);
    from = seen;
  }
  return corners;
}

}  // namespace

std::map<Id, CellBox> placeBoxes(const PlaceGrid& grid) {
  const auto& g = grid.geometry;
  std::map<Id, CellBox> boxes;
  for (int y = 0; y < g.height; ++y) {
    const std::uint16_t* row = &grid.labels[g.index({0, y})];
    for (int x = 0; x < g.width;) {
      const int begin = x;
      const std::uint16_t label = row[x];
      while (x < g.width && row[x] == label) ++x;
      const Id place = grid.placeOf({begin, y});
      if (place == 0) continue;
      CellBox& box = boxes.insert({place, {begin, y, x, y + 1}}).first->second;
      box.x_begin = std::min(box.x_begin, begin);
      box.x_end = std::max(box.x_end, x);
      box.y_end = y + 1;
    }
  }
  return boxes;
}

std::vector<std::vector<Point2>> waysWithin(const PlaceGrid& grid, Id place, const CellBox& box,
                                            const std::vector<Point2>& points, Point2 goal) {
  std::vector<std::vector<Point2>> ways(points.size());
  const Window window(grid, place, box);
  const int end = window.nearest(goal);
  if (end == kNone) return ways;
  const WaysTo to_end = waysTo(window, end);
  const std::vector<int>& next = to_end.next;
  for (std::size_t k = 0; k < points.size(); ++k) {
    int at = window.nearest(points[k]);
    if (next[static_cast<std::size_t>(at)] == kNone) continue;
    std::vector<Cell> way{window.cell(at)};
    while (at != end) {
      at = next[static_cast<std::size_t>(at)];
      way.push_back(window.cell(at));
    }
    for (const Cell c : pulledTaut(window, to_end, way)) ways[k].push_back(window.center(c));
  }
  return ways;
}

}  // namespace hyselam_topo
