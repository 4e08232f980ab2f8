// TopoMerg: the fitness of section 5.3.1, the virtual scenario of 5.3.2, solvers against the
// explorer, questions.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <set>

#include "agreement_of_assignments.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_language/building/description_xml.hpp"
#include "hyselam_topo/topomerg/topomerg.hpp"
#include "hyselam_topo/topomerg/topomerg_names.hpp"
#include "hyselam_topological_map/topological_map_xml.hpp"
#include "random_matches.hpp"

using namespace random_matches;  // NOLINT: a test, not a header

namespace {

constexpr double kPi = 3.14159265358979323846;

/// Table 5.1's scenario. The robot's corridor is place 4 of the map; the kitchen is in two pieces.
struct Scenario {
  DescribedBuilding building =
      loadDescription(std::string(HYSELAM_PACKAGE_DIR) + "/test/data/scenario_532_human.xml");
  AugmentedTopologicalMap map =
      loadXml(std::string(HYSELAM_PACKAGE_DIR) + "/test/data/scenario_532_map.xml");
  MatchObserver observer{4, 0.0};
  MatchProblem problem = compileMatch(building, map, observer);
};

SolverParams tableRun(double e, double v, double d, double a) {
  SolverParams params;
  params.dummy = false;
  params.connected = false;
  params.fitness = FitnessParams::equation52();
  params.fitness.edges = e;
  params.fitness.vertices = v;
  params.fitness.orientations = d;
  params.fitness.areas = a;
  params.fitness.sides = SideRule::kCenters;
  return params;
}

/// Weights of Eq. 5.2.
SolverParams shares() {
  SolverParams params;
  params.fitness = FitnessParams::equation52();
  return params;
}

DescribedPlace told(Id id, const std::string& name, double area = 0.0) {
  DescribedPlace p;
  p.id = id;
  p.name = name;
  if (area > 0.0) p.area = area;
  return p;
}

DescribedConnection connection(Id from, Id to, Side side = Side::kUnknown, std::size_t order = 0) {
  return {from, to, side, order};
}

/// A corridor (1) with a room on its left (2) and right (3), as map and as told.
struct Small {
  DescribedBuilding building;
  AugmentedTopologicalMap map;
  Small() {
    building.places = {told(1, "corridor"), told(2, "left room", 10), told(3, "right room")};
    building.connections = {connection(1, 2, Side::kLeft), connection(1, 3, Side::kRight)};
    building.robot_place = 1;
    map.places = {mapPlace(1, 0, 0, 20), mapPlace(2, 0, 4, 8), mapPlace(3, 0, -4, 12)};
    map.edges = {mapEdge(1, 2), mapEdge(1, 3)};
    normalize(map);
  }
};

}  // namespace

TEST(TopoMergFitness, TermsOfEquation52ByHand) {
  Small s;
  const MatchProblem p = compileMatch(s.building, s.map, {1, 0.0});
  FitnessParams params = FitnessParams::equation52();
  // A: 1 - 2/10 over one size; D: 1; C: 1; E: 1.
  EXPECT_NEAR((1.0 + 0.8 + 1.0 + 1.0) / 4, fitness(p, params, {0, 1, 2}), 1e-12);
  // The rooms exchanged: A 1 - 2/12, both sides wrong by pi.
  EXPECT_NEAR((1.0 + 10.0 / 12 + 1.0 + 0.0) / 4, fitness(p, params, {0, 2, 1}), 1e-12);
  // No right room: E 2/3, C 2 of 3 pairs (N_e = n(n-1)/2), D 1/2.
  EXPECT_NEAR((2.0 / 3 + 0.8 + 2.0 / 3 + 0.5) / 4, fitness(p, params, {0, 1, -1}), 1e-12);
  // The heading turns what was told.
  EXPECT_NEAR((1.0 + 0.8 + 1.0 + 0.5) / 4,
              fitness(compileMatch(s.building, s.map, {1, kPi / 2}), params, {0, 1, 2}), 1e-12);
  // ... and is found where nobody knows it.
  double heading = 9.0;
  EXPECT_NEAR(0.95, fitness(compileMatch(s.building, s.map), params, {0, 1, 2}, &heading), 1e-12);
  EXPECT_NEAR(0.0, heading, 1e-12);
}

