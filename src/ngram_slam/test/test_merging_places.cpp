// What stays apart by loops is tied by places on drawn maps, where only one place is the right one.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "hyselam_common/testing/files.hpp"
#include "hyselam_sim/floor_plan.hpp"
#include "hyselam_sim/route.hpp"
#include "hyselam_sim/simulation.hpp"
#include "ngram_slam/slam/map_merging.hpp"
#include "ngram_slam/slam/slam_state_io.hpp"
#include "visits.hpp"

namespace ngram_slam {
namespace {

using hyselam::Pose2;

/// What stands in a room of 8 x 8 m whose lower left corner is at (x, 3).
std::string furniture(double x) {
  const auto box = [&](const char* name, double dx, const char* rest) {
    return "  - {name: " + std::string(name) + " " + std::to_string(x) + ", box: [" +
           std::to_string(x + dx) + ", " + rest + "], height: 1.5}\n";
  };
  return box("shelf", 1.2, "9.8, 1.6, 0.7, 0") + box("desk", 6.6, "5.0, 0.8, 1.4, 30") +
         box("chest", 4.2, "10.4, 0.6, 0.6, 45");
}

/// A corridor with a room at 2 m of it and one at 28 m, whose doors can be shut.
hyselam_sim::FloorPlan twoRooms(const std::string& what_stands_there) {
  return hyselam_sim::parseFloorPlan(
      "plan: rooms\norigin: [-1, -1]\nsize: [44, 14]\nwall_thickness: 0.2\n"
      "walls:\n"
      "  - {name: corridor, closed: true, points: [[0, 0], [40, 0], [40, 3], [0, 3]]}\n"
      "  - {name: a, points: [[2, 3], [2, 11], [10, 11], [10, 3]]}\n"
      "  - {name: b, points: [[28, 3], [28, 11], [36, 11], [36, 3]]}\n"
      "doors:\n"
      "  - {name: door a, at: [6, 3], width: 1.0}\n"
      "  - {name: door b, at: [32, 3], width: 1.0}\n"
      "configurations:\n"
      "  - {name: open day, open: [door a, door b]}\n"
      "  - {name: shut, open: []}\n"
      "furniture:\n" +
          what_stands_there +
          "places:\n"
          "  - {name: a, at: [6, 6]}\n  - {name: b, at: [32, 6]}\n  - {name: way, at: [20, 1.5]}\n",
      "rooms.yaml");
}

/// The same room beside a wide hall.
hyselam_sim::FloorPlan roomAtHall() {
  return hyselam_sim::parseFloorPlan(
      "plan: rooms\norigin: [-13, -21]\nsize: [40, 34]\nwall_thickness: 0.2\n"
      "walls:\n"
      "  - {name: hall, closed: true, points: [[-12, -20], [14, -20], [14, 3], [-12, 3]]}\n"
      "  - {name: pillar, closed: true, points: [[0, -9], [2, -9], [2, -7], [0, -7]]}\n"
      "  - {name: a, points: [[2, 3], [2, 11], [10, 11], [10, 3]]}\n"
      "doors:\n"
      "  - {name: door a, at: [6, 3], width: 1.0}\n"
      "configurations:\n"
      "  - {name: open day, open: [door a]}\n"
      "furniture:\n" +
          furniture(2.0) + "places:\n  - {name: a, at: [6, 6]}\n  - {name: hall, at: [-6, -5]}\n",
      "rooms.yaml");
}

/// Rounds in the room whose corner is at `x`, from (x + 1, 4.5) back to there.
std::string rounds(double x, int n) {
  std::string steps;
  const auto go = [&](double dx, const char* y) {
    steps += "  - {go: [" + std::to_string(x + dx) + ", " + y + "]}\n";
  };
  for (int i = 0; i < n; ++i) {
    go(4.5, "4.2");
    go(6.8, "8.8");
    go(3.0, "8.5");
    go(1.0, "4.5");
  }
  return steps;
}

hyselam::RobotLog driven(const hyselam_sim::FloorPlan& plan, const std::string& start,
                         const std::string& doors, const std::string& steps, std::uint64_t seed) {
  const auto route =
      hyselam_sim::parseRoute("route: r\nplan: rooms\nstart: {at: " + start +
                                  ", heading: 0}\ndoors: " + doors + "\nsteps:\n" + steps,
                              "route.yaml");
  hyselam_sim::SimulationParams params;
  params.scan_rate = 4.0;
  params.odometry.sigma = 0.02;
  return hyselam_sim::simulate(plan, route, seed, params).log;
}

SlamState mapped(const hyselam::RobotLog& log) {
  return mapOf(log, 0.0, 1.0);
}

constexpr const char* kIntoA = "  - {go: [6, 1.5]}\n  - {go: [6, 5]}\n";
constexpr const char* kOutOfA = "  - {go: [6, 5]}\n  - {go: [6, 1.5]}\n";

/// A whole corridor, with both of its rooms.
SlamState corridor(const std::string& what_stands_there, std::uint64_t seed) {
  return mapped(driven(twoRooms(what_stands_there), "[1, 1.5]", "open day",
                       kIntoA + rounds(2.0, 1) + kOutOfA +
                           "  - {go: [32, 1.5]}\n  - {go: [32, 5]}\n" + rounds(28.0, 1) +
                           "  - {go: [32, 5]}\n  - {go: [32, 1.5]}\n  - {go: [39, 1.5]}\n",
                       seed));
}

/// A robot that never leaves the room behind its shut door.
const hyselam::RobotLog& shutInLog() {
  static const hyselam::RobotLog log =
      driven(twoRooms(furniture(2.0)), "[3, 4.5]", "shut", rounds(2.0, 4), 7);
  return log;
}
const SlamState& shutIn() {
  static const SlamState state = mapped(shutInLog());
  return state;
}

std::string bytesOf(const SlamState& state) {
  const hyselam::testing::TemporaryDirectory d;
  SlamStateFile::save(d / "s.state", state);
  return hyselam::testing::fileBytes(d / "s.state");
}

/// No loops are looked for but a few.
MapMergingParams placesOnly() {
  MapMergingParams params;
  params.place_interval = 2.0;
  params.first_interval = params.second_interval = 1e6;
  params.first_candidates = params.second_candidates = 1;
  params.ask_around = 0.0;
  return params;
}

TEST(MergingPlaces, TieWhatOnlyOnePlaceExplains) {
  // The other room has nothing in it.
  const std::vector<MapSession> both{{"corridor", corridor(furniture(2.0), 3)}, {"room", shutIn()}};
  MapMergingParams params = placesOnly();
  const MergedMaps m = mergeMaps(both, params);
  ASSERT_EQ(m.maps.size(), 1U);
  EXPECT_EQ(m.counters.place_ties, 1);
  EXPECT_GT(m.counters.stretches, 10);
  // In the first room, where the robot was.
  const Pose2 first = m.maps[0].parts[0].trajectory.front().pose;
  for (const hyselam::StampedPose2& p : m.maps[0].parts[1].trajectory) {
    const Pose2 pose = Pose2{1.0, 1.5, 0.0} * between(first, p.pose);
    EXPECT_LT(distance(pose, *hyselam::poseAt(shutInLog().ground_truth, p.stamp, 1.0)), 0.3);
  }
  params.threads = 3;
  const MergedMaps again = mergeMaps(both, params);
  ASSERT_EQ(again.maps.size(), 1U);
  EXPECT_TRUE(bytesOf(again.maps[0].state) == bytesOf(m.maps[0].state));
  params.place_interval = 0.0;
  EXPECT_EQ(mergeMaps(both, params).maps.size(), 2U) << "loops alone would do";
}

TEST(MergingPlaces, WaitWhereTwoPartsOfAMapAreAlike) {
  const MergedMaps m =
      mergeMaps({{"corridor", corridor(furniture(2.0) + furniture(28.0), 3)}, {"room", shutIn()}},
                placesOnly());
  EXPECT_EQ(m.maps.size(), 2U);
  EXPECT_GT(m.counters.stretches, 10);
  EXPECT_EQ(m.counters.place_ties, 0);
}

TEST(MergingPlaces, WaitWhereTwoBuildingsHaveTheSameRoom) {
  const SlamState hall = mapped(driven(roomAtHall(), "[3, 4.5]", "open day",
                                       rounds(2.0, 1) + kOutOfA + "  - {go: [-6, -5]}\n", 5));
  const SlamState other = corridor(furniture(2.0), 3);
  const MergedMaps m =
      mergeMaps({{"corridor", other}, {"hall", hall}, {"room", shutIn()}}, placesOnly());
  EXPECT_EQ(m.maps.size(), 3U);
}

TEST(MergingPlaces, AreRefusedWhereFreeSpaceLiesOverWalls) {
  // Both buildings have the room, beside it one has a corridor and one a hall.
  const SlamState hall = mapped(driven(roomAtHall(), "[3, 4.5]", "open day",
                                       rounds(2.0, 3) + kOutOfA + "  - {go: [-6, -5]}\n", 5));
  const MergedMaps m =
      mergeMaps({{"corridor", corridor(furniture(2.0), 3)}, {"hall", hall}}, placesOnly());
  EXPECT_EQ(m.maps.size(), 2U);
}

}  // namespace
}  // namespace ngram_slam
