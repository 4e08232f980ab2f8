// What people say besides sizes, sides and rows reaches the match: rooms that the robot has not
// seen, numbers of doors, distances, relations of every kind, what is denied, other floors; and how
// sure the names are.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <thread>

#include "agreement_of_assignments.hpp"
#include "hyselam_topo/topomerg/topomerg.hpp"
#include "hyselam_topo/topomerg/topomerg_names.hpp"
#include "random_matches.hpp"

using namespace random_matches;  // NOLINT: a test, not a header

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr Id kCorridor = 1;

DescribedPlace told(Id id, const std::string& name) {
  DescribedPlace p;
  p.id = id;
  p.name = name;
  return p;
}

/// A corridor (1) along x; rooms 2 to 6 on its left, 7 to 11 on its right, doors 4 m apart. The
/// robot stands at its beginning and looks along it.
struct Corridor {
  DescribedBuilding building;
  AugmentedTopologicalMap map;
  MatchObserver observer{kCorridor, 0.0};
  Corridor() {
    observer.position = hyselam::Point2{0.0, 0.0};
    map.places.push_back(mapPlace(kCorridor, 10.0, 0.0, 40.0, PlaceKind::kCorridor));
    for (int k = 0; k < 10; ++k) {
      const bool left = k < 5;
      const double x = 2.0 + 4.0 * (k % 5);
      map.places.push_back(mapPlace(static_cast<Id>(2 + k), x, left ? 3.0 : -3.0, 16.0));
      map.edges.push_back(mapEdge(kCorridor, static_cast<Id>(2 + k)));
      map.edges.back().doors = {mapDoor(x, left ? 1.0 : -1.0, left ? kPi / 2 : -kPi / 2)};
    }
    finish(&map);
    building.places.push_back(told(kCorridor, "corridor"));
    building.robot_place = kCorridor;
  }
  /// A further name, on a side of the corridor.
  DescribedConnection& add(Id id, Side side, std::size_t order = 0) {
    building.places.push_back(told(id, "room " + std::to_string(id)));
    building.connections.push_back({kCorridor, id, side, order});
    return building.connections.back();
  }
  void relate(RelationKind kind, Id a, Id b, Id c = 0, bool denied = false,
              Side side = Side::kUnknown) {
    building.relations.push_back({kind, a, b, c, side, denied});
  }
  MatchProblem problem() const { return compileMatch(building, map, observer); }
  PlaceAssignment solve() const { return solveExact(problem(), {}); }
  /// The place of the map that has the name; 0: none.
  Id placeOf(Id name) const {
    const MatchProblem p = problem();
    const PlaceAssignment match = solveExact(p, {});
    for (std::size_t v = 0; v < p.vertexCount(); ++v)
      if (match.best().assignment[v] >= 0 &&
          p.names[static_cast<std::size_t>(match.best().assignment[v])] == name)
        return p.vertices[v];
    return 0;
  }
  /// Fitness where name k is at places[k]; 0: at none.
  double value(const std::vector<Id>& places) const {
    Assignment assignment(map.places.size(), -1);
    for (std::size_t k = 0; k < places.size(); ++k)
      if (places[k] > 0) assignment[places[k] - 1] = static_cast<int>(k);
    return fitness(problem(), {}, assignment);
  }
};

/// All rooms are told, each with its size; the left ones first.
Corridor allTold() {
  Corridor c;
  for (Id room = 2; room <= 11; ++room) {
    c.add(room, room <= 6 ? Side::kLeft : Side::kRight, (room - 2) % 5);
    c.map.places[room - 1].area = 10.0 + room;
    c.building.places[room - 1].area = 10.0 + room;
  }
  return c;
}

}  // namespace