TEST(TopoMergFitness, WeightsOfWhatIsNotDescribedDropOut) {
  Small s;
  s.building.places[1].area.reset();
  for (auto& c : s.building.connections) c.side = Side::kUnknown;
  const MatchProblem p = compileMatch(s.building, s.map, {1, 0.0});
  EXPECT_NEAR(1.0, fitness(p, FitnessParams::equation52(), {0, 1, 2}), 1e-12);
  EXPECT_NEAR(0.5 * 2 / 3 + 0.5 * 2 / 3, fitness(p, FitnessParams::equation52(), {0, 1, -1}),
              1e-12);
}

TEST(TopoMergFitness, SidesAreSpreadInTheDescribedOrder) {
  DescribedBuilding b;
  for (Id id = 1; id <= 6; ++id) b.places.push_back(told(id, "p" + std::to_string(id)));
  b.connections = {connection(1, 2, Side::kLeft, 0), connection(1, 3, Side::kLeft, 1),
                   connection(1, 4, Side::kRight, 0), connection(1, 5, Side::kRight, 1),
                   connection(1, 6, Side::kBack, 0)};
  AugmentedTopologicalMap map;
  map.places = {mapPlace(1, 0, 0, 1)};
  normalize(map);
  const MatchProblem p = compileMatch(b, map);
  std::map<int, double> angle;
  for (const auto& side : p.sides) angle[side.to] = side.angle;
  // pi / (2 n) apart, the first nearest to the back.
  EXPECT_NEAR(5 * kPi / 8, angle[1], 1e-12);
  EXPECT_NEAR(3 * kPi / 8, angle[2], 1e-12);
  EXPECT_NEAR(-5 * kPi / 8, angle[3], 1e-12);
  EXPECT_NEAR(-3 * kPi / 8, angle[4], 1e-12);
  EXPECT_NEAR(kPi, std::abs(angle[5]), 1e-12);
}

TEST(TopoMergFitness, SidesByDoorsAndTheirOrder) {
  // A long corridor to the east; both rooms on the left, their doors one behind the other. Seen
  // from its centre the first room lies rather behind.
  DescribedBuilding b;
  b.places = {told(1, "corridor"), told(2, "a"), told(3, "b")};
  b.connections = {connection(1, 2, Side::kLeft, 0), connection(1, 3, Side::kLeft, 1)};
  b.robot_place = 1;
  AugmentedTopologicalMap map;
  map.places = {mapPlace(1, 10, 0, 40), mapPlace(2, 1, 3, 10), mapPlace(3, 19, 3, 10)};
  map.edges = {mapEdge(1, 2), mapEdge(1, 3)};
  map.edges[0].doors = {mapDoor(1, 1, kPi / 2)};
  map.edges[1].doors = {mapDoor(19, 1, kPi / 2)};
  finish(&map);
  const MatchProblem p = compileMatch(b, map, {1, 0.0});
  EXPECT_NEAR(1.0, fitness(p, FitnessParams::equation52(), {0, 1, 2}), 1e-12);
  // Exchanged: the sides are right, of the four weights the one of the order is lost.
  EXPECT_NEAR(0.75, fitness(p, FitnessParams::equation52(), {0, 2, 1}), 1e-12);
  FitnessParams thesis = FitnessParams::equation52();
  thesis.sides = SideRule::kCenters;
  EXPECT_LT(fitness(p, thesis, {0, 1, 2}), 0.99);
}

TEST(TopoMergFitness, OneNameForSeveralPlaces) {
  Small s;
  s.map.places.push_back(mapPlace(4, 2, 4, 2));  // a piece of the left room
  s.map.edges.push_back(mapEdge(2, 4));
  normalize(s.map);
  const MatchProblem p = compileMatch(s.building, s.map, {1, 0.0});
  // 8 + 2 m^2 are the 10 told; the common centre lies at (0.4, 4).
  const double off = std::abs(std::atan2(4.0, 0.4) - kPi / 2) / kPi / 2;
  EXPECT_NEAR((4.0 - off) / 4, fitness(p, FitnessParams::equation52(), {0, 1, 2, 1}), 1e-12);
}

