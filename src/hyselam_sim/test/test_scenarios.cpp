// The shipped buildings are those of the thesis, and the robot keeps off their walls.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "hyselam_sim/data.hpp"
#include "hyselam_sim/plan_geometry.hpp"
#include "hyselam_sim/rasterize.hpp"
#include "hyselam_sim/simulation.hpp"

namespace hyselam_sim {
namespace {

double clearance(const std::vector<Solid>& bodies, Point2 p) {
  double nearest = 1e9;
  for (const Solid& body : bodies) {
    if (contains(body.outline, p)) return 0.0;
    for (const Segment& s : edges({body})) nearest = std::min(nearest, distance(p, s));
  }
  return nearest;
}

TEST(Shipped, EveryPlanLoadsAndIsClosed) {
  const std::vector<std::string> names = shippedPlans();
  EXPECT_EQ(names, (std::vector<std::string>{"mcl_a", "mcl_b", "mcl_c", "ngram_a", "ngram_b",
                                             "office", "small", "university"}));
  for (const std::string& name : names) {
    const FloorPlan plan = loadFloorPlan(planFile(name));
    EXPECT_EQ(plan.name, name);
    for (const double resolution : {0.05, 0.1}) {
      const hyselam::OccupancyGrid grid = rasterize(plan, resolution, 0.0);
      EXPECT_GT(std::count(grid.cells.begin(), grid.cells.end(), 0), 1000) << name;
    }
  }
}

class ShippedRoute : public testing::TestWithParam<std::string> {};

TEST_P(ShippedRoute, NeverTouchesAWall) {
  const Route route = loadRoute(routeFile(GetParam()));
  EXPECT_EQ(route.name, GetParam());
  const FloorPlan plan = loadFloorPlan(planFile(route.plan));
  SimulationParams params;
  params.scan_rate = 1.0;  // not looked at
  const Simulation run = simulate(plan, route, 1, params);
  EXPECT_EQ(run.visits.size(), route.steps.size());
  double nearest = 1e9;
  Point2 last{1e9, 1e9};
  double valid_until = -1.0;
  std::vector<Solid> bodies;
  for (const hyselam::StampedPose2& truth : run.log.ground_truth) {
    const double time = truth.stamp - params.start_time;
    if (time >= valid_until) {
      bodies = solids(plan, time);
      valid_until = plan.nextDoorChange(time);
    }
    const Point2 p{truth.pose.x, truth.pose.y};
    if (length(p - last) < 0.05) continue;
    last = p;
    nearest = std::min(nearest, clearance(bodies, p));
  }
  EXPECT_GE(nearest, params.robot.radius);
}

INSTANTIATE_TEST_SUITE_P(All, ShippedRoute, testing::ValuesIn(shippedRoutes()),
                         [](const testing::TestParamInfo<std::string>& tested) {
                           return tested.param;
                         });

// A loop told by its corners and crossings: straight free legs along the middle of the corridor.
double loopLength(const FloorPlan& plan, const std::vector<Point2>& corners, double half_width) {
  const std::vector<Solid> bodies = solids(plan, 0.0);
  double sum = 0.0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Point2 a = corners[i], b = corners[(i + 1) % corners.size()];
    sum += length(b - a);
    for (const Point2& p : straightPath(a, b, 0.1)) {
      EXPECT_GE(clearance(bodies, p), half_width - 0.01) << plan.name << " " << p.x << " " << p.y;
    }
  }
  return sum;
}

std::vector<Point2> at(const FloorPlan& plan, const std::vector<std::string>& names) {
  std::vector<Point2> out;
  for (const std::string& name : names) out.push_back(plan.place(name).at);
  return out;
}

TEST(Scenarios, LoopsOfScenarioA) {
  const FloorPlan plan = loadFloorPlan(planFile("mcl_a"));
  EXPECT_NEAR(loopLength(plan, at(plan, {"SW", "S", "M1", "M2", "W"}), 1.5), 46.0, 0.02 * 46.0);
  EXPECT_NEAR(loopLength(plan, at(plan, {"W", "M2", "N", "NW"}), 1.5), 46.0, 0.02 * 46.0);
  EXPECT_NEAR(loopLength(plan, at(plan, {"S", "SE", "E", "M1"}), 1.5), 58.0, 0.02 * 58.0);
  EXPECT_NEAR(loopLength(plan, at(plan, {"M1", "E", "NE", "N", "M2"}), 1.5), 78.0, 0.02 * 78.0);
}

TEST(Scenarios, LoopsOfScenarioB) {
  const FloorPlan plan = loadFloorPlan(planFile("mcl_b"));
  EXPECT_NEAR(loopLength(plan, at(plan, {"A", "B", "F", "E"}), 1.5), 72.0, 0.02 * 72.0);
  EXPECT_NEAR(loopLength(plan, at(plan, {"B", "C", "G", "F"}), 1.5), 72.0, 0.02 * 72.0);
  EXPECT_NEAR(loopLength(plan, at(plan, {"C", "D", "H", "G"}), 1.5), 72.0, 0.02 * 72.0);
}

// Share of cells whose value is the same after half a turn about the given centre.
double symmetry(const FloorPlan& plan, Point2 center) {
  const hyselam::OccupancyGrid grid = rasterize(plan, 0.1, 0.0);
  std::size_t free = 0, same = 0;
  for (int y = 0; y < grid.geometry.height; ++y) {
    for (int x = 0; x < grid.geometry.width; ++x) {
      if (grid.at({x, y}) != hyselam::OccupancyGrid::kFree) continue;
      ++free;
      const Point2 p = 2.0 * center - grid.geometry.center({x, y});
      if (grid.valueOr(grid.geometry.cellAt(p)) == hyselam::OccupancyGrid::kFree) ++same;
    }
  }
  return static_cast<double>(same) / static_cast<double>(free);
}

TEST(Scenarios, BIsNearlySymmetricAndAIsNot) {
  const double b = symmetry(loadFloorPlan(planFile("mcl_b")), {18, 12});
  EXPECT_GT(b, 0.95);
  EXPECT_LT(b, 1.0);  // the blind end
  EXPECT_LT(symmetry(loadFloorPlan(planFile("mcl_a")), {16.5, 12}), 0.9);
}

TEST(Scenarios, CIsTwoTwinGalleriesIn25MetresSquare) {
  const FloorPlan plan = loadFloorPlan(planFile("mcl_c"));
  Point2 low{1e9, 1e9}, high{-1e9, -1e9};
  for (const PlanWall& wall : plan.walls) {
    for (const Point2& p : wall.points) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
  }
  EXPECT_NEAR(high.x - low.x, 25.0, 0.5);
  EXPECT_NEAR(high.y - low.y, 25.0, 0.5);
  // Within the galleries, the right one is the left one moved.
  const hyselam::OccupancyGrid grid = rasterize(plan, 0.1, 0.0);
  int differing = 0;
  for (double y = 0.05; y < 25.0; y += 0.1) {
    for (double x = 0.15; x < 10.35; x += 0.1) {
      const auto left = grid.valueOr(grid.geometry.cellAt({x, y}));
      const auto right = grid.valueOr(grid.geometry.cellAt({x + 14.5, y}));
      differing += left != right;
    }
  }
  EXPECT_EQ(differing, 0);
  EXPECT_GE(plan.doors.size(), 20U);
}

TEST(Scenarios, RoutesHaveTheIntendedLengths) {
  const auto meters = [](const std::string& name) {
    const Route route = loadRoute(routeFile(name));
    SimulationParams params;
    params.scan_rate = 1.0;
    return simulate(loadFloorPlan(planFile(route.plan)), route, 1, params).distance;
  };
  EXPECT_NEAR(meters("mcl_a"), 143.0, 5.0);
  EXPECT_NEAR(meters("mcl_b"), 203.0, 5.0);
  EXPECT_NEAR(meters("mcl_c"), 120.0, 5.0);
}

TEST(Layouts, LoopsOfLayoutA) {
  const FloorPlan plan = loadFloorPlan(planFile("ngram_a"));
  const Point2 west{0, 18}, north{10, 30}, east{31, 18}, south{10, 0}, middle{10, 18};
  const auto corner = [&](const char* name) { return plan.place(name).at; };
  EXPECT_NEAR(loopLength(plan, {west, corner("A"), north, middle}, 1.5), 44.0, 0.02 * 44.0);
  EXPECT_NEAR(loopLength(plan, {north, corner("B"), east, middle}, 1.5), 66.0, 0.02 * 66.0);
  EXPECT_NEAR(loopLength(plan, {south, corner("D"), west, middle}, 1.5), 56.0, 0.02 * 56.0);
  EXPECT_NEAR(loopLength(plan, {east, corner("C"), south, middle}, 1.5), 78.0, 0.02 * 78.0);
}

TEST(Layouts, LoopsOfLayoutB) {
  const FloorPlan plan = loadFloorPlan(planFile("ngram_b"));
  EXPECT_NEAR(loopLength(plan, {{0, 0}, {24, 0}, {24, 20}, {0, 20}}, 1.0), 88.0, 0.02 * 88.0);
  EXPECT_NEAR(loopLength(plan, {{4, 4}, {20, 4}, {20, 16}, {4, 16}}, 1.0), 56.0, 0.02 * 56.0);
  EXPECT_NEAR(loopLength(plan, {{8, 8}, {16, 8}, {16, 12}, {8, 12}}, 1.0), 24.0, 0.02 * 24.0);
}

TEST(Layouts, LoopsOfTheUniversity) {
  const FloorPlan plan = loadFloorPlan(planFile("university"));
  const auto corner = [&](const char* name) { return plan.place(name).at; };
  const Point2 north{12, 18}, south{12, 0};
  EXPECT_NEAR(loopLength(plan, {corner("A"), north, south, corner("D")}, 1.1), 60.0, 0.6);
  EXPECT_NEAR(loopLength(plan, {north, corner("B"), corner("C"), south}, 1.1), 90.0, 0.9);
}

// Fig. 5.8: B opens one door in each of the four corridors, C several at a time.
TEST(Layouts, DoorsOfTheUniversity) {
  FloorPlan plan = loadFloorPlan(planFile("university"));
  const auto open = [&](const std::string& configuration) {
    plan.setDoors(configuration);
    std::string sides;
    for (const PlanDoor& door : plan.doors) {
      if (door.isOpen(0.0)) sides += door.name.front();
    }
    return sides;
  };
  EXPECT_EQ(open("E_0"), "");
  EXPECT_EQ(open("E_B1"), "nesw");
  EXPECT_EQ(open("E_B2"), "nesw");
  for (const char* name : {"E_C1", "E_C2", "E_C3", "E_C4", "E_C5"}) {
    EXPECT_GE(open(name).size(), 5U) << name;
  }
}

// Fig. 5.7 b: after which share of the 40 laps the doors change, and to what.
class LongTerm : public testing::TestWithParam<std::pair<const char*, std::string>> {};

TEST_P(LongTerm, DoorsChangeAsInFigure57) {
  const auto [letter, expected] = GetParam();
  const std::vector<double> shares{21.4, 7.1, 2.4, 1.2, 10.7, 4.8, 9.6, 21.4, 7.1, 2.4, 1.2, 10.7};
  std::string configurations, now;
  std::vector<double> begins;
  double travelled = 0.0;
  for (int run = 1; run <= 4; ++run) {
    const Route route =
        loadRoute(routeFile("longterm_" + std::string(letter) + "_" + std::to_string(run)));
    const FloorPlan plan = loadFloorPlan(planFile(route.plan));
    SimulationParams params;
    params.scan_rate = 1.0;
    const Simulation driven = simulate(plan, route, 1, params);
    if (run > 1) {
      EXPECT_EQ(route.doors, now) << run;
    }
    if (run == 1) {
      configurations = now = route.doors;
      begins.push_back(0.0);
    }
    for (std::size_t i = 0; i < route.steps.size(); ++i) {
      if (route.steps[i].doors.empty()) continue;
      now = route.steps[i].doors;
      configurations += " " + now;
      begins.push_back(travelled + driven.distance * static_cast<double>(i) /
                                       static_cast<double>(route.steps.size()));
    }
    travelled += driven.distance;
  }
  EXPECT_EQ(configurations, expected);
  EXPECT_NEAR(travelled, 40 * 114.0, 0.03 * 40 * 114.0);
  ASSERT_EQ(begins.size(), shares.size());
  double sum = 0.0;
  for (std::size_t i = 0; i < shares.size(); ++i) {
    EXPECT_NEAR(begins[i] / travelled, 0.01 * sum, 0.03) << i;  // to a leg of the walk
    sum += shares[i];
  }
}

INSTANTIATE_TEST_SUITE_P(
    BAndC, LongTerm,
    testing::Values(std::make_pair("b", "E_0 E_B1 E_B2 E_0 E_B1 E_B2 E_B1 E_0 E_B1 E_0 E_B2 E_B1"),
                    std::make_pair("c",
                                   "E_0 E_C1 E_C2 E_C3 E_C4 E_C5 E_0 E_0 E_C1 E_C2 E_C3 E_C4")));

// Table 4.1 of Maffei (2017), as printed.
const char* const kTable41A =
    "ABCD ABCH GCDA BCHG BADC BABH GCDA BCHE DCGH DABC DEGB FEAB CHGB FHDA BCDE GBFE ABCH GBFH "
    "ABCD EGBF EABC HGBF HDAB CDEG CHGB FEAB CDAF HCGH DEGB ADCB FHDE GCDA BCHG BFED CBAD HEDC "
    "GHDA FGBA EHC B FDCG HDAB CDEG BFEA BCHG BFHD ABCD EGBF EABC HGBF HDAB CDEG BFEA B";
const char* const kTable41B =
    "AFGHIJ KLEBCD AFGHIJ KLEBCD AFGHIJ KLEBCD AFGHIJ KLEBCD AFGHIJ KLEBCD AFGHIJ KLEBCD AFGHLK "
    "JIEBCD AFGHLK JIEFGD ABCHEF KLIJGD ABCHEF GDABCH IJKLEF GDABCH LKJIEF GDABCH IJKLEF GDABCH "
    "IJKLIJ GDAFGH EBCDAF KLIJGH EBCDAF GHIJKL EBCDAF GHIJKL EBCDAF GHEFKL IJGDAB CHE";

std::string withoutBlanks(std::string s) {
  s.erase(std::remove(s.begin(), s.end(), ' '), s.end());
  return s;
}

std::string restored(std::string s, const std::string& printed, const std::string& meant) {
  const std::size_t i = s.find(printed);
  EXPECT_NE(i, std::string::npos) << printed;
  return s.replace(i, printed.size(), meant);
}

std::string sequence(const Route& route) {
  std::string s = route.start.place;
  for (const RouteStep& step : route.steps) s += step.spot.place;
  return s;
}

// Every step leads straight to the next place: no other place is passed on the way.
void expectDirectLegs(const std::string& name) {
  const Route route = loadRoute(routeFile(name));
  const FloorPlan plan = loadFloorPlan(planFile(route.plan));
  SimulationParams params;
  params.scan_rate = 1.0;
  const Simulation run = simulate(plan, route, 1, params);
  ASSERT_EQ(run.visits.size(), route.steps.size());
  std::string from = route.start.place;
  auto truth = run.log.ground_truth.begin();
  for (std::size_t i = 0; i < run.visits.size(); ++i) {
    const std::string& to = route.steps[i].spot.place;
    for (; truth != run.log.ground_truth.end() && truth->stamp <= run.visits[i].stamp; ++truth) {
      const Point2 p{truth->pose.x, truth->pose.y};
      for (const PlanPlace& place : plan.places) {
        if (place.name == from || place.name == to) continue;
        ASSERT_GT(length(p - place.at), 1.0)
            << "step " << i << ", " << from << " to " << to << ", passes " << place.name;
      }
    }
    const auto there = hyselam::poseAt(run.log.ground_truth, run.visits[i].stamp);
    ASSERT_TRUE(there);
    EXPECT_LT(length(Point2{there->x, there->y} - plan.place(to).at), 0.6) << "step " << i;
    from = to;
  }
}

TEST(Table41, RouteAIsTheSequenceWithThreeStepsRestored) {
  std::string printed = withoutBlanks(kTable41A);
  ASSERT_EQ(printed.size(), 209U);
  printed = restored(printed, "BABHG", "BADHG");
  printed = restored(printed, "BFHABC", "BFHDABC");
  printed = restored(printed, "CBFDCG", "CBFEDCG");
  EXPECT_EQ(sequence(loadRoute(routeFile("ngram_a"))), printed);
}

TEST(Table41, RoutesCAreTheSequencesAsPrinted) {
  const std::vector<std::string> printed{"DEBCEA DEBCEA DEBC", "DEBCEA DEBCEA DEBCEA DEBC",
                                         "DEBCEA DEBCEA DEBCEA DEBCEA D", "DEADEB CEBCEA DEADE"};
  for (std::size_t i = 0; i < printed.size(); ++i) {
    const std::string name = "ngram_c_" + std::to_string(i + 1);
    EXPECT_EQ(sequence(loadRoute(routeFile(name))), withoutBlanks(printed[i]));
    expectDirectLegs(name);
  }
}

// The corridors of layout A that meet in one point.
TEST(Table41, SequenceAFitsFourLoopsAroundACrossing) {
  const std::vector<std::string> junctions{"ADE", "ABF", "BCG", "CDH", "EFGH"};
  const std::string s = sequence(loadRoute(routeFile("ngram_a")));
  int before = -1;
  for (std::size_t i = 1; i < s.size(); ++i) {
    int joint = -1;
    for (std::size_t k = 0; k < junctions.size(); ++k) {
      const bool meets = junctions[k].find(s[i - 1]) != std::string::npos &&
                         junctions[k].find(s[i]) != std::string::npos;
      if (meets) joint = static_cast<int>(k);
    }
    ASSERT_GE(joint, 0) << "step " << i << ": " << s[i - 1] << s[i];
    ASSERT_NE(joint, before) << "turns back in " << s[i - 1];
    before = joint;
  }
}

TEST(Table41, RouteBIsTheSequenceAsPrinted) {
  const std::string printed = withoutBlanks(kTable41B);
  EXPECT_EQ(printed.size(), 225U);
  EXPECT_EQ(sequence(loadRoute(routeFile("ngram_b"))), printed);
}

TEST(Table41, EveryStepOfAIsADirectCorridor) {
  expectDirectLegs("ngram_a");
}
TEST(Table41, EveryStepOfBIsADirectCorridor) {
  expectDirectLegs("ngram_b");
}

}  // namespace
}  // namespace hyselam_sim
