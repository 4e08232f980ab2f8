// Made-up floors of hyselam_sim from the plan to what a person tells of it and the map that gr2to
// makes of it: with words for the order along a side, with rooms that the robot has not seen, and
// with rooms that nobody tells of.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <set>

#include "../test/random_matches.hpp"
#include "hyselam_gr2to/gr2to.hpp"
#include "hyselam_sim/generate_plan.hpp"
#include "hyselam_sim/plan_geometry.hpp"
#include "hyselam_sim/rasterize.hpp"

namespace described_floors {

using namespace hyselam_topo;  // NOLINT: only a bench includes this
using hyselam::Cell;
using hyselam::OccupancyGrid;
using hyselam::Point2;
using random_matches::Dice;

struct Speaker {
  double told_sizes = 0.6;
  double wrong_sizes = 0.0;
  int confused_sides = 0;
  double ordinals = 0.0;  ///< sides of the robot's place that are told by numbers, not as a row
  int relations = 0;      ///< "A is next to B"
};

struct FloorOptions {
  Speaker speaker;
  int closed_doors = 0;  ///< while the robot maps
  double unseen = 0.0;   ///< share of the rooms that are described, but not on the map
  double untold = 0.0;   ///< share of the rooms that are on the map, but not described
  bool know_heading = true;
  bool know_position = true;
};

inline double areaOf(const hyselam_sim::Polygon& outline) {
  double twice = 0.0;
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const Point2& p = outline[k];
    const Point2& q = outline[(k + 1) % outline.size()];
    twice += p.x * q.y - q.x * p.y;
  }
  return 0.5 * std::abs(twice);
}

/// Place k of the plan has the id k + 1; 0: none.
inline Id placeAt(const hyselam_sim::FloorPlan& plan, Point2 p) {
  for (std::size_t k = 0; k < plan.places.size(); ++k)
    if (hyselam_sim::contains(plan.places[k].outline, p)) return static_cast<Id>(k + 1);
  return 0;
}

struct Passage {
  Id a = 0, b = 0;
  Point2 at, normal;  ///< the normal from a to b
};

inline std::vector<Passage> passages(const hyselam_sim::FloorPlan& plan) {
  std::vector<Passage> out;
  for (const auto& door : plan.doors) {
    const Point2 n{-door.along.y, door.along.x};
    const auto beside = [&](double sign) {
      for (const double d : {0.2, 0.4, 0.7})
        if (const Id id = placeAt(plan, {door.at.x + sign * d * n.x, door.at.y + sign * d * n.y}))
          return id;
      return Id{0};
    };
    const Id a = beside(-1.0), b = beside(1.0);
    if (a != 0 && b != 0 && a != b) out.push_back({a, b, door.at, n});
  }
  return out;
}

/// The place with most doors, where the robot stands.
inline Id rootOf(const std::vector<Passage>& doors) {
  std::map<Id, int> count;
  for (const Passage& d : doors) {
    ++count[d.a];
    ++count[d.b];
  }
  Id root = 1;
  for (const auto& [id, n] : count)
    if (n > count[root]) root = id;
  return root;
}

/// Rooms with one door, in any order, without the root.
inline std::vector<Id> leaves(const hyselam_sim::FloorPlan& plan, const std::vector<Passage>& doors,
                              Id root, Dice* dice) {
  std::vector<Id> out;
  for (Id id = 1; id <= plan.places.size(); ++id) {
    const auto count = std::count_if(doors.begin(), doors.end(),
                                     [id](const Passage& d) { return d.a == id || d.b == id; });
    if (count == 1 && id != root) out.push_back(id);
  }
  for (std::size_t k = out.size(); k > 1; --k)
    std::swap(out[k - 1], out[static_cast<std::size_t>(dice->whole(0, static_cast<int>(k) - 1))]);
  return out;
}

/// Along the longest wall.
inline double headingIn(const hyselam_sim::Polygon& outline) {
  double longest = 0.0, heading = 0.0;
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const Point2& p = outline[k];
    const Point2& q = outline[(k + 1) % outline.size()];
    const double length = std::hypot(q.x - p.x, q.y - p.y);
    if (length <= longest) continue;
    longest = length;
    heading = std::atan2(q.y - p.y, q.x - p.x);
  }
  return heading;
}