TEST(TopoMergFitness, UndescribedDoorsMayCostLess) {
  Small s;
  s.map.edges.push_back(mapEdge(2, 3));
  normalize(s.map);
  const MatchProblem p = compileMatch(s.building, s.map, {1, 0.0});
  FitnessParams params = FitnessParams::equation52();
  EXPECT_NEAR((1.0 + 0.8 + 2.0 / 3 + 1.0) / 4, fitness(p, params, {0, 1, 2}), 1e-12);
  params.undescribed_edge_credit = 0.5;
  EXPECT_NEAR((1.0 + 0.8 + 2.5 / 3 + 1.0) / 4, fitness(p, params, {0, 1, 2}), 1e-12);
}

/// A corridor (1) along x with doors to rooms 2 and 3 on its left; room 4 has a wall on its right,
/// but no door, and 5 is far away.
TEST(TopoMergFitness, WallsMayHideClosedDoors) {
  AugmentedTopologicalMap map;
  map.places = {mapPlace(1, 5, 0, 20), mapPlace(2, 2, 3, 12), mapPlace(3, 6, 3, 12),
                mapPlace(4, 3, -3, 12), mapPlace(5, 30, 3, 12)};
  map.edges = {mapEdge(1, 2), mapEdge(1, 3)};
  map.edges[0].doors = {mapDoor(2, 1, kPi / 2)};
  map.edges[1].doors = {mapDoor(6, 1, kPi / 2)};
  const auto addWall = [&](std::size_t place, double x, double y, double ny, double length) {
    Wall wall;
    wall.id = map.next_wall_id++;
    wall.position = {x, y, 1.0};
    wall.normal = {0.0, ny, 0.0};
    wall.length = length;
    map.places[place].walls.push_back(wall);
  };
  addWall(0, 5.0, -1.0, 1.0, 10.0);
  addWall(3, 3.0, -1.2, -1.0, 4.0);
  finish(&map);

  DescribedBuilding building;
  building.places = {told(1, "corridor"), told(2, "office")};
  building.connections = {{1, 2, Side::kRight}};
  building.robot_place = 1;
  SolverParams params;
  params.fitness = FitnessParams::equation52();
  const MatchProblem problem = compileMatch(building, map, {1, 0.0});
  ASSERT_EQ(problem.walls.size(), 5u);
  ASSERT_EQ(problem.walls[0].size(), 1u);
  EXPECT_NEAR(problem.walls[0][0].bearing, -kPi / 2, 1e-9);
  EXPECT_NEAR(problem.walls[0][0].x, 3.0, 1e-9);
  EXPECT_NEAR(problem.walls[0][0].y, -1.1, 1e-9);
  ASSERT_EQ(problem.walls[3].size(), 1u);
  EXPECT_NEAR(problem.walls[3][0].bearing, kPi / 2, 1e-9);

  // Names count 1/3, the edge 1/3, the side 1/3: 0.3 of the last two is left at the wall.
  const auto value = [&](Assignment assignment) {
    return fitness(problem, params.fitness, assignment);
  };
  EXPECT_NEAR(value({0, -1, -1, 1, -1}), 1.0 / 3 + 0.3 * 2.0 / 3, 1e-12);
  EXPECT_NEAR(value({0, -1, -1, -1, 1}), 1.0 / 3, 1e-12);
  EXPECT_NEAR(value({0, 1, -1, -1, -1}), 2.0 / 3, 1e-12);
  params.fitness.closed_door_credit = 0.8;
  EXPECT_NEAR(value({0, -1, -1, 1, -1}), 1.0 / 3 + 0.8 * 2.0 / 3, 1e-12);
  EXPECT_EQ(solveExact(problem, params).best().assignment, (Assignment{0, -1, -1, 1, -1}));
  // The thesis knows no such doors.
  params.fitness.closed_door_credit = 0.0;
  EXPECT_NEAR(value({0, -1, -1, 1, -1}), 1.0 / 3, 1e-12);
  params.fitness.closed_door_credit = 0.8;
  params.fitness.sides = SideRule::kCenters;
  EXPECT_NEAR(value({0, -1, -1, 1, -1}), 1.0 / 3, 1e-12);
}