TEST(TopoMergUnseen, ATrueSentenceAboutAnUnseenRoomMovesNoName) {
  for (const Id kitchen : {2, 4, 6, 9, 11}) {
    Corridor c = allTold();
    c.building.places.push_back(told(12, "archive"));
    c.relate(RelationKind::kNextTo, 12, kitchen);
    for (Id room = 2; room <= 11; ++room) EXPECT_EQ(room, c.placeOf(room)) << kitchen;
    EXPECT_EQ(0u, c.placeOf(12));
  }
}

TEST(TopoMergCertainty, AStatementThatIsNotSureWeighsAsItsOdds) {
  const FitnessParams weights;
  const double all = [] {
    Corridor c;
    c.add(2, Side::kLeft);
    return solveExact(c.problem(), {}).scale;
  }();
  const auto lost = [&](double certainty) {
    Corridor c;
    c.add(2, Side::kLeft).side_certainty = certainty;
    return (c.value({kCorridor, 2}) - c.value({kCorridor, 7})) * all;
  };
  EXPECT_NEAR(weights.orientations, lost(1.0), 1e-9);
  EXPECT_NEAR(std::log(0.9 / 0.1), lost(0.9), 1e-9);
  EXPECT_NEAR(0.0, lost(0.5), 1e-9);
  EXPECT_NEAR(0.0, lost(0.2), 1e-9) << "what is likelier wrong says nothing, not the contrary";
}

TEST(TopoMergCertainty, SureStatementsWinOverThoseThatAreNot) {
  Corridor c = allTold();
  for (DescribedPlace& place : c.building.places) place.area.reset();
  // Rooms 3 and 4 told in the other order, not surely; their numbers for sure.
  std::swap(c.building.connections[1].order, c.building.connections[2].order);
  c.building.connections[1].order_certainty = 0.6;
  c.building.connections[2].order_certainty = 0.6;
  c.building.connections[3].order_certainty = 0.6;
  c.relate(RelationKind::kOpposite, 3, 8);
  c.relate(RelationKind::kOpposite, 4, 9);
  EXPECT_EQ(3u, c.placeOf(3));
  EXPECT_EQ(4u, c.placeOf(4));
  for (DescribedConnection& each : c.building.connections) each.order_certainty = 1.0;
  c.building.relations.clear();
  EXPECT_EQ(4u, c.placeOf(3));
}

TEST(TopoMergUnseen, NoPlaceIsAnAnswerWithItsOwnCost) {
  Corridor c;
  c.add(2, Side::kLeft);
  const MatchProblem problem = c.problem();
  FitnessParams params;
  const FitnessParams weights;
  // Of the corridor and the room: names, edge, side; each further place costs, in all eleven.
  const double all = 2 * weights.vertices + weights.edges + weights.orientations +
                     11 * weights.pieces +
                     10 * weights.edges * (1.0 - weights.undescribed_edge_credit);
  const Assignment seen{0, 1, -1, -1, -1, -1, -1, -1, -1, -1, -1};
  const Assignment wrong{0, -1, -1, -1, -1, -1, 1, -1, -1, -1, -1};
  const Assignment none{0, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1};
  EXPECT_NEAR(1.0, fitness(problem, params, seen), 1e-12);
  EXPECT_NEAR(1.0 - weights.orientations / all, fitness(problem, params, wrong), 1e-12);
  EXPECT_NEAR(
      1.0 -
          (weights.vertices + weights.absent_share * (weights.edges + weights.orientations)) / all,
      fitness(problem, params, none), 1e-12);
  EXPECT_NEAR(all, solveExact(problem, {}).scale, 1e-9);
}