/// What a person who stands in the place with most doors and looks along it tells, from there on.
class Telling {
 public:
  Telling(const hyselam_sim::FloorPlan& plan, const Speaker& speaker, Id root, double heading,
          Point2 robot, std::set<Id> untold, Dice* dice)
      : plan_(plan),
        speaker_(speaker),
        root_(root),
        heading_(heading),
        robot_(robot),
        untold_(std::move(untold)),
        dice_(dice),
        doors_(passages(plan)) {}

  DescribedBuilding tell() {
    out_.robot_place = root_;
    tellPlaces();
    tellConnections();
    for (int k = 0; k < speaker_.relations; ++k) tellNeighbor();
    confuseSides();
    return out_;
  }

 private:
  struct Seen {
    double along;
    Id to;
    int rank;   ///< among all doors on that side, from the robot on; 0: it lies behind
    int ahead;  ///< as many doors lie there in all
  };

  void tellPlaces() {
    for (std::size_t k = 0; k < plan_.places.size(); ++k) {
      DescribedPlace place;
      place.id = static_cast<Id>(k + 1);
      place.name = plan_.places[k].name;
      if (place.name.find("corridor") != std::string::npos) place.kind = PlaceKind::kCorridor;
      if (dice_->chance(speaker_.told_sizes)) {
        place.area = areaOf(plan_.places[k].outline) * dice_->real(0.92, 1.08);
        if (dice_->chance(speaker_.wrong_sizes)) *place.area *= dice_->chance(0.5) ? 2.0 : 0.5;
      }
      if (untold_.count(place.id) == 0) out_.places.push_back(place);
    }
  }

  /// The doors of a place by side, in the direction that the robot looks.
  std::map<Side, std::vector<Seen>> rowsOf(Id from) const {
    std::map<Side, std::vector<Seen>> rows;
    for (const Passage& d : doors_) {
      if (d.a != from && d.b != from) continue;
      const double sign = d.a == from ? 1.0 : -1.0;
      const double turn =
          std::remainder(std::atan2(sign * d.normal.y, sign * d.normal.x) - heading_, 2 * M_PI);
      const Side side = std::abs(turn) < M_PI / 4       ? Side::kFront
                        : std::abs(turn) > 3 * M_PI / 4 ? Side::kBack
                        : turn > 0                      ? Side::kLeft
                                                        : Side::kRight;
      const bool across = side == Side::kFront || side == Side::kBack;
      rows[side].push_back(
          {across ? std::sin(heading_) * d.at.x - std::cos(heading_) * d.at.y : along(d.at),
           d.a == from ? d.b : d.a, 0, 0});
    }
    for (auto& [side, row] : rows) {
      std::sort(row.begin(), row.end(),
                [](const Seen& a, const Seen& b) { return a.along < b.along; });
      if (side == Side::kFront || side == Side::kBack) continue;
      int rank = 0;
      for (Seen& door : row)
        if (door.along > along(robot_)) door.rank = ++rank;
      for (Seen& door : row) door.ahead = rank;
    }
    return rows;
  }
  double along(Point2 p) const { return std::cos(heading_) * p.x + std::sin(heading_) * p.y; }

  /// Place by place outwards.
  void tellConnections() {
    std::set<Id> known{root_};
    std::vector<Id> waiting{root_};
    std::set<std::pair<Id, Id>> told;
    for (std::size_t w = 0; w < waiting.size(); ++w) {
      const Id from = waiting[w];
      for (const auto& [side, row] : rowsOf(from)) {
        const bool numbers = from == root_ && dice_->chance(speaker_.ordinals);
        std::size_t order = 0;
        for (const Seen& door : row) {
          if (untold_.count(door.to) > 0) continue;
          if (!told.insert({std::min(from, door.to), std::max(from, door.to)}).second) continue;
          DescribedConnection c;
          c.from = from;
          c.to = door.to;
          c.side = side;
          c.order = numbers && door.rank > 0 ? 0 : order++;
          if (numbers && door.rank > 0)
            c.rank = door.rank == door.ahead && dice_->chance(0.5) ? -1 : door.rank;
          out_.connections.push_back(c);
          if (known.insert(door.to).second) waiting.push_back(door.to);
        }
      }
    }
  }