TEST(TopoMergFitness, RelationsPreferWhereTheyHold) {
  // Five rooms in a row on one side of a corridor, one across.
  AugmentedTopologicalMap map;
  map.places = {mapPlace(1, 10, 0, 40), mapPlace(7, 2, -4, 16)};
  for (int k = 0; k < 5; ++k) map.places.push_back(mapPlace(2 + k, 2.0 + 4 * k, 4, 16));
  for (Id v = 2; v <= 7; ++v) map.edges.push_back(mapEdge(1, v));
  normalize(map);
  DescribedBuilding b;
  b.places = {told(1, "corridor"), told(2, "a"), told(3, "b"), told(4, "c")};
  b.connections = {connection(1, 2), connection(1, 3), connection(1, 4)};
  b.robot_place = 1;
  const auto value = [&](RelationKind kind, Id a, Id c, const Assignment& assignment) {
    b.relations = {{kind, a, kind == RelationKind::kAtEndOf ? 1u : 3u, c}};
    return fitness(compileMatch(b, map, {1, 0.0}), FitnessParams::equation52(), assignment);
  };
  // VertexSet: 1 corridor, 2..6 the row from the west, 7 across the first.
  const Assignment beside{0, 1, 2, -1, -1, 3, -1}, apart{0, 1, -1, -1, 2, 3, -1};
  EXPECT_GT(value(RelationKind::kNextTo, 2, 0, beside), value(RelationKind::kNextTo, 2, 0, apart));
  const Assignment across{0, 2, -1, 3, -1, -1, 1};
  EXPECT_GT(value(RelationKind::kOpposite, 2, 0, across),
            value(RelationKind::kOpposite, 2, 0, apart));
  const Assignment between{0, 2, 1, 3, -1, -1, -1}, outside{0, 1, 2, 3, -1, -1, -1};
  EXPECT_GT(value(RelationKind::kBetween, 2, 4, between),
            value(RelationKind::kBetween, 2, 4, outside));
  const Assignment end{0, 1, 2, 3, -1, -1, -1}, middle{0, 2, 3, 1, -1, -1, -1};
  EXPECT_GT(value(RelationKind::kAtEndOf, 2, 0, end), value(RelationKind::kAtEndOf, 2, 0, middle));
}

TEST(TopoMergFitness, PartsKindsEvidence) {
  Small s;
  s.building.places[1].parts = 2;
  EXPECT_NEAR(
      (3.8 + 0.5) / 5,
      fitness(compileMatch(s.building, s.map, {1, 0.0}), FitnessParams::equation52(), {0, 1, 2}),
      1e-12);
  s.building.places[1].parts.reset();
  s.building.places[1].kind = PlaceKind::kCorridor;
  FitnessParams params = FitnessParams::equation52();
  EXPECT_NEAR(3.8 / 4, fitness(compileMatch(s.building, s.map, {1, 0.0}), params, {0, 1, 2}), 1e-12)
      << "kinds must be off by default";
  params.kinds = 0.25;
  EXPECT_NEAR(3.8 / 5, fitness(compileMatch(s.building, s.map, {1, 0.0}), params, {0, 1, 2}),
              1e-12);
  s.building.places[1].kind.reset();
  const auto p = compileMatch(s.building, s.map, {1, 0.0}, {}, {{3, 2, 0.9}, {2, 2, 0.1}});
  EXPECT_NEAR((3.8 + 0.1) / 5, fitness(p, FitnessParams::equation52(), {0, 1, 2}), 1e-12);
}