TEST(TopoMergUnseen, AGapInTheRowIsLeftForIt) {
  // Three told on the left; the map has the first and the third, and a bare wall between them.
  Corridor c;
  c.add(2, Side::kLeft, 0);
  c.add(3, Side::kLeft, 1);
  c.add(4, Side::kLeft, 2);
  c.map.places.erase(c.map.places.begin() + 4, c.map.places.end());
  c.map.places.erase(c.map.places.begin() + 2);
  c.map.edges.erase(std::remove_if(c.map.edges.begin(), c.map.edges.end(),
                                   [](const Edge& e) { return e.b == 3 || e.b > 4; }),
                    c.map.edges.end());
  Wall wall;
  wall.id = c.map.next_wall_id++;
  wall.position = {6.0, 1.0, 1.0};
  wall.normal = {0.0, -1.0, 0.0};
  wall.length = 4.0;
  c.map.places[0].walls.push_back(wall);
  normalize(c.map);
  const MatchProblem problem = c.problem();
  ASSERT_EQ(3u, problem.gaps.size());
  ASSERT_EQ(1u, problem.gaps[0].size());
  EXPECT_NEAR(6.0, problem.gaps[0][0].x, 0.2);
  EXPECT_EQ(2u, c.placeOf(2));
  EXPECT_EQ(0u, c.placeOf(3));
  EXPECT_EQ(4u, c.placeOf(4));
}

TEST(TopoMergUnseen, OtherFloorsAreOnNoPlaceOfThisMap) {
  Corridor c;
  c.add(2, Side::kLeft);
  c.add(3, Side::kRight);
  c.building.places[2].floor = 1;
  c.relate(RelationKind::kNextTo, 3, 2);
  EXPECT_EQ(0u, c.placeOf(3));
  const PlaceAssignment match = c.solve();
  EXPECT_NEAR(1.0, match.best().fitness, 1e-12) << "what was told of it does not count";
  for (const NameUncertainty& u : nameUncertainties(c.problem(), {}, match))
    EXPECT_FALSE(u.name == 3 && u.unsure());
  c.building.places[2].floor = 0;
  EXPECT_NE(0u, c.placeOf(3));
  // Where people have confirmed it, it is.
  c.building.places[2].floor = 1;
  MatchConstraints constraints;
  constraints.confirmed = {{8, 3}};
  const MatchProblem confirmed = compileMatch(c.building, c.map, c.observer, constraints);
  EXPECT_EQ(2, solveExact(confirmed, {}).best().assignment[7]);
}

TEST(TopoMergNumbers, DoorsAreCountedFromTheRobotOn) {
  Corridor c;
  c.add(2, Side::kLeft).rank = 2;
  EXPECT_EQ(3u, c.placeOf(2));
  c.observer.position = hyselam::Point2{8.0, 0.0};
  EXPECT_EQ(5u, c.placeOf(2)) << "the first ahead is that at 10 m";
  c.observer.heading = kPi;  // the other way round: left is right
  EXPECT_EQ(7u, c.placeOf(2));
  c.observer.heading = 0.0;
  c.observer.position.reset();
  EXPECT_EQ(3u, c.placeOf(2)) << "from the end behind the robot";
  c.building.connections[0].rank = -1;
  EXPECT_EQ(6u, c.placeOf(2));
  c.building.connections[0].rank = -2;
  EXPECT_EQ(5u, c.placeOf(2));
}

TEST(TopoMergNumbers, EachIsCountedFromWhereItWasTold) {
  Corridor c;
  c.observer.heading = kPi;  // of the last one; the first has a view of its own
  c.add(2, Side::kLeft).rank = 2;
  c.building.connections.back().seen_from = hyselam::Pose2{0.0, 0.0, 0.0};
  c.add(3, Side::kRight).rank = 1;
  c.building.connections.back().seen_from = hyselam::Pose2{11.5, 0.0, kPi};
  EXPECT_EQ(3u, c.placeOf(2));
  EXPECT_EQ(4u, c.placeOf(3)) << "looking back the left wall is on the right";
  EXPECT_TRUE(lookAlike(hyselam::Pose2{0, 0, 3.0}, hyselam::Pose2{9, 0, -3.0}));
  EXPECT_FALSE(lookAlike(hyselam::Pose2{0, 0, 0.0}, hyselam::Pose2{0, 0, 0.9}));
  EXPECT_FALSE(areSameView(hyselam::Pose2{0, 0, 0}, hyselam::Pose2{2, 0, 0}));
  EXPECT_TRUE(areSameView(std::nullopt, hyselam::Pose2{2, 0, 0}));
}