  /// A true sentence about two rooms that lie side by side.
  void tellNeighbor() {
    const auto& places = out_.places;
    if (places.size() < 3) return;
    const auto& a =
        places[static_cast<std::size_t>(dice_->whole(0, static_cast<int>(places.size()) - 1))];
    const Point2 at = plan_.places[a.id - 1].at;
    Id nearest = 0;
    double least = std::numeric_limits<double>::infinity();
    for (const DescribedPlace& b : places) {
      if (b.id == a.id || b.id == root_ || a.id == root_) continue;
      const Point2 p = plan_.places[b.id - 1].at;
      const double d = std::hypot(p.x - at.x, p.y - at.y);
      if (d >= least) continue;
      least = d;
      nearest = b.id;
    }
    if (nearest == 0) return;
    DescribedRelation r;
    r.a = a.id;
    r.b = nearest;
    out_.relations.push_back(r);
  }

  void confuseSides() {
    for (int k = 0; k < speaker_.confused_sides && !out_.connections.empty(); ++k) {
      auto& c = out_.connections[static_cast<std::size_t>(
          dice_->whole(0, static_cast<int>(out_.connections.size()) - 1))];
      c.side = c.side == Side::kLeft    ? Side::kRight
               : c.side == Side::kRight ? Side::kLeft
               : c.side == Side::kFront ? Side::kBack
                                        : Side::kFront;
    }
  }

  const hyselam_sim::FloorPlan& plan_;
  const Speaker speaker_;
  const Id root_;
  const double heading_;
  const Point2 robot_;
  const std::set<Id> untold_;
  Dice* dice_;
  const std::vector<Passage> doors_;
  DescribedBuilding out_;
};

/// Closes as many doors: rooms behind them are on the map, but no path leads into them.
inline void shutDoors(hyselam_sim::FloorPlan* plan, int count, std::uint64_t seed) {
  Dice dice(seed ^ 0x5A5A5A5Au);
  std::vector<std::size_t> open(plan->doors.size());
  std::iota(open.begin(), open.end(), std::size_t{0});
  for (; count > 0 && !open.empty(); --count) {
    const auto k = open.begin() + dice.whole(0, static_cast<int>(open.size()) - 1);
    plan->doors[*k].initially_open = false;
    plan->doors[*k].schedule.clear();
    open.erase(k);
  }
}

/// A room that the robot has never seen: its door is closed, behind it the map is unknown.
inline void closeRoom(hyselam_sim::FloorPlan* plan, Id room) {
  for (auto& door : plan->doors) {
    const Point2 n{-door.along.y, door.along.x};
    for (const double d : {-0.7, -0.4, -0.2, 0.2, 0.4, 0.7})
      if (hyselam_sim::contains(plan->places[room - 1].outline,
                                {door.at.x + d * n.x, door.at.y + d * n.y})) {
        door.initially_open = false;
        door.schedule.clear();
      }
  }
}

inline void forgetRoom(const hyselam_sim::Polygon& outline, OccupancyGrid* grid) {
  for (int y = 0; y < grid->geometry.height; ++y)
    for (int x = 0; x < grid->geometry.width; ++x)
      if (hyselam_sim::contains(outline, grid->geometry.center({x, y}))) grid->at({x, y}) = -1;
}

/// The place of the plan that most cells of each place of the map lie in.
inline std::map<Id, Id> truthOf(const hyselam_sim::FloorPlan& plan, const Gr2ToResult& found) {
  std::map<Id, std::map<Id, int>> votes;
  const PlaceGrid& grid = *found.map.grid;
  for (int y = 0; y < grid.geometry.height; ++y)
    for (int x = 0; x < grid.geometry.width; ++x)
      if (const Id id = grid.placeOf({x, y}))
        if (const Id plan_id = placeAt(plan, grid.geometry.center({x, y}))) ++votes[id][plan_id];
  std::map<Id, Id> out;
  for (const auto& [id, counts] : votes)
    out[id] = std::max_element(counts.begin(), counts.end(), [](const auto& a, const auto& b) {
                return a.second < b.second;
              })->first;
  return out;
}