TEST(TopoMergScenario, ExplorerVisitsAllOfEquation55) {
  const Scenario s;
  ASSERT_EQ(7u, s.problem.nameCount());
  ASSERT_EQ(8u, s.problem.vertexCount());
  const SolverParams params = tableRun(1, 0, 0, 0);
  EXPECT_EQ(823543.0, countAssignments(s.problem, params));
  EXPECT_EQ(823543u, exploreAll(s.problem, params).nodes);
  SolverParams with_dummy = params;
  with_dummy.dummy = true;
  EXPECT_EQ(2097152.0, countAssignments(s.problem, with_dummy));
}

TEST(TopoMergScenario, PatternOfTable51) {
  const Scenario s;
  struct Run {
    double e, v, d, a;
    std::size_t equal;
    double fitness;
  };
  double third = 0.0;
  for (const Run& run : {Run{1, 0, 0, 0, 48, 1.0}, Run{1, 1, 0, 0, 48, 1.0},
                         Run{1, 1, 1, 0, 1, 0.948}, Run{1, 1, 1, 1, 1, 0.953}}) {
    SolverParams params = tableRun(run.e, run.v, run.d, run.a);
    const PlaceAssignment all = exploreAll(s.problem, params);
    EXPECT_EQ(run.equal, all.equal);
    EXPECT_NEAR(run.fitness, all.best().fitness, run.fitness == 1.0 ? 1e-12 : 0.01);
    expectSame(all, solveExact(s.problem, params), "table 5.1");
    if (run.d > 0 && run.a == 0) third = all.best().fitness;
    if (run.a == 0) continue;
    EXPECT_GT(all.best().fitness, third) << "sizes are told precisely";
    // Fig. 5.11: Room B is place 1, then Room A 2, Living Room 3, corridor 4, kitchen 5 and 6,
    // laundry 7, WC 8.
    std::vector<std::string> names;
    for (const int i : all.best().assignment)
      names.push_back(s.building.places[static_cast<std::size_t>(i)].name);
    EXPECT_EQ((std::vector<std::string>{"Room B", "Room A", "Living Room", "corridor", "kitchen",
                                        "kitchen", "Laundry", "WC"}),
              names);
  }
}

TEST(TopoMergScenario, TreeSearchFindsIt) {
  const Scenario s;
  SolverParams params = tableRun(1, 1, 1, 1);
  const PlaceAssignment tree = treeSearch(s.problem, params);
  ASSERT_TRUE(tree.found());
  EXPECT_NEAR(solveExact(s.problem, params).best().fitness, tree.best().fitness, 1e-9);
  EXPECT_FALSE(tree.optimal);
}

// HYSELAM_ALL_MATCHES=N compares 2,000 instances, those with up to N answers for the explorer.
TEST(TopoMergExact, EqualsTheExplorer) {
  const char* all = std::getenv("HYSELAM_ALL_MATCHES");
  const int count = all != nullptr ? 2000 : 400;
  const double most = all != nullptr ? std::atof(all) : 1e5;
  int compared = 0, short_of = 0, without = 0;
  double shortfall = 0.0, worst = 0.0;
  for (std::uint64_t seed = 1; compared < count; ++seed) {
    Dice dice(seed * 7919 + 1);
    const int names = dice.whole(2, 7), places = dice.whole(3, 9);
    Instance in = dice.chance(0.5) ? wild(seed, names, places)
                                   : floor(seed, std::min(names, places), places,
                                           {0.6, 0.2, 0.1, 0.1, dice.chance(0.7), seed % 3 != 0});
    SolverParams params;
    params.dummy = dice.chance(0.5);
    params.connected = dice.chance(0.5);
    params.max_solutions = 5000000;
    if (dice.chance(0.6)) addWords(seed, &in);
    anyWeights(&dice, &params.fitness);
    params.fitness.kinds = dice.chance(0.3) ? 0.25 : 0.0;
    params.keep_within = dice.chance(0.2) ? 0.01 : 0.0;
    if (seed % 5 == 0) params.fitness.sides = SideRule::kCenters;
    if (seed % 4 < 2) addWalls(seed, &in.map);
    MatchProblem problem;
    try {
      problem = compile(in);
    } catch (const hyselam::InputError&) {
      continue;  // excluded where it is confirmed
    }
    if (countAssignments(problem, params) > (problem.heading ? most : 0.1 * most)) continue;
    ++compared;
    const PlaceAssignment oracle = exploreAll(problem, params);
    const PlaceAssignment exact = solveExact(problem, params);
    expectSame(oracle, exact, "seed " + std::to_string(seed));
    EXPECT_TRUE(exact.optimal);
    const PlaceAssignment tree = treeSearch(problem, params);
    if (!oracle.found()) continue;
    without += !tree.found();
    if (!tree.found()) continue;
    const double less = oracle.best().fitness - tree.best().fitness;
    EXPECT_GE(less, -1e-9);
    short_of += less > 1e-9;
    shortfall += less;
    worst = std::max(worst, less);
  }
  std::cout << compared << " instances: the tree search finds nothing in " << without
            << ", falls short in " << short_of << ", by " << shortfall / compared << " on average, "
            << worst << " at most\n";
}