TEST(TopoMergNumbers, TheirOrderOfTellingMeansNothing) {
  Corridor c;
  c.add(2, Side::kLeft, 0).rank = 4;
  c.add(3, Side::kLeft, 1).rank = 1;
  c.add(4, Side::kRight, 0).rank = 1;
  EXPECT_EQ(5u, c.placeOf(2));
  EXPECT_EQ(2u, c.placeOf(3));
  EXPECT_EQ(7u, c.placeOf(4));
}

TEST(TopoMergNumbers, RowsSkipDoorsUnwillingly) {
  Corridor c;
  c.add(2, Side::kLeft, 0);
  c.add(3, Side::kLeft, 1);
  EXPECT_GT(c.value({1, 2, 3}), c.value({1, 2, 4}));
  EXPECT_GT(c.value({1, 2, 4}), c.value({1, 4, 2}));
}

TEST(TopoMergNumbers, Distances) {
  Corridor c;
  c.add(2, Side::kRight).distance = 10.0;
  EXPECT_EQ(9u, c.placeOf(2));
  c.observer.position = hyselam::Point2{4.0, 0.0};
  EXPECT_EQ(10u, c.placeOf(2));
  // Without the position a distance says nothing.
  c.observer.position.reset();
  EXPECT_TRUE(c.problem().numbers.empty());
  EXPECT_EQ(5u, c.solve().equal);
}

TEST(TopoMergRelations, AfterAndBehind) {
  Corridor c;
  c.add(2, Side::kLeft).rank = 3;
  c.add(3, Side::kLeft).order = 1;
  c.relate(RelationKind::kAfter, 3, 2);
  EXPECT_GT(c.value({1, 4, 5}), c.value({1, 4, 3})) << "from the robot on";
  EXPECT_GT(c.value({1, 4, 5}), c.value({1, 4, 6})) << "right after it";
  EXPECT_EQ(5u, c.placeOf(3));
  c.add(4, Side::kLeft).rank = -1;
  c.building.relations = {{RelationKind::kAfter, 3, 2, 4}};  // seen from the far end
  EXPECT_EQ(3u, c.placeOf(3));

  Corridor d;
  d.add(2, Side::kRight).rank = 3;
  d.building.places.push_back(told(3, "store"));
  d.map.places.push_back(mapPlace(12, 11.0, -8.0, 16.0));
  normalize(d.map);
  d.relate(RelationKind::kBehind, 3, 2);
  EXPECT_GT(d.value({1, 9, 12}), d.value({1, 9, 4}));
  EXPECT_GT(d.value({1, 9, 12}), d.value({1, 9, 7}));
}

/// "On the way from the corridor" of a robot in it: from where it stands, not from the middle.
TEST(TopoMergRelations, AfterIsSeenFromWhereTheRobotStoodInAPlace) {
  Corridor c;
  c.map.places[0].outline = {{0.0, -1.0}, {20.0, -1.0}, {20.0, 1.0}, {0.0, 1.0}};
  c.add(2, Side::kLeft).rank = 1;
  c.add(3, Side::kLeft).order = 1;
  for (const Id from : {Id{0}, kCorridor}) {
    c.building.relations = {{RelationKind::kAfter, 3, 2, from}};
    c.observer.position = hyselam::Point2{0.5, 0.0};
    EXPECT_EQ(2u, c.placeOf(2));
    EXPECT_EQ(3u, c.placeOf(3));
  }
  // Beside the robot: what comes after it lies where the robot looks, or looked.
  for (const bool looks_back : {false, true}) {
    for (DescribedConnection& each : c.building.connections) {
      each = {kCorridor, each.to, looks_back ? Side::kRight : Side::kLeft};
    }
    c.building.relations = {{RelationKind::kAfter, 3, 2, kCorridor}};
    c.building.relations[0].seen_from = hyselam::Pose2{10.0, 0.0, looks_back ? kPi : 0.0};
    c.observer.heading = looks_back ? kPi : 0.0;
    EXPECT_GT(c.value({1, 4, looks_back ? Id{3} : Id{5}}),
              c.value({1, 4, looks_back ? Id{5} : Id{3}}));
  }
}

