#include "hyselam_topo/dialogue/route.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <queue>

#include "hyselam_topo/dialogue/place_pose.hpp"
#include "hyselam_topological_map/map_geometry.hpp"
#include "plane.hpp"

namespace hyselam_topo {
namespace {

using hyselam::Cell;
using hyselam::Point2;
using hyselam::Pose2;

constexpr double kReach = 0.5;  // from a start on no place to the nearest one [m]

/// A step from a place to another one.
struct Passage {
  Id from = 0;
  Id to = 0;
  Id door = 0;
  Segment opening;  ///< without a door: both ends the cell where the places meet
  bool closed = false;
};

/// Where two places without a door on record touch: the middle one of the cells of `a` beside `b`.
std::optional<Point2> contact(const PlaceGrid& grid, Id a, Id b) {
  std::vector<Point2> cells;
  Point2 mean;
  for (int y = 0; y < grid.geometry.height; ++y) {
    for (int x = 0; x < grid.geometry.width; ++x) {
      if (grid.placeOf({x, y}) != a) continue;
      if (grid.placeOf({x + 1, y}) != b && grid.placeOf({x - 1, y}) != b &&
          grid.placeOf({x, y + 1}) != b && grid.placeOf({x, y - 1}) != b) {
        continue;
      }
      cells.push_back(grid.geometry.center({x, y}));
      mean.x += cells.back().x;
      mean.y += cells.back().y;
    }
  }
  if (cells.empty()) return std::nullopt;
  mean.x /= static_cast<double>(cells.size());
  mean.y /= static_cast<double>(cells.size());
  return *std::min_element(cells.begin(), cells.end(), [&](Point2 p, Point2 q) {
    return distanceBetween(p, mean) < distanceBetween(q, mean);
  });
}

std::vector<Passage> passagesOf(const AugmentedTopologicalMap& map, const std::vector<Id>& shut) {
  std::vector<Passage> all;
  for (const Edge& edge : map.edges) {
    std::vector<Passage> here;
    for (const Door& door : edge.doors) {
      if (std::find(shut.begin(), shut.end(), door.id) != shut.end()) continue;
      here.push_back({edge.a, edge.b, door.id, ends(door), door.state == DoorState::kClosed});
    }
    if (edge.doors.empty()) {
      const auto at = contact(*map.grid, edge.a, edge.b);
      if (at) here.push_back({edge.a, edge.b, 0, {*at, *at}, false});
    }
    for (const Passage& p : here) {
      all.push_back(p);
      all.push_back({p.to, p.from, p.door, p.opening, p.closed});
    }
  }
  return all;
}

Point2 middle(const Segment& s) {
  return {0.5 * (s.first.x + s.second.x), 0.5 * (s.first.y + s.second.y)};
}

/// Ways over cells that keep clear of what is not free.
class CellWays {
 public:
  CellWays(const PlaceGrid& grid, const RouteParams& params) : grid_(grid), params_(params) {
    const auto& g = grid.geometry;
    cv::Mat free(g.height + 2, g.width + 2, CV_8UC1, cv::Scalar(0));
    for (int y = 0; y < g.height; ++y) {
      for (int x = 0; x < g.width; ++x) {
        if (grid.placeOf({x, y}) != 0) free.at<std::uint8_t>(y + 1, x + 1) = 255;
      }
    }
    // Thin lines without a place, as where two places meet, are no walls.
    cv::morphologyEx(free, free, cv::MORPH_CLOSE, cv::Mat::ones(2, 2, CV_8U));
    cv::distanceTransform(free, clearance_, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  }

  /// Through cells of a place, and those within `reach` [m] of both ends; empty: there is none.
  std::vector<Point2> way(Id place, Point2 from, Point2 to, double reach) const {
    const auto& g = grid_.geometry;
    const Cell start = nearestFree(from), goal = nearestFree(to);
    if (start.x < 0 || goal.x < 0) return {};
    const double infinite = std::numeric_limits<double>::infinity();
    std::vector<double> cost(g.cellCount(), infinite);
    std::vector<std::int32_t> before(g.cellCount(), -1);
    using Entry = std::pair<double, std::size_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<Entry>> open;
    const auto ahead = [&](Cell c) { return std::hypot(c.x - goal.x, c.y - goal.y); };
    cost[g.index(start)] = 0.0;
    open.push({ahead(start), g.index(start)});
    const auto width = static_cast<std::size_t>(g.width);
    while (!open.empty()) {
      const auto [estimate, i] = open.top();
      open.pop();
      const Cell c{static_cast<int>(i % width), static_cast<int>(i / width)};
      if (estimate > cost[i] + ahead(c) + 1e-9) continue;
      if (c == goal) return pathTo(goal, before, from, to);
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
          const Cell n{c.x + dx, c.y + dy};
          if ((dx == 0 && dy == 0) || !g.contains(n) || clearanceOf(n) <= 0.0) continue;
          // No squeezing between two corners.
          if (dx != 0 && dy != 0 &&
              (clearanceOf({c.x + dx, c.y}) <= 0.0 || clearanceOf({c.x, c.y + dy}) <= 0.0)) {
            continue;
          }
          const Id there = grid_.placeOf(n);
          if (there != place) {
            const Point2 p = g.center(n);
            if (distanceBetween(p, from) > reach && distanceBetween(p, to) > reach) continue;
          }
          const double step = std::hypot(dx, dy) * (1.0 + discomfort(n));
          const std::size_t j = g.index(n);
          if (cost[i] + step >= cost[j]) continue;
          cost[j] = cost[i] + step;
          before[j] = static_cast<std::int32_t>(i);
          open.push({cost[j] + ahead(n), j});
        }
      }
    }
    return {};
  }