TEST(TopoMergExact, LargeFloorsAreNoWorseThanTheTruth) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    FloorOptions options;
    options.wrong_size = 0.1;
    const Instance in = floor(seed, 12, 18, options);
    const MatchProblem problem = compile(in);
    const PlaceAssignment match = solveExact(problem, {});
    ASSERT_TRUE(match.found());
    EXPECT_TRUE(match.optimal);
    Assignment truth;
    for (const Id id : in.truth) truth.push_back(static_cast<int>(id) - 1);
    EXPECT_GE(match.best().fitness, fitness(problem, {}, truth) - 1e-9);
    EXPECT_NEAR(match.best().fitness, fitness(problem, {}, match.best().assignment), 1e-12);
  }
}

TEST(TopoMergExact, StopsInTimeAndReportsTheGap) {
  const Instance in = floor(1, 40, 60, {});
  const MatchProblem problem = compile(in);
  SolverParams params;
  params.time_limit = 0.02;
  const PlaceAssignment match = solveExact(problem, params);
  ASSERT_TRUE(match.found());
  EXPECT_FALSE(match.optimal);
  EXPECT_GT(match.gap, 0.0);
  EXPECT_LE(match.best().fitness + match.gap, 1.0 + 1e-9);
  Assignment truth;
  for (const Id id : in.truth) truth.push_back(static_cast<int>(id) - 1);
  EXPECT_GE(match.best().fitness + match.gap, fitness(problem, {}, truth) - 1e-9);
}

TEST(TopoMergTreeSearch, StopsRevisitsWhenTimeIsUp) {
  const Scenario s;
  SolverParams params = tableRun(1.0, 1.0, 0.0, 0.0);  // many equally good choices
  const PlaceAssignment all = treeSearch(s.problem, params);
  params.time_limit = 0.0;
  const PlaceAssignment first = treeSearch(s.problem, params);
  ASSERT_TRUE(first.found());
  EXPECT_LT(first.nodes, all.nodes);
}

TEST(TopoMergExact, SameInputSameAssignment) {
  const MatchProblem problem = compile(floor(5, 10, 15, {}));
  SolverParams params;
  params.keep_within = 0.005;
  expectSame(solveExact(problem, params), solveExact(problem, params), "twice");
}

TEST(TopoMergExact, FewerPlacesAmongEquallyGood) {
  // A cupboard behind the right room, whose size nobody told (section 7.3.1).
  Small s;
  s.map.places.push_back(mapPlace(4, 0, -6, 4));
  s.map.edges.push_back(mapEdge(3, 4));
  normalize(s.map);
  const PlaceAssignment match = solveExact(compileMatch(s.building, s.map, {1, 0.0}), shares());
  // Without it, with it, or as the right room behind a longer corridor.
  EXPECT_EQ(3u, match.equal);
  EXPECT_EQ((Assignment{0, 1, 2, -1}), match.best().assignment);
  EXPECT_EQ(3u, match.best().vertices);
  // The size decides.
  s.building.places[2].area = 16.0;
  EXPECT_EQ((Assignment{0, 1, 2, 2}),
            solveExact(compileMatch(s.building, s.map, {1, 0.0}), shares()).best().assignment);
}

