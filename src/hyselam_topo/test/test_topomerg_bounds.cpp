// TopoMerg's exact solver against the explorer where its bounds are not simple: maps in so many
// pieces that not all sets of them are listed, and headings that are only known up to a sector of
// the circle while names that belong together are looked at on their own.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <functional>
#include <iostream>
#include <string>

#include "agreement_of_assignments.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_topo/topomerg/topomerg.hpp"
#include "random_matches.hpp"

using namespace random_matches;  // NOLINT: a test, not a header

namespace {

/// HYSELAM_ALL_MATCHES: as many instances of each kind instead of the few of a quick test.
int instances(int quick) {
  return std::getenv("HYSELAM_ALL_MATCHES") != nullptr ? 2000 : quick;
}

void compare(std::uint64_t seed, int count, double most,
             const std::function<Instance(std::uint64_t, Dice*)>& make) {
  int compared = 0, without_heading = 0;
  for (; compared < count; ++seed) {
    Dice dice(seed * 104729 + 7);
    Instance in = make(seed, &dice);
    if (dice.chance(0.6)) addWords(seed, &in);
    SolverParams params;
    params.dummy = dice.chance(0.7);
    params.connected = dice.chance(0.8);
    params.max_solutions = 5000000;
    anyWeights(&dice, &params.fitness);
    params.keep_within = dice.chance(0.3) ? 0.01 : 0.0;
    MatchProblem problem;
    try {
      problem = compile(in);
    } catch (const hyselam::InputError&) {
      continue;  // excluded where it is confirmed
    }
    if (countAssignments(problem, params) > most) continue;
    ++compared;
    without_heading += !problem.heading;
    const PlaceAssignment exact = solveExact(problem, params);
    EXPECT_TRUE(exact.optimal);
    expectSame(exploreAll(problem, params), exact, "seed " + std::to_string(seed));
    if (testing::Test::HasFatalFailure()) return;
  }
  std::cout << compared << " instances, " << without_heading << " without a heading\n";
}

/// Names mean many pieces each; some of them cannot have one piece or the other.
Instance largePieces(std::uint64_t seed, Dice* dice) {
  const int names = dice->whole(2, 3);
  Instance in = wild(seed, names, dice->whole(9, 11));
  for (DescribedPlace& place : in.building.places)
    if (dice->chance(0.7)) place.area = dice->whole(8, 40) * 4.0;
  in.constraints.excluded.clear();
  const bool kept_out = dice->chance(0.7);
  for (const DescribedPlace& name : in.building.places)
    for (const Place& place : in.map.places)
      if (kept_out && place.id != in.observer.place && dice->chance(0.25))
        in.constraints.excluded.emplace_back(place.id, name.id);
  if (dice->chance(0.5)) addWalls(seed, &in.map);
  return in;
}

/// Two names in two halves of a map with one way between them, each kept out of the other's half:
/// the first grows from the robot's place towards the second, whose half is a large piece.
Instance halves(std::uint64_t seed, Dice* dice) {
  const int near = dice->whole(4, 5), far = 6;
  Instance in = wild(seed, 2, near + far);
  const auto inNear = [&](Id place) { return place <= static_cast<Id>(near); };
  in.map.edges.clear();
  for (int v = 2; v <= near + far; ++v) {
    // Mostly chains, the way between the halves anywhere but at the robot.
    const bool bridge = v == near + 1;
    const int first = v <= near ? 1 : bridge ? 2 : near + 1, last = bridge ? near : v - 1;
    const bool chain = !bridge && dice->chance(v <= near ? 0.6 : 0.85);
    const int to = chain ? last : dice->whole(first, last);
    in.map.edges.push_back(mapEdge(static_cast<Id>(to), static_cast<Id>(v)));
    if (dice->chance(0.5))
      in.map.edges.back().doors.push_back(
          mapDoor(dice->real(0, 12), dice->real(0, 12), dice->real(-3.1, 3.1)));
  }
  finish(&in.map);
  if (dice->chance(0.3)) addWalls(seed, &in.map);
  in.constraints.excluded.clear();
  for (const Place& place : in.map.places) {
    if (!inNear(place.id)) in.constraints.excluded.emplace_back(place.id, 1);
    if (inNear(place.id) && place.id != 1) in.constraints.excluded.emplace_back(place.id, 2);
  }
  in.observer.place = 1;
  // The first name is told as large as the robot's place alone, but must reach the second.
  in.building.places[0].area = in.map.places[0].area;
  return in;
}

/// A name with three others around it, told from the robot's place; nobody knows the heading.
Instance hubs(std::uint64_t seed, Dice* dice) {
  Instance in = wild(seed, 5, dice->whole(6, 7));
  auto& connections = in.building.connections;
  connections.clear();
  for (Id to = 2; to <= 5; ++to) {
    DescribedConnection c;
    c.from = to == 2 ? 1 : 2;
    c.to = to;
    c.side = dice->chance(0.85) ? static_cast<Side>(dice->whole(1, 4)) : Side::kUnknown;
    for (const auto& other : connections) c.order += other.from == c.from && other.side == c.side;
    connections.push_back(c);
  }
  // One vertex of the map has most of the others around it.
  const Id hub = static_cast<Id>(dice->whole(1, 3));
  for (const Place& place : in.map.places) {
    if (place.id == hub || in.map.findEdge(hub, place.id) != nullptr || dice->chance(0.3)) continue;
    Edge edge = mapEdge(hub, place.id);
    if (dice->chance(0.7))
      edge.doors.push_back(mapDoor(dice->real(0, 12), dice->real(0, 12), dice->real(-3.1, 3.1)));
    in.map.edges.push_back(edge);
  }
  finish(&in.map);
  if (dice->chance(0.3)) addWalls(seed, &in.map);
  if (!in.observer.place) in.observer.place = 1;
  in.observer.heading.reset();
  return in;
}

TEST(TopoMergBounds, LargePieces) {
  compare(1, instances(50), 2e5, largePieces);
}

TEST(TopoMergBounds, HalvesThatNamesAreKeptOutOf) {
  compare(1, instances(50), 2e5, halves);
}

TEST(TopoMergBounds, HubsWithoutAHeading) {
  compare(150, instances(20), 6e4, hubs);
}

}  // namespace
