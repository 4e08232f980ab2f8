// SLAM where odometry fails, scans are missing and lasers are not where tf has them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "degrade.hpp"
#include "hyselam_common/trajectory_io.hpp"
#include "hyselam_sim/data.hpp"
#include "hyselam_sim/simulation.hpp"
#include "ngram_slam/slam/laser_mount.hpp"
#include "ngram_slam/slam/slam_engine.hpp"
#include "ngram_slam/slam/slam_score.hpp"
#include "ngram_slam/slam/standing_odometry.hpp"

namespace ngram_slam {
namespace {

using hyselam::LaserScan;
using hyselam::Pose2;
using hyselam::RobotLog;

/// Through an office, with people.
const RobotLog& drive() {
  static const RobotLog log = [] {
    hyselam_sim::SimulationParams params;
    params.scan_rate = 5.0;
    params.odometry.sigma = 0.01;
    return hyselam_sim::simulate(hyselam_sim::loadFloorPlan(hyselam_sim::planFile("office")),
                                 hyselam_sim::loadRoute(hyselam_sim::routeFile("office")), 3,
                                 params)
        .log;
  }();
  return log;
}

RobotLog degraded(const Degradation& how) {
  RobotLog log = drive();
  degrade(how, &log);
  return log;
}

/// Without the cure: scans are matched where odometry tells motion only.
SlamParams trusting() {
  SlamParams params;
  params.odometry_doubt.scan_interval = 0.0;
  params.odometry_doubt.changed_ratio = 1.0;
  params.odometry_doubt.failure_probability = 0.0;
  return params;
}

struct Mapped {
  double error = 0.0;  // rms [m]
  RoughRoad road;
  std::vector<SlamKeyframe> keyframes;
};

Mapped mapped(const RobotLog& log, const SlamParams& params = {}) {
  SlamEngine engine(params);
  for (const LaserScan& scan : log.scans) {
    if (const auto odometry = hyselam::poseAt(log.odometry, scan.stamp, 0.2)) {
      engine.add(scan, *odometry);
    }
    while (const auto job = engine.takeJob()) engine.apply(runJob(*job));
  }
  engine.endRun();
  while (const auto job = engine.takeFinalJob()) engine.apply(runJob(*job));
  return {trajectoryError(engine.trajectory(), log.ground_truth).rms, engine.roughRoad(),
          engine.keyframes()};
}

const Mapped& onASmoothRoad() {
  static const Mapped result = mapped(drive());
  return result;
}

TEST(RoughRoads, doesNothingOnASmoothRoad) {
  const Mapped& m = onASmoothRoad();
  EXPECT_LT(m.error, 0.15);
  EXPECT_LT(m.road.path_unseen, 1.0);
  EXPECT_EQ(m.road.gaps, 0U);
  EXPECT_EQ(m.road.runs_split, 0U);
}

TEST(RoughRoads, survivesWheelsThatStandStillInTheOdometry) {
  Degradation frozen;
  frozen.freeze = "40,5";
  const RobotLog log = degraded(frozen);
  const Mapped without = mapped(log, trusting()), with = mapped(log);
  EXPECT_GT(without.error, 4.0 * onASmoothRoad().error);  // what this is for
  EXPECT_LT(with.error, std::max(0.15, 2.0 * onASmoothRoad().error));
  EXPECT_GT(with.road.path_unseen, 3.0);
  EXPECT_GT(with.road.scans_moved_unseen, 20U);
}

TEST(RoughRoads, standingOdometryIsToldByItsPartOfTheMotion) {
  std::vector<SlamKeyframe> keyframes(2001);
  for (std::size_t k = 0; k < keyframes.size(); ++k) {
    keyframes[k].pose = {0.25 * static_cast<double>(k), 0.0, k % 2 == 0 ? 0.0 : 0.1};
  }
  RoughRoad road;
  road.path_unseen = 2.2;  // as intel has of 509 m
  road.turn_unseen = 2.4;
  EXPECT_FALSE(odometryStands(road, keyframes, 0));
  EXPECT_TRUE(odometryStands(road, keyframes, 1900));  // of the 25 m of the newest session
  road.path_unseen = 25.0;
  EXPECT_TRUE(odometryStands(road, keyframes, 0));
  EXPECT_TRUE(odometryStands(road, {}, 0));
}

TEST(RoughRoads, survivesGapsAndFewScans) {
  Degradation gaps, few;
  gaps.gap = "40,5";
  few.every = 6;
  const Mapped missing = mapped(degraded(gaps));
  EXPECT_LT(missing.error, std::max(0.15, 2.0 * onASmoothRoad().error));
  EXPECT_GT(missing.road.gaps, 3U);
  EXPECT_LT(mapped(degraded(few)).error, std::max(0.15, 2.0 * onASmoothRoad().error));
}

/// Scans of the robot standing at the beginning; `seconds` of them show other ranges.
RobotLog standing(double seconds, float range) {
  RobotLog log;
  for (int i = 0; i < 100; ++i) {
    LaserScan scan = drive().scans.front();
    scan.stamp = 1.0 + 0.2 * i;
    const double since = scan.stamp - 8.0;
    for (std::size_t b = 0; b < scan.ranges.size() && since >= 0.0 && since < seconds; ++b) {
      scan.ranges[b] = range + 0.01F * static_cast<float>(b % 7);
    }
    log.scans.push_back(scan);
    log.odometry.push_back({scan.stamp, Pose2{}});
    log.ground_truth.push_back({scan.stamp, Pose2{}});
  }
  return log;
}

TEST(RoughRoads, waitsForSomebodyWhoStandsInFrontOfTheLaser) {
  const Mapped m = mapped(standing(1.5, 0.4F));
  EXPECT_EQ(m.road.lost, 0U);
  EXPECT_EQ(m.road.runs_split, 0U);
  EXPECT_LT(m.error, 0.05);
}

TEST(RoughRoads, beginsAnotherRunWhereNothingTellsHowTheRobotMoved) {
  const Mapped m = mapped(standing(10.0, 2.5F));
  EXPECT_GE(m.road.lost, 1U);
  EXPECT_GE(m.road.runs_split, 1U);
  EXPECT_GT(m.keyframes.back().run, 0U);
  SlamParams alone;  // without loops nothing would join them again
  alone.loops = LoopClosureMode::kNone;
  const Mapped one = mapped(standing(10.0, 2.5F), alone);
  EXPECT_GE(one.road.lost, 1U);
  EXPECT_EQ(one.road.runs_split, 0U);
  EXPECT_EQ(one.keyframes.back().run, 0U);
}

TEST(RoughRoads, anotherRunBeginsWhereOdometryHasIt) {
  // Not where a scan that does not fit was matched all the same.
  for (const float range : {1.2F, 1.6F, 2.5F, 3.5F}) {
    const Mapped m = mapped(standing(10.0, range));
    const auto first = std::find_if(m.keyframes.begin(), m.keyframes.end(),
                                    [](const SlamKeyframe& k) { return k.run == 1; });
    ASSERT_NE(first, m.keyframes.end()) << range;
    EXPECT_LT(distance(first->pose, m.keyframes.front().pose), 1e-6) << range;
  }
}

TEST(RoughRoads, scansDifferWhenManyRangesChanged) {
  const OdometryDoubtParams params;
  const LaserScan scan = drive().scans.front();
  LaserScan other = scan;
  EXPECT_FALSE(scansDiffer(scan, other, params));
  for (std::size_t b = 0; b < other.ranges.size() / 10; ++b) other.ranges[b] *= 0.5F;
  EXPECT_FALSE(scansDiffer(scan, other, params));  // a person
  for (std::size_t b = 0; b < other.ranges.size() / 2; ++b) other.ranges[b] = 0.3F;
  EXPECT_TRUE(scansDiffer(scan, other, params));
  for (float& r : other.ranges) r = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(scansDiffer(scan, other, params));  // a blind scan says nothing
  other.ranges.pop_back();
  EXPECT_TRUE(scansDiffer(scan, other, params));
}

TEST(LaserMount, isAsToldWhereItIs) {
  const auto mount = estimateLaserMount(onASmoothRoad().keyframes);
  ASSERT_TRUE(mount);
  EXPECT_FALSE(mount->wrong()) << mount->text();
  EXPECT_LT(distance(mount->told, mount->estimated), 0.03);
}

TEST(LaserMount, isFoundWhereItIsToldToBeElsewhere) {
  for (const char* error : {"0.08,0,5", "0,-0.08,-5", "-0.1,0.1,0"}) {
    Degradation beside;
    beside.laser_error = error;
    const Mapped m = mapped(degraded(beside));
    const auto mount = estimateLaserMount(m.keyframes);
    ASSERT_TRUE(mount) << error;
    EXPECT_TRUE(mount->wrong()) << error;
    const Pose2 truth = drive().scans.front().laser_in_base;
    EXPECT_NEAR(mount->estimated.x, truth.x, 0.03) << error;
    EXPECT_NEAR(mount->estimated.y, truth.y, 0.03) << error;
    EXPECT_NEAR(mount->estimated.theta, truth.theta, 0.015) << error;
    EXPECT_NE(mount->text().find("is not where it is told to be"), std::string::npos);
  }
}

TEST(LaserMount, isNotToldByARobotThatHardlyTurned) {
  const auto& all = onASmoothRoad().keyframes;
  EXPECT_FALSE(estimateLaserMount({}));
  EXPECT_FALSE(estimateLaserMount({all.begin(), all.begin() + 20}));
}

}  // namespace
}  // namespace ngram_slam