/// "Here on the left": the door that is nearest to the robot, be it a little behind it.
TEST(TopoMergNumbers, HereIsTheNearestDoor) {
  Corridor c;
  c.add(2, Side::kLeft).distance = 0.0;
  for (const auto& [x, nearest] : {std::pair{1.0, Id{2}}, {7.0, Id{3}}, {11.0, Id{4}}}) {
    c.observer.position = hyselam::Point2{x, 0.0};
    EXPECT_EQ(nearest, c.placeOf(2)) << "at " << x;
  }
  c.observer.position.reset();
  EXPECT_TRUE(c.problem().numbers.empty()) << "here is nowhere";
}

TEST(TopoMergRelations, SizesCompared) {
  Corridor c;
  c.map.places[3].area = 30.0;
  c.map.places[8].area = 6.0;
  c.add(2, Side::kLeft);
  c.add(3, Side::kLeft);
  c.building.connections[1].order = 0;
  c.relate(RelationKind::kLarger, 2, 3);
  EXPECT_EQ(4u, c.placeOf(2));
  c.building.relations.clear();
  c.building.places[1].size_word = SizeWord::kLarge;
  EXPECT_EQ(4u, c.placeOf(2));
  c.building.places[1].size_word = SizeWord::kSmall;
  EXPECT_NE(4u, c.placeOf(2));
  c.building.connections[0].side = Side::kRight;
  EXPECT_EQ(9u, c.placeOf(2));
}

TEST(TopoMergRelations, NumbersOfDoors) {
  Corridor c;
  c.map.edges.push_back(mapEdge(4, 5));
  c.map.edges.back().doors = {mapDoor(12.0, 3.0, 0.0)};
  finish(&c.map);
  c.add(2, Side::kLeft);
  c.building.places[1].doors = 2;
  EXPECT_NEAR(c.value({1, 4}), c.value({1, 5}), 1e-12);
  EXPECT_GT(c.value({1, 4}), c.value({1, 3}));
}

TEST(TopoMergRelations, OppositeIsAcrossNotBeside) {
  Corridor c;
  c.add(2, Side::kLeft).rank = 3;
  c.building.places.push_back(told(3, "boardroom"));
  c.building.connections.push_back({kCorridor, 3});
  c.relate(RelationKind::kOpposite, 3, 2);
  EXPECT_EQ(9u, c.placeOf(3));
  c.building.relations = {{RelationKind::kNextTo, 3, 2}};
  EXPECT_GE(c.value({1, 4, 5}), c.value({1, 4, 9}));
}

TEST(TopoMergRelations, BetweenIsNearBoth) {
  Corridor c;
  c.add(2, Side::kLeft).rank = 1;
  c.add(3, Side::kLeft).rank = 3;
  c.building.places.push_back(told(4, "store"));
  c.building.connections.push_back({kCorridor, 4});
  c.relate(RelationKind::kBetween, 4, 2, 3);
  EXPECT_EQ(3u, c.placeOf(4));
}