TEST(TopoMergExact, FewestEvenIfNotAllAreKept) {
  Small s;
  s.map.places.push_back(mapPlace(4, 0, -6, 4));
  s.map.places.push_back(mapPlace(5, 0, -8, 4));
  s.map.edges.push_back(mapEdge(3, 4));
  s.map.edges.push_back(mapEdge(4, 5));
  normalize(s.map);
  SolverParams params;
  params.max_solutions = 1;
  const PlaceAssignment match = solveExact(compileMatch(s.building, s.map, {1, 0.0}), params);
  EXPECT_EQ(3u, match.best().vertices);
  EXPECT_TRUE(match.more);
}

TEST(TopoMergConstraints, ConfirmedExcludedUnnamed) {
  const Small s;
  MatchConstraints c;
  c.confirmed = {{3, 2}};
  const MatchProblem confirmed = compileMatch(s.building, s.map, {1, 0.0}, c);
  EXPECT_EQ((Assignment{0, 2, 1}), solveExact(confirmed, shares()).best().assignment);
  c = {};
  c.excluded = {{2, 2}};
  const PlaceAssignment other = solveExact(compileMatch(s.building, s.map, {1, 0.0}, c), shares());
  EXPECT_NE(1, other.best().assignment[1]);
  c = {};
  c.unnamed = {2};
  EXPECT_EQ(
      -1, solveExact(compileMatch(s.building, s.map, {1, 0.0}, c), shares()).best().assignment[1]);
}

TEST(TopoMergBadInput, IsRefused) {
  const Small s;
  const auto refused = [&](const MatchObserver& observer, const MatchConstraints& c,
                           const std::vector<MatchEvidence>& e = {}) {
    EXPECT_THROW(compileMatch(s.building, s.map, observer, c, e), hyselam::InputError);
  };
  refused({9, 0.0}, {});
  refused({1, std::nan("")}, {});
  refused({}, {{{9, 1}}, {}, {}});
  refused({}, {{{1, 9}}, {}, {}});
  refused({}, {{{1, 1}, {1, 2}}, {}, {}});
  refused({}, {{{1, 1}}, {{1, 1}}, {}});
  refused({}, {{{1, 1}}, {}, {1}});
  refused({}, {}, {{1, 1, 1.5}});
  refused({}, {}, {{1, 9, 0.5}});
  AugmentedTopologicalMap large;
  for (Id v = 1; v <= 257; ++v) large.places.push_back(mapPlace(v, v, 0, 1));
  normalize(large);
  EXPECT_THROW(compileMatch(s.building, large), hyselam::InputError);
  const MatchProblem p = compileMatch(s.building, s.map);
  EXPECT_THROW(exploreAll(p, {}, 10), hyselam::InputError);
}

TEST(TopoMergBadInput, ParametersOutOfRange) {
  const MatchProblem p = compile(floor(1, 3, 3, {}));
  const auto refused = [&](auto change) {
    SolverParams params;
    change(&params);
    EXPECT_THROW(solveExact(p, params), hyselam::ParameterError);
  };
  refused([](SolverParams* m) { m->fitness.areas = -1; });
  refused([](SolverParams* m) { m->fitness.kinds = std::nan(""); });
  refused([](SolverParams* m) {
    m->fitness.vertices = m->fitness.areas = m->fitness.edges = m->fitness.orientations = 0;
  });
  refused([](SolverParams* m) { m->fitness.undescribed_edge_credit = 1.5; });
  refused([](SolverParams* m) { m->fitness.closed_door_credit = -0.1; });
  refused([](SolverParams* m) { m->time_limit = -1; });
  refused([](SolverParams* m) { m->max_solutions = 0; });
  refused([](SolverParams* m) { m->keep_within = 2; });
}