 private:
  double clearanceOf(Cell c) const {
    return grid_.geometry.contains(c)
               ? clearance_.at<float>(c.y + 1, c.x + 1) * grid_.geometry.resolution
               : 0.0;
  }

  double discomfort(Cell c) const {
    const double d = clearanceOf(c);
    // Within the clearance only where there is no other way.
    if (d < params_.clearance) return 10.0 * (params_.discomfort + 1.0);
    if (d >= params_.comfortable_clearance) return 0.0;
    return params_.discomfort * (1.0 - d / params_.comfortable_clearance);
  }

  Cell nearestFree(Point2 p) const {
    const auto& g = grid_.geometry;
    const Cell c = g.cellAt(p);
    Cell best{-1, -1};
    double least = kReach;
    const int reach = static_cast<int>(std::ceil(kReach / g.resolution));
    for (int y = c.y - reach; y <= c.y + reach; ++y) {
      for (int x = c.x - reach; x <= c.x + reach; ++x) {
        if (clearanceOf({x, y}) <= 0.0) continue;
        const double d = distanceBetween(g.center({x, y}), p);
        if (d > least) continue;
        least = d;
        best = {x, y};
      }
    }
    return best;
  }

  std::vector<Point2> pathTo(Cell goal, const std::vector<std::int32_t>& before, Point2 from,
                             Point2 to) const {
    const auto& g = grid_.geometry;
    std::vector<Point2> path{to};
    for (auto i = static_cast<std::int32_t>(g.index(goal)); i >= 0;
         i = before[static_cast<std::size_t>(i)]) {
      path.push_back(g.center({i % g.width, i / g.width}));
    }
    path.push_back(from);
    std::reverse(path.begin(), path.end());
    return path;
  }

  const PlaceGrid& grid_;
  const RouteParams& params_;
  cv::Mat clearance_;
};

/// Rounds the steps of cells off, then spaces the points; each looks to the next one.
std::vector<Pose2> smooth(std::vector<Point2> points, double spacing) {
  for (int round = 0; round < 8; ++round) {
    std::vector<Point2> last = points;
    for (std::size_t i = 1; i + 1 < points.size(); ++i) {
      points[i] = {0.25 * (last[i - 1].x + 2.0 * last[i].x + last[i + 1].x),
                   0.25 * (last[i - 1].y + 2.0 * last[i].y + last[i + 1].y)};
    }
  }
  std::vector<Pose2> path;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool last = i + 1 == points.size();
    if (!path.empty() && !last &&
        std::hypot(points[i].x - path.back().x, points[i].y - path.back().y) < spacing) {
      continue;
    }
    path.push_back({points[i].x, points[i].y, 0.0});
  }
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    path[i].theta = std::atan2(path[i + 1].y - path[i].y, path[i + 1].x - path[i].x);
  }
  if (path.size() > 1) path.back().theta = path[path.size() - 2].theta;
  return path;
}

/// Dijkstra over passages; which of them lead to each of the goals most cheaply.
struct GraphSearch {
  const std::vector<Passage>& passages;
  std::vector<double> cost;
  std::vector<int> before;

  GraphSearch(const std::vector<Passage>& all, Id start, Point2 from, const RouteParams& params)
      : passages(all),
        cost(all.size(), std::numeric_limits<double>::infinity()),
        before(all.size(), -1) {
    using Entry = std::pair<double, std::size_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<Entry>> open;
    const auto price = [&](std::size_t i, Point2 p) {
      return distanceBetween(p, middle(passages[i].opening)) +
             (passages[i].closed ? params.closed_door : 0.0);
    };
    for (std::size_t i = 0; i < passages.size(); ++i) {
      if (passages[i].from != start) continue;
      cost[i] = price(i, from);
      open.push({cost[i], i});
    }
    while (!open.empty()) {
      const auto [c, i] = open.top();
      open.pop();
      if (c > cost[i]) continue;
      for (std::size_t j = 0; j < passages.size(); ++j) {
        if (passages[j].from != passages[i].to) continue;
        const double next = c + price(j, middle(passages[i].opening));
        if (next >= cost[j]) continue;
        cost[j] = next;
        before[j] = static_cast<int>(i);
        open.push({next, j});
      }
    }
  }
};

}  // namespace

void RouteParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit.renamed("comfortable", "comfortable_clearance");
  visit("clearance", clearance, Range::between(0.0, 5.0), "m",
        "paths keep this from walls where there is room");
  visit("comfortable_clearance", comfortable_clearance, Range::between(0.0, 10.0), "m",
        "nearer to a wall than this costs extra");
  visit("discomfort", discomfort, Range::between(0.0, 1e6), "",
        "extra cost at a wall, in multiples of the path length");
  visit("closed_door", closed_door, Range::atLeast(0.0), "m",
        "extra cost of a door that is known to be closed");
  visit("spacing", spacing, Range::above(0.0), "m", "of the poses of the path");
}

void RouteParams::validate() const {
  hyselam::checkParameters(*this);
}

namespace {

/// The goal that is nearest along the graph, and the passage through which it is entered.
struct NearestGoal {
  Id place = 0;           // 0: none can be reached
  int last_passage = -1;  // -1: the robot is in it
  PlacePose target;
};

NearestGoal nearestGoal(const AugmentedTopologicalMap& map, Id here, const std::vector<Id>& goals,
                        const std::vector<Passage>& passages, const GraphSearch& search) {
  NearestGoal nearest;
  double least = std::numeric_limits<double>::infinity();
  for (const Id id : goals) {
    const auto pose = placePose(map, id);
    if (!pose) continue;
    const Point2 end{pose->pose.x, pose->pose.y};
    if (id == here && 0.0 < least) {
      least = 0.0;
      nearest = {id, -1, *pose};
    }
    for (std::size_t i = 0; i < passages.size(); ++i) {
      if (passages[i].to != id) continue;
      const double cost = search.cost[i] + distanceBetween(middle(passages[i].opening), end);
      if (!(cost < least)) continue;
      least = cost;
      nearest = {id, static_cast<int>(i), *pose};
    }
  }
  return nearest;
}

/// A waypoint in a door heads through it, along the path.
void headAlongPath(RouteLeg& leg) {
  for (std::size_t i = 0; i + 1 < leg.waypoints.size(); ++i) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Pose2& p : leg.path) {
      const double d = std::hypot(p.x - leg.waypoints[i].x, p.y - leg.waypoints[i].y);
      if (d >= nearest) continue;
      nearest = d;
      leg.waypoints[i].theta = p.theta;
    }
  }
}

}  // namespace

std::optional<RouteLeg> planRoute(const AugmentedTopologicalMap& map, const Pose2& from,
                                  const std::vector<Id>& goals, const RouteParams& params,
                                  const std::vector<Id>& shut) {
  params.validate();
  if (!map.grid) return std::nullopt;
  const Point2 start{from.x, from.y};
  const auto here = placeAt(map, start, kReach);
  if (!here) return std::nullopt;
  const std::vector<Passage> passages = passagesOf(map, shut);
  const GraphSearch search(passages, here->place, start, params);
  const NearestGoal goal = nearestGoal(map, here->place, goals, passages, search);
  if (goal.place == 0) return std::nullopt;

  std::vector<const Passage*> taken;
  for (int i = goal.last_passage; i >= 0; i = search.before[static_cast<std::size_t>(i)]) {
    taken.push_back(&passages[static_cast<std::size_t>(i)]);
  }
  std::reverse(taken.begin(), taken.end());
  RouteLeg leg;
  leg.places.push_back(here->place);
  const CellWays ways(*map.grid, params);
  std::vector<Point2> path;
  Point2 at = start;
  const auto go = [&](Id place, Point2 to, double reach) {
    const std::vector<Point2> piece = ways.way(place, at, to, reach);
    if (piece.empty()) return false;
    path.insert(path.end(), piece.begin() + (path.empty() ? 0 : 1), piece.end());
    at = to;
    return true;
  };
  double reach = kReach;
  for (const Passage* p : taken) {
    const Point2 door = middle(p->opening);
    const double next = 0.5 * distanceBetween(p->opening.first, p->opening.second) + 0.3;
    if (!go(leg.places.back(), door, std::max(reach, next))) return std::nullopt;
    reach = next;
    leg.doors.push_back(p->door);
    leg.places.push_back(p->to);
    leg.waypoints.push_back({door.x, door.y, 0.0});
  }
  const Pose2& end = goal.target.pose;
  if (!go(goal.place, {end.x, end.y}, std::max(reach, kReach))) return std::nullopt;
  leg.waypoints.push_back(end);
  leg.path = smooth(std::move(path), params.spacing);
  for (std::size_t i = 0; i + 1 < leg.path.size(); ++i) {
    leg.length += hyselam::distance(leg.path[i], leg.path[i + 1]);
  }
  headAlongPath(leg);
  return leg;
}

}  // namespace hyselam_topo
