#include "way_obstacles.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <utility>

#include "hyselam_topological_map/map_geometry.hpp"

namespace hyselam_topo {
namespace {

constexpr double kReach = 0.5;  // from a start on no place to the nearest one [m]

/// The places on both sides of a described wall, 0 where there is none.
std::pair<Id, Id> sidesOf(const DescribedWall& wall, const AugmentedTopologicalMap& map) {
  const WallLine& line = wall.line;
  const double length = line.length();
  const hyselam::Point2 across{(line.a.y - line.b.y) / length, (line.b.x - line.a.x) / length};
  const auto beside = [&](double sign) -> Id {
    // Beyond the wall itself, and what is drawn of it.
    for (const double far : {0.3, 0.5, 0.8}) {
      const auto at = placeAt(map, {0.5 * (line.a.x + line.b.x) + sign * far * across.x,
                                    0.5 * (line.a.y + line.b.y) + sign * far * across.y});
      if (at) return at->place;
    }
    return 0;
  };
  return {beside(1.0), beside(-1.0)};
}

/// A step between two places.
struct Step {
  Id a, b;
  const DescribedWall* wall;  // in the way; nullptr: none
};

/// Through edges that are not shut, then through walls.
std::vector<Step> stepsOf(const PlaceMan& places) {
  const std::vector<Id> shut = places.shutDoors();
  const auto isShut = [&](const Door& door) {
    return std::find(shut.begin(), shut.end(), door.id) != shut.end();
  };
  std::vector<Step> steps;
  for (const Edge& edge : places.map().edges) {
    if (edge.doors.empty() || !std::all_of(edge.doors.begin(), edge.doors.end(), isShut)) {
      steps.push_back({edge.a, edge.b, nullptr});
    }
  }
  // Shut doors first: of those in the way a person can open them again.
  for (const bool door : {true, false}) {
    for (const DescribedWall& wall : places.walls()) {
      const auto [a, b] = sidesOf(wall, places.map());
      const bool is_door = places.doorShutBy(wall) != nullptr;
      if (a != 0 && b != 0 && a != b && is_door == door) steps.push_back({a, b, &wall});
    }
  }
  return steps;
}

/// How many walls are on the way to a place, and the step through the first of them.
struct Reached {
  std::size_t walls = 0;
  const Step* first = nullptr;
};

/// All places that steps lead to, by as few walls as possible.
std::map<Id, Reached> reachedFrom(Id start, const std::vector<Step>& steps) {
  std::map<Id, Reached> reached{{start, {}}};
  for (bool again = true; again;) {
    again = false;
    for (const Step& step : steps) {
      for (const bool turned : {false, true}) {
        const auto before = reached.find(turned ? step.b : step.a);
        if (before == reached.end()) continue;
        Reached next = before->second;
        if (step.wall != nullptr && next.walls++ == 0) next.first = &step;
        const auto [after, is_new] = reached.emplace(turned ? step.a : step.b, next);
        if (!is_new && after->second.walls <= next.walls) continue;
        after->second = next;
        again = true;
      }
    }
  }
  return reached;
}

}  // namespace

bool hasClosedDoor(const AugmentedTopologicalMap& map, const RouteLeg& leg) {
  for (const Edge& edge : map.edges) {
    for (const Door& door : edge.doors) {
      if (door.state == DoorState::kClosed &&
          std::find(leg.doors.begin(), leg.doors.end(), door.id) != leg.doors.end()) {
        return true;
      }
    }
  }
  return false;
}

std::optional<WallInTheWay> wallInTheWay(const PlaceMan& places, const hyselam::Pose2& from,
                                         const std::vector<Id>& goals) {
  const auto start = placeAt(places.map(), {from.x, from.y}, kReach);
  if (!start) return std::nullopt;
  const std::vector<Step> steps = stepsOf(places);
  const std::map<Id, Reached> reached = reachedFrom(start->place, steps);
  const Step* first = nullptr;
  std::size_t least = std::numeric_limits<std::size_t>::max();
  for (const Id goal : goals) {
    const auto found = reached.find(goal);
    if (found == reached.end() || found->second.walls >= least) continue;
    least = found->second.walls;
    first = found->second.first;
  }
  if (first == nullptr) return std::nullopt;
  return WallInTheWay{*first->wall, first->a, first->b};
}

}  // namespace hyselam_topo