TEST(TopoMergBadInput, EmptyMapsAndDescriptions) {
  const Small s;
  const PlaceAssignment no_names = solveExact(compileMatch({}, s.map), {});
  ASSERT_TRUE(no_names.found());
  EXPECT_EQ((Assignment{-1, -1, -1}), no_names.best().assignment);
  const PlaceAssignment no_places = solveExact(compileMatch(s.building, {}), {});
  ASSERT_TRUE(no_places.found());
  EXPECT_TRUE(no_places.best().assignment.empty());
  SolverParams all_named;
  all_named.dummy = false;
  EXPECT_FALSE(solveExact(compileMatch({}, s.map), all_named).found());
}

TEST(TopoMergNames, UncertaintyIsTheDropOfTheBestOtherAnswer) {
  const Scenario s;
  SolverParams params = tableRun(1, 1, 1, 1);
  const PlaceAssignment match = solveExact(s.problem, params);
  for (const NameUncertainty& u : nameUncertainties(s.problem, params, match)) {
    if (u.name == *s.building.robot_place) {
      EXPECT_EQ(1.0, u.drop);
      continue;
    }
    MatchConstraints c;
    c.excluded = {{u.place, u.name}};
    const PlaceAssignment other =
        exploreAll(compileMatch(s.building, s.map, s.observer, c), params);
    EXPECT_NEAR(match.best().fitness - other.best().fitness, u.drop, 1e-9);
    EXPECT_GT(u.drop, 0.0);
  }
}

TEST(TopoMergNames, WithoutTimeNothingIsSure) {
  const MatchProblem problem = compile(floor(1, 6, 8));
  SolverParams params;
  const PlaceAssignment match = solveExact(problem, params);
  params.time_limit = 0.0;
  const auto none = nameUncertainties(problem, params, match);
  const auto all = nameUncertainties(problem, {}, match);
  ASSERT_EQ(none.size(), all.size());
  for (std::size_t k = 0; k < all.size(); ++k) EXPECT_LE(none[k].drop, all[k].drop + 1e-9);
}

TEST(TopoMergNames, AsksWhereAnswersDiffer) {
  // Nobody told a side: left and right room may be exchanged.
  Small s;
  s.building.places[1].area.reset();
  for (auto& c : s.building.connections) c.side = Side::kUnknown;
  const MatchProblem p = compileMatch(s.building, s.map, {1, 0.0});
  const PlaceAssignment match = solveExact(p, {});
  EXPECT_EQ(2u, match.equal);
  const auto question = mostInformativeQuestion(p, match);
  ASSERT_TRUE(question.has_value());
  EXPECT_EQ(2u, question->place);
  EXPECT_NEAR(0.5, question->probability, 1e-9);
  EXPECT_NEAR(1.0, question->bits, 1e-9);
  // One answer settles both.
  MatchConstraints c;
  c.confirmed = {{question->place, 3}};
  const MatchProblem answered = compileMatch(s.building, s.map, {1, 0.0}, c);
  const PlaceAssignment sure = solveExact(answered, {});
  EXPECT_EQ((Assignment{0, 2, 1}), sure.best().assignment);
  EXPECT_FALSE(mostInformativeQuestion(answered, sure).has_value());
}

TEST(TopoMergNames, WordsOfTheMap) {
  Small s;
  s.building.places[1].aliases = {"office"};
  s.map.places[1].words = {{"lab", true}, {"old guess", false}};
  const MatchProblem p = compileMatch(s.building, s.map, {1, 0.0});
  const auto named = withNames(s.map, s.building, p, solveExact(p, {}).best());
  checkMap(named, "map");
  ASSERT_EQ(1u, named.places[0].words.size());
  EXPECT_EQ("corridor", named.places[0].words[0].text);
  EXPECT_TRUE(named.places[0].words[0].confirmed);
  ASSERT_EQ(3u, named.places[1].words.size());
  EXPECT_EQ("lab", named.places[1].words[0].text);
  EXPECT_EQ("left room", named.places[1].words[1].text);
  EXPECT_FALSE(named.places[1].words[1].confirmed);
  EXPECT_EQ("office", named.places[1].words[2].text);
}