/// One floor, from its plan to the description and the map.
struct Floor {
  DescribedBuilding building;
  AugmentedTopologicalMap map;
  std::map<Id, Id> truth;              ///< place of the map -> name
  std::map<Id, std::set<Id>> covered;  ///< name -> places of the map that most of it lies in
  std::set<Id> in_map;                 ///< names that the map has a place for, whether told or not
  std::set<Id> unseen;                 ///< described names that were left out of the map
  MatchObserver observer;
};

/// For each place of the plan the place of the map that half of its cells or more lie in.
inline std::map<Id, std::set<Id>> coveredBy(const hyselam_sim::FloorPlan& plan,
                                            const Gr2ToResult& found) {
  std::map<Id, std::map<Id, int>> votes;
  std::map<Id, int> cells;
  const PlaceGrid& grid = *found.map.grid;
  for (int y = 0; y < grid.geometry.height; ++y)
    for (int x = 0; x < grid.geometry.width; ++x)
      if (const Id room = placeAt(plan, grid.geometry.center({x, y}))) {
        ++cells[room];
        if (const Id id = grid.placeOf({x, y})) ++votes[room][id];
      }
  std::map<Id, std::set<Id>> out;
  for (const auto& [room, counts] : votes)
    for (const auto& [id, n] : counts)
      if (2 * n >= cells[room]) out[room].insert(id);
  return out;
}

inline Floor makeFloor(const FloorOptions& o, std::uint64_t seed) {
  Floor floor;
  Dice dice(seed), choice(seed ^ 0x1F2E3D4Cu);
  auto plan = hyselam_sim::generatePlan(seed);
  shutDoors(&plan, o.closed_doors, seed);
  const std::vector<Passage> doors = passages(plan);
  const Id root = rootOf(doors);
  const auto& outline = plan.places[root - 1].outline;
  const double heading = headingIn(outline);
  std::vector<Id> free = leaves(plan, doors, root, &choice);
  const auto take = [&](double share) {
    std::set<Id> out;
    const auto n = std::lround(share * static_cast<double>(plan.places.size()));
    for (; out.size() < static_cast<std::size_t>(n) && !free.empty(); free.pop_back())
      out.insert(free.back());
    return out;
  };
  floor.unseen = take(o.unseen);
  const std::set<Id> untold = take(o.untold);
  // The robot stands on the middle line of its place, in its first half.
  const Point2 middle = plan.places[root - 1].at;
  double low = 0.0;
  for (const Point2& p : outline)
    low =
        std::min(low, std::cos(heading) * (p.x - middle.x) + std::sin(heading) * (p.y - middle.y));
  const double back = low * choice.real(0.0, 0.9);
  const Point2 robot{middle.x + back * std::cos(heading), middle.y + back * std::sin(heading)};
  floor.building = Telling(plan, o.speaker, root, heading, robot, untold, &dice).tell();

  for (const Id room : floor.unseen) closeRoom(&plan, room);
  OccupancyGrid grid = hyselam_sim::rasterize(plan, 0.05, 0.0);
  for (const Id room : floor.unseen) forgetRoom(plan.places[room - 1].outline, &grid);
  const Gr2ToResult found = gr2to(grid);
  floor.map = found.map;
  floor.truth = truthOf(plan, found);
  floor.covered = coveredBy(plan, found);
  double largest = 0.0;
  for (const Place& place : floor.map.places) {
    const auto is = floor.truth.find(place.id);
    if (is == floor.truth.end() || is->second != root || place.area <= largest) continue;
    largest = place.area;
    floor.observer.place = place.id;
  }
  if (o.know_heading) floor.observer.heading = heading;
  if (o.know_position) floor.observer.position = robot;
  for (const auto& [place, name] : floor.truth) floor.in_map.insert(name);
  return floor;
}

}  // namespace described_floors
