// Whole runs: repeatability, doors, teleports, people, and routes that cannot be driven.
#include <gtest/gtest.h>

#include <fstream>
#include <opencv2/core.hpp>
#include <sstream>
#include <thread>

#include "hyselam_common/errors.hpp"
#include "hyselam_sim/data.hpp"
#include "hyselam_sim/simulation.hpp"

namespace hyselam_sim {
namespace {

const FloorPlan& small() {
  static const FloorPlan plan = loadFloorPlan(planFile("small"));
  return plan;
}

Route route(const std::string& rest) {
  return parseRoute("route: test\n" + rest, "test.yaml");
}

bool equal(const hyselam::RobotLog& a, const hyselam::RobotLog& b) {
  const auto same = [](const std::vector<hyselam::StampedPose2>& x,
                       const std::vector<hyselam::StampedPose2>& y) {
    return std::equal(x.begin(), x.end(), y.begin(), y.end(), [](const auto& p, const auto& q) {
      return p.stamp == q.stamp && p.pose.x == q.pose.x && p.pose.y == q.pose.y &&
             p.pose.theta == q.pose.theta;
    });
  };
  return same(a.odometry, b.odometry) && same(a.ground_truth, b.ground_truth) &&
         std::equal(a.scans.begin(), a.scans.end(), b.scans.begin(), b.scans.end(),
                    [](const auto& x, const auto& y) {
                      return x.stamp == y.stamp && x.ranges == y.ranges;
                    });
}

TEST(Simulation, RatesStampsAndStart) {
  const Simulation run = simulate(small(), loadRoute(routeFile("small")), 1);
  ASSERT_GT(run.log.scans.size(), 100U);
  EXPECT_EQ(run.log.odometry.size(), run.log.ground_truth.size());
  EXPECT_NEAR(static_cast<double>(run.log.odometry.size()) / run.log.scans.size(), 2.0, 0.02);
  EXPECT_DOUBLE_EQ(run.log.scans[0].stamp, 1.0);
  EXPECT_NEAR(run.log.scans[1].stamp, 1.1, 1e-12);
  EXPECT_EQ(run.log.odometry[0].pose.x, 0.0);
  EXPECT_EQ(run.log.ground_truth[0].pose.x, 1.5);
  ASSERT_EQ(run.visits.size(), 2U);
  for (std::size_t i = 1; i < run.log.ground_truth.size(); ++i) {
    const auto& a = run.log.ground_truth[i - 1];
    const auto& b = run.log.ground_truth[i];
    EXPECT_LT(a.stamp, b.stamp);
    EXPECT_LE(hyselam::distance(a.pose, b.pose), 0.5 * 0.05 + 1e-9);
  }
}

TEST(Simulation, SameSeedSameLogOtherSeedOtherLog) {
  const Route r = loadRoute(routeFile("small"));
  const Simulation a = simulate(small(), r, 7), b = simulate(small(), r, 7),
                   c = simulate(small(), r, 8);
  EXPECT_TRUE(equal(a.log, b.log));
  EXPECT_FALSE(equal(a.log, c.log));
}

TEST(Simulation, SameLogOnAnyNumberOfThreads) {
  const Route r = loadRoute(routeFile("mcl_c"));
  const FloorPlan plan = loadFloorPlan(planFile("mcl_c"));
  const int before = cv::getNumThreads();
  cv::setNumThreads(1);
  const Simulation alone = simulate(plan, r, 3);
  cv::setNumThreads(before);
  std::vector<Simulation> runs(4);
  std::vector<std::thread> threads;
  for (Simulation& run : runs) threads.emplace_back([&] { run = simulate(plan, r, 3); });
  for (std::thread& thread : threads) thread.join();
  for (const Simulation& run : runs) EXPECT_TRUE(equal(alone.log, run.log));
}

TEST(Simulation, LaserNoiseDoesNotChangeTheOdometry) {
  const Route r = loadRoute(routeFile("small"));
  SimulationParams noisy;
  noisy.laser.sigma = 0.2;
  const Simulation a = simulate(small(), r, 7), b = simulate(small(), r, 7, noisy);
  ASSERT_EQ(a.log.odometry.size(), b.log.odometry.size());
  EXPECT_EQ(a.log.odometry.back().pose.x, b.log.odometry.back().pose.x);
}

TEST(Simulation, ShutDoorIsSeenAtItsTimes) {
  // Standing before the door, looking through it: shut from 60 s to 90 s.
  const Simulation run =
      simulate(small(), route("start: {at: [2.0, 2.0], heading: 0}\nsteps: [{wait: 120}]\n"), 1);
  for (const hyselam::LaserScan& scan : run.log.scans) {
    const double t = scan.stamp - 1.0;
    const float ahead = scan.ranges[90];
    if (ahead >= scan.range_max) continue;  // a dropout
    if (t < 60.0 || t >= 90.0) {
      EXPECT_NEAR(ahead, 8.0 - 0.1 - 2.1, 0.06) << t;
    } else {
      EXPECT_NEAR(ahead, 4.0 - 0.025 - 2.1, 0.06) << t;
    }
  }
}

TEST(Simulation, DoorsTakeOnTheConfigurationOfTheStep) {
  const FloorPlan plan = loadFloorPlan(planFile("university"));
  // Before the door of room n2, 1.5 m from it.
  const Simulation run = simulate(plan,
                                  route("start: {at: [6.5, 17.6], heading: 90}\ndoors: E_C5\n"
                                        "steps: [{wait: 10}, {wait: 10, doors: E_0}, "
                                        "{wait: 10, doors: E_B2}]\n"),
                                  1);
  for (const hyselam::LaserScan& scan : run.log.scans) {
    const double t = scan.stamp - 1.0;
    const float ahead = scan.ranges[90];
    if (ahead >= scan.range_max) continue;  // a dropout
    EXPECT_NEAR(ahead, (t <= 10.0 || t > 20.0 ? 23.9 : 19.175) - 17.7, 0.06) << t;
  }
}

TEST(Simulation, TeleportMovesTheTruthButNotTheOdometry) {
  const Simulation run = simulate(small(),
                                  route("start: {at: left room, heading: 0}\nsteps:\n"
                                        "  - [2.5, 2]\n"
                                        "  - {teleport: right room, heading: 180}\n"
                                        "  - {wait: 1}\n"),
                                  1);
  ASSERT_EQ(run.teleport_stamps.size(), 1U);
  int jumps = 0;
  for (std::size_t i = 1; i < run.log.ground_truth.size(); ++i) {
    const double truth =
        hyselam::distance(run.log.ground_truth[i - 1].pose, run.log.ground_truth[i].pose);
    const double odometry =
        hyselam::distance(run.log.odometry[i - 1].pose, run.log.odometry[i].pose);
    EXPECT_LT(odometry, 0.03);
    if (truth > 0.5) {
      ++jumps;
      EXPECT_DOUBLE_EQ(run.log.ground_truth[i].stamp, run.teleport_stamps[0]);
      EXPECT_EQ(odometry, 0.0);
    }
  }
  EXPECT_EQ(jumps, 1);
  EXPECT_NEAR(run.log.ground_truth.back().pose.x, 6.0, 1e-9);
  EXPECT_NEAR(std::abs(run.log.ground_truth.back().pose.theta), hyselam::kPi, 1e-9);
  EXPECT_NEAR(run.distance, 1.0, 0.1);
}

TEST(Simulation, KidnapRouteOfScenarioAHasTenTeleports) {
  const Simulation run =
      simulate(loadFloorPlan(planFile("mcl_a")), loadRoute(routeFile("mcl_a_kidnap")), 1);
  EXPECT_EQ(run.teleport_stamps.size(), 10U);
}

TEST(Simulation, OdometryDriftsButNotMuch) {
  const Simulation run =
      simulate(loadFloorPlan(planFile("mcl_b")), loadRoute(routeFile("mcl_b")), 1);
  const Pose2 start = run.log.ground_truth.front().pose;
  double worst = 0.0;
  for (std::size_t i = 0; i < run.log.odometry.size(); ++i) {
    worst = std::max(
        worst, hyselam::distance(start * run.log.odometry[i].pose, run.log.ground_truth[i].pose));
  }
  EXPECT_GT(worst, 0.5);   // or there would be nothing to correct
  EXPECT_LT(worst, 30.0);  // over 200 m
}

TEST(Simulation, RepeatRunsStepsAgain) {
  const Route r = route("start: left room\nsteps: [{repeat: 2, steps: [right room, left room]}]\n");
  EXPECT_EQ(r.steps.size(), 4U);
  EXPECT_EQ(simulate(small(), r, 1).visits.size(), 4U);
}

TEST(Simulation, VisitsTellWhenAPlaceIsReached) {
  const Simulation run = simulate(small(), loadRoute(routeFile("small")), 1);
  const auto at = hyselam::poseAt(run.log.ground_truth, run.visits[0].stamp);
  ASSERT_TRUE(at);
  EXPECT_NEAR(at->x, 6.0, 0.1);
  EXPECT_NEAR(at->y, 2.6, 0.1);
}

TEST(People, WalkAsTold) {
  Person person;
  person.points = {{0, 0}, {10, 0}};
  person.speed = 2.0;
  EXPECT_DOUBLE_EQ(person.at(2.0)->x, 4.0);
  EXPECT_DOUBLE_EQ(person.at(7.0)->x, 6.0);  // on the way back
  person.mode = Person::Mode::kOnce;
  person.start_time = 1.0;
  EXPECT_FALSE(person.at(0.5));
  EXPECT_DOUBLE_EQ(person.at(2.0)->x, 2.0);
  EXPECT_FALSE(person.at(6.5));
  person.mode = Person::Mode::kLoop;
  person.points = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  EXPECT_NEAR(person.at(1.0 + 1.75)->y, 0.5, 1e-12);  // 3.5 m round
  EXPECT_NEAR(person.at(1.0 + 1.75)->x, 0.0, 1e-12);
}

TEST(People, AreSeenAndKeepOffTheRobot) {
  const std::string standing = "start: {at: [1.0, 2.0], heading: 0}\nsteps: [{wait: 6}]\n";
  const Simulation alone = simulate(small(), route(standing), 1);
  const Simulation busy = simulate(
      small(), route(standing + "people: [{points: [[3.5, 2], [0.6, 2]], speed: 0.5}]\n"), 1);
  ASSERT_EQ(alone.log.scans.size(), busy.log.scans.size());
  double nearest = 1e9;
  for (const auto& scan : busy.log.scans) nearest = std::min<double>(nearest, scan.ranges[90]);
  EXPECT_LT(nearest, 0.6);
  EXPECT_GT(nearest, 0.75 - 0.25 - 0.1 - 0.06);  // personal space - radius - mount - noise
}

TEST(Readme, ExamplesOfBothFormatsWork) {
  std::ifstream in(HYSELAM_PACKAGE_DIR "/README.md");
  std::stringstream text;
  text << in.rdbuf();
  std::vector<std::string> examples;
  for (std::size_t at = 0; (at = text.str().find("```yaml\n", at)) != std::string::npos;) {
    at += 8;
    examples.push_back(text.str().substr(at, text.str().find("```", at) - at));
  }
  ASSERT_EQ(examples.size(), 2U);
  const Route r = parseRoute(examples[1], "README.md");
  EXPECT_EQ(simulate(parseFloorPlan(examples[0], "README.md"), r, 1).visits.size(), r.steps.size());
}

// ---- routes that cannot be read or driven
struct BadRoute {
  const char* name;
  const char* text;
  const char* expected;
};

class BadRouteTest : public testing::TestWithParam<BadRoute> {};

TEST_P(BadRouteTest, IsRefusedNamingThePlace) {
  try {
    simulate(small(), route(GetParam().text), 1);
    FAIL() << "was accepted";
  } catch (const hyselam::InputError& e) {
    const std::string message = e.what();
    EXPECT_EQ(message.rfind("test.yaml", 0), 0U) << message;
    EXPECT_NE(message.find(GetParam().expected), std::string::npos) << message;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Route, BadRouteTest,
    testing::Values(
        BadRoute{"BrokenYaml", "start: {at: [1, 1]\n", "not YAML"},
        BadRoute{"UnknownKey", "begin: left room\nsteps: [right room]\n", "unknown key"},
        BadRoute{"NoStart", "steps: [right room]\n", "'start': missing"},
        BadRoute{"NoSteps", "start: left room\nsteps: []\n", "at least one step"},
        BadRoute{"StepsMissing", "start: left room\n", "'steps': missing"},
        BadRoute{"UnknownPlace", "start: left room\nsteps: [rigth room]\n",
                 "did you mean 'right room'?"},
        BadRoute{"UnknownStart", "start: lift room\nsteps: [right room]\n",
                 "did you mean 'left room'?"},
        BadRoute{"StartInsideAWall", "start: [4, 0.5]\nsteps: [left room]\n", "wall 'middle'"},
        BadRoute{"StartInsideFurniture", "start: [6.8, 1.0]\nsteps: [left room]\n",
                 "furniture 'table'"},
        BadRoute{"StartOutside", "start: [-0.45, 4.45]\nsteps: [left room]\n",
                 "outside the building"},
        BadRoute{"BlockedByAWall", "start: [1.5, 1]\nsteps: [[6, 1]]\n", "by wall 'middle'"},
        BadRoute{"BlockedByFurniture", "start: [5, 1]\nsteps: [[7.6, 1]]\n",
                 "by furniture 'table'"},
        BadRoute{"LegIsNamed", "start: [1.5, 1]\nsteps: [[6, 1]]\n",
                 "steps[0]', leg from [1.5, 1] to [6, 1]"},
        BadRoute{"ThroughAClosedDoor", "start: left room\nsteps: [{wait: 61}, right room]\n",
                 "closed door 'door'"},
        BadRoute{"DoorShutsBeforeTheRobot",
                 "start: left room\nspeed: 0.05\nsteps: [{wait: 20}, right room]\n",
                 "the robot hits door 'door'"},
        BadRoute{"UnknownConfiguration", "start: left room\nsteps: [{wait: 1, doors: shut}]\n",
                 "steps[0]'"},
        BadRoute{"UnknownFirstConfiguration", "start: left room\ndoors: shut\nsteps: [{wait: 1}]\n",
                 "key 'doors'"},
        BadRoute{"ConfigurationOfARepeat",
                 "start: left room\nsteps: [{repeat: 2, doors: shut, steps: [{wait: 1}]}]\n",
                 "goes with 'go'"},
        BadRoute{"TeleportIntoAWall", "start: left room\nsteps: [{teleport: [8, 2]}]\n",
                 "does not fit"},
        BadRoute{"NanWaypoint", "start: left room\nsteps: [[.nan, 2]]\n", "finite"},
        BadRoute{"WaypointOfThree", "start: left room\nsteps: [[1, 2, 3]]\n", "point [x, y]"},
        BadRoute{"TwoKindsOfStep", "start: left room\nsteps: [{wait: 1, go: right room}]\n",
                 "exactly one of"},
        BadRoute{"NegativeWait", "start: left room\nsteps: [{wait: -1}]\n", "must be within"},
        BadRoute{"SpeedTooHigh", "start: left room\nspeed: 3\nsteps: [right room]\n",
                 "must be within"},
        BadRoute{"EndlessRepeat",
                 "start: left room\nsteps: [{repeat: 1000, steps: [{repeat: 1000, steps: "
                 "[right room, left room]}]}]\n",
                 "too many steps"},
        BadRoute{"TooLong", "start: left room\nsteps: [{wait: 1e6}]\n", "takes longer"},
        BadRoute{"PersonThroughAWall",
                 "start: left room\nsteps: [{wait: 1}]\npeople: [{points: [[1, 1], [6, 1]]}]\n",
                 "goes through a wall"},
        BadRoute{"PersonWithOnePoint",
                 "start: left room\nsteps: [{wait: 1}]\npeople: [{points: [[1, 1]]}]\n",
                 "at least 2 points"},
        BadRoute{"PersonUnknownMode",
                 "start: left room\nsteps: [{wait: 1}]\n"
                 "people: [{points: [[1, 1], [2, 1]], mode: petrol}]\n",
                 "did you mean 'patrol'?"}),
    [](const testing::TestParamInfo<BadRoute>& tested) { return std::string(tested.param.name); });

TEST(BadSimulation, NoDirectWay) {
  const FloorPlan plan = loadFloorPlan(planFile("ngram_b"));
  try {
    simulate(plan, route("start: A\ndirect: true\nsteps: [L]\n"), 1);
    FAIL() << "was accepted";
  } catch (const hyselam::InputError& e) {
    EXPECT_NE(std::string(e.what()).find("without passing another place"), std::string::npos);
  }
}

TEST(BadSimulation, BadParameters) {
  const Route r = loadRoute(routeFile("small"));
  const auto refused = [&](auto change) {
    SimulationParams params;
    change(params);
    EXPECT_THROW(simulate(small(), r, 1, params), hyselam::ParameterError);
  };
  refused([](SimulationParams& p) { p.scan_rate = 0.0; });
  refused([](SimulationParams& p) { p.scan_rate = 50.0; });
  refused([](SimulationParams& p) { p.odometry_rate = -1.0; });
  refused([](SimulationParams& p) { p.start_time = 0.0; });
  refused([](SimulationParams& p) { p.follower.speed = 5.0; });
  refused([](SimulationParams& p) { p.laser.range_max = 0.0; });
  refused([](SimulationParams& p) { p.planner.spacing = 0.0; });
}

}  // namespace
}  // namespace hyselam_sim
