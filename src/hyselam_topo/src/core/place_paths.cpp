#include "hyselam_topo/place_paths.hpp"

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
  }

  std::size_t size() const { return inside_.size(); }
  Cell cell(int index) const { return {index % width_, index / width_}; }
  int index(Cell c) const { return c.y * width_ + c.x; }
  bool inside(Cell c) const {
    return c.x >= 0 && c.y >= 0 && c.x < width_ && c.y < height_ &&
           inside_[static_cast<std::size_t>(index(c))];
  }
  Point2 centre(Cell c) const { return grid_.geometry.centre({c.x + x0_, c.y + y0_}); }

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

  /// Whether the straight line between two cells stays in the place.
  bool sees(Cell a, Cell b) const {
    const int dx = std::abs(b.x - a.x), dy = std::abs(b.y - a.y);
    const int steps = std::max(dx, dy);
    for (int i = 1; i < steps; ++i) {
      const double share = static_cast<double>(i) / steps;
      const Cell c{static_cast<int>(std::lround(a.x + share * (b.x - a.x))),
                   static_cast<int>(std::lround(a.y + share * (b.y - a.y)))};
      if (!inside(c)) return false;
    }
    return true;
  }

 private:
  const PlaceGrid& grid_;
  int x0_, y0_, width_, height_;
  std::vector<bool> inside_;
};

/// For each cell the next one on the shortest way to the goal (eight neighbours).
std::vector<int> nextTo(const Window& window, int goal) {
  std::vector<float> distance(window.size(), std::numeric_limits<float>::infinity());
  std::vector<int> next(window.size(), kNone);
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
        const float through = d + (dx != 0 && dy != 0 ? 1.41421356f : 1.0f);
        if (through < distance[i]) {
          distance[i] = through;
          next[i] = index;
          queue.emplace(through, window.index(n));
        }
      }
    }
  }
  return next;
}

/// The corners that remain when a way of cells is pulled taut.
std::vector<Cell> pulledTaut(const Window& window, const std::vector<Cell>& way) {
  std::vector<Cell> corners{way.front()};
  std::size_t from = 0;
  while (from + 1 < way.size()) {
    // What is seen first and hidden later is seldom seen again: halve, then creep.
    std::size_t seen = from + 1, step = 1;
    while (step > 0) {
      if (seen + step < way.size() && window.sees(way[from], way[seen + step])) {
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
  const std::vector<int> next = nextTo(window, end);
  for (std::size_t k = 0; k < points.size(); ++k) {
    int at = window.nearest(points[k]);
    if (next[static_cast<std::size_t>(at)] == kNone) continue;
    std::vector<Cell> way{window.cell(at)};
    while (at != end) {
      at = next[static_cast<std::size_t>(at)];
      way.push_back(window.cell(at));
    }
    for (const Cell c : pulledTaut(window, way)) ways[k].push_back(window.centre(c));
  }
  return ways;
}

}  // namespace hyselam_topo