TEST(TopoMergRelations, WhatIsDeniedIsAvoided) {
  Corridor c;
  c.add(2, Side::kLeft).rank = 3;
  c.building.places.push_back(told(3, "store"));
  c.building.connections.push_back({kCorridor, 3});
  c.relate(RelationKind::kAtSide, 3, kCorridor, 0, true, Side::kRight);
  for (const Id right : {7, 9, 11}) EXPECT_GT(c.value({1, 4, 2}), c.value({1, 4, right}));
  EXPECT_LE(c.placeOf(3), 6u);
  EXPECT_NE(c.placeOf(3), 0u);
  c.building.relations = {{RelationKind::kNextTo, 3, 2, 0, Side::kUnknown, true}};
  EXPECT_GT(c.value({1, 4, 11}), c.value({1, 4, 5}));
  c.building.connections.pop_back();
  c.building.relations = {{RelationKind::kJoined, 3, kCorridor, 0, Side::kUnknown, true}};
  c.map.places.push_back(mapPlace(12, 30.0, 0.0, 16.0));
  normalize(c.map);
  EXPECT_GT(c.value({1, 4, 12}), c.value({1, 4, 5}));
  // A denied side says nothing where nobody knows the heading.
  c.building.relations = {{RelationKind::kAtSide, 3, kCorridor, 0, Side::kRight, true}};
  c.observer.heading.reset();
  EXPECT_TRUE(c.problem().relations.empty());
}

TEST(TopoMergCertainty, NearEqualNamesAreUnsure) {
  Corridor c;
  c.add(2, Side::kLeft);
  c.add(3, Side::kRight).rank = 2;
  const MatchProblem problem = c.problem();
  const PlaceAssignment match = solveExact(problem, {});
  EXPECT_EQ(5u, match.equal);
  EXPECT_EQ(5u, nearEqual(match, 1.0));
  for (const NameUncertainty& u : nameUncertainties(problem, {}, match)) {
    EXPECT_FALSE(u.name == 2 && !u.unsure()) << u.probability;
    EXPECT_FALSE(u.name == 3 && u.probability < 0.6) << u.probability;
    EXPECT_FALSE(u.name == 2 && u.probability > 0.5) << u.probability;
    EXPECT_FALSE(u.name == kCorridor && u.probability < 1.0) << u.probability;
  }
  SolverParams more;
  more.keep_within = 1.0;
  more.max_solutions = 100000;
  const PlaceAssignment all = solveExact(problem, more);
  EXPECT_EQ(5u, nearEqual(all, 1.0));
  EXPECT_GT(nearEqual(all, 100.0), 5u);
  EXPECT_GT(nearEqual(all, 1e6), nearEqual(all, 100.0));
}

TEST(TopoMergCertainty, OfANameWithoutPlaceItIsTheOddsOfAnyPlace) {
  Corridor c = allTold();
  c.building.places.push_back(told(12, "archive"));
  c.relate(RelationKind::kNextTo, 12, 4);
  MatchProblem problem = c.problem();
  const PlaceAssignment match = solveExact(problem, {});
  const NameUncertainty archive = nameUncertainties(problem, {}, match).back();
  EXPECT_EQ(0u, archive.place);
  EXPECT_TRUE(archive.proven);
  EXPECT_GT(archive.drop, 0.0);
  // The best answer in which it has a place: by the definition, and by exchanging a name.
  problem.attributes.back().needs_place = true;
  EXPECT_NEAR(match.best().fitness - solveExact(problem, {}).best().fitness, archive.drop, 1e-9);
}

TEST(TopoMergExact, SameInManyThreads) {
  Instance in = floor(7, 10, 14, {});
  addWords(7, &in);
  const MatchProblem problem = compile(in);
  SolverParams params;
  params.keep_within = 0.005;
  const PlaceAssignment alone = solveExact(problem, params);
  std::vector<PlaceAssignment> found(4);
  std::vector<std::thread> threads;
  for (PlaceAssignment& each : found)
    threads.emplace_back([&] { each = solveExact(problem, params); });
  for (std::thread& thread : threads) thread.join();
  for (const PlaceAssignment& each : found) {
    expectSame(alone, each, "threads");
    EXPECT_EQ(alone.nodes, each.nodes);
  }
}
