// The robot's limits, the statistics of its odometry, and its laser.
#include <gtest/gtest.h>

#include <cmath>

#include "hyselam_common/errors.hpp"
#include "hyselam_sim/laser.hpp"
#include "hyselam_sim/robot.hpp"

namespace hyselam_sim {
namespace {

TEST(Robot, KeepsTheLimitsOfTheDataSheet) {
  DifferentialRobot robot({}, {});
  for (int i = 0; i < 400; ++i) robot.step(99.0, 99.0, 0.05);
  EXPECT_DOUBLE_EQ(robot.speed(), 1.4);
  EXPECT_DOUBLE_EQ(robot.turnRate(), hyselam::radians(300.0));
}

TEST(Robot, AcceleratesGradually) {
  DifferentialRobot robot({}, {});
  robot.step(1.0, 0.0, 0.1);
  EXPECT_DOUBLE_EQ(robot.speed(), 0.05);
}

TEST(Robot, DrivesFullCirclesExactly) {
  hyselam::Pose2 pose;
  for (int i = 0; i < 360; ++i) pose = roll(pose, 0.01, hyselam::radians(1.0));
  EXPECT_NEAR(pose.x, 0.0, 1e-9);
  EXPECT_NEAR(pose.y, 0.0, 1e-9);
  EXPECT_NEAR(pose.theta, 0.0, 1e-9);
}

TEST(Robot, TeleportTurnsNoWheel) {
  DifferentialRobot robot({}, {});
  robot.step(1.0, 0.0, 0.1);
  robot.teleport({5, 6, 1});
  EXPECT_EQ(robot.speed(), 0.0);
  EXPECT_EQ(robot.pose().x, 5.0);
}

TEST(Robot, RefusesImpossibleLimits) {
  RobotParams params;
  params.max_speed = -1.0;
  EXPECT_THROW(DifferentialRobot(params, {}), hyselam::ParameterError);
  OdometryParams odometry;
  odometry.left_scale = 0.0;
  EXPECT_THROW(Odometry(odometry, 0.3, hyselam::Rng(1)), hyselam::ParameterError);
}

TEST(OdometryErrors, NoneWithoutSources) {
  OdometryParams exact{1.0, 1.0, 1.0, 0.0};
  DifferentialRobot robot({}, {});
  Odometry odometry(exact, RobotParams{}.wheel_base, hyselam::Rng(1));
  for (int i = 0; i < 2000; ++i) odometry.update(robot.step(0.5, std::sin(0.01 * i), 0.05));
  EXPECT_NEAR(hyselam::distance(odometry.pose(), robot.pose()), 0.0, 1e-9);
}

TEST(OdometryErrors, SystematicPartIsAsStated) {
  // Straight on: the way grows by the mean scale, the heading by the difference over the base.
  OdometryParams params{1.001, 1.003, 1.01, 0.0};
  Odometry odometry(params, 0.4, hyselam::Rng(1));
  for (int i = 0; i < 100; ++i) odometry.update({0.1, 0.1});
  EXPECT_NEAR(odometry.pose().theta, 10.0 * 0.002 / (0.4 * 1.01), 1e-9);
  // On the spot: a wheel base believed 1 % too wide gives 1 % too little turn.
  Odometry turning({1.0, 1.0, 1.01, 0.0}, 0.4, hyselam::Rng(1));
  for (int i = 0; i < 100; ++i) turning.update({-0.002, 0.002});
  EXPECT_NEAR(turning.pose().theta, 1.0 / 1.01, 1e-9);
}

TEST(OdometryErrors, RandomPartHasMeanZeroAndTheStatedSigma) {
  // 1 m straight in n steps: heading sigma = sqrt(2) sigma / base, way sigma = sigma / sqrt(2),
  // whatever n is.
  const double sigma = 0.002, base = 0.334;
  for (const int steps : {1, 50}) {
    const int draws = 20000;
    double turn = 0, turn2 = 0, way = 0, way2 = 0;
    for (int i = 0; i < draws; ++i) {
      Odometry odometry({1.0, 1.0, 1.0, sigma}, base,
                        hyselam::Rng(static_cast<std::uint64_t>(i), 9));
      for (int k = 0; k < steps; ++k) odometry.update({1.0 / steps, 1.0 / steps});
      turn += odometry.pose().theta;
      turn2 += odometry.pose().theta * odometry.pose().theta;
      way += odometry.pose().x - 1.0;
      way2 += (odometry.pose().x - 1.0) * (odometry.pose().x - 1.0);
    }
    const double turn_sigma = std::sqrt(2.0) * sigma / base, way_sigma = sigma / std::sqrt(2.0);
    // Means within 4 standard errors, standard deviations within 3 % (6 standard errors).
    EXPECT_NEAR(turn / draws, 0.0, 4.0 * turn_sigma / std::sqrt(draws)) << steps;
    EXPECT_NEAR(std::sqrt(turn2 / draws), turn_sigma, 0.03 * turn_sigma) << steps;
    EXPECT_NEAR(way / draws, 0.0, 4.0 * way_sigma / std::sqrt(draws) + turn_sigma * turn_sigma);
    EXPECT_NEAR(std::sqrt(way2 / draws), way_sigma, 0.03 * way_sigma) << steps;
  }
}

// A wall 5 m ahead of the robot's middle, across.
const std::vector<Segment> kWall{{{5, -100}, {5, 100}}};

TEST(Laser, HasTheGeometryOfTheSick) {
  hyselam::Rng rng(1);
  LaserParams params;
  params.sigma = params.dropout = 0.0;
  const hyselam::LaserScan scan = takeScan(params, PlanRayCaster(kWall), {}, {}, 7.0, rng);
  ASSERT_EQ(scan.ranges.size(), 181U);
  EXPECT_DOUBLE_EQ(scan.angle_min, -hyselam::kPi / 2);
  EXPECT_NEAR(scan.angle_increment, hyselam::radians(1.0), 1e-15);
  EXPECT_EQ(scan.stamp, 7.0);
  EXPECT_FLOAT_EQ(scan.ranges[90], 4.9F);  // mounted 0.1 m ahead
  EXPECT_FLOAT_EQ(scan.ranges[0], 30.0F);  // along the wall: nothing
  EXPECT_NEAR(scan.ranges[120], 4.9 / std::cos(hyselam::radians(30.0)), 0.0051);
}

TEST(Laser, RangesAreWholeCentimetresWithTheStatedNoise) {
  hyselam::Rng rng(3);
  LaserParams params;
  params.sigma = 0.03;
  params.dropout = 0.01;
  const PlanRayCaster world(kWall);
  double sum = 0, square = 0;
  int returns = 0, dropped = 0;
  for (int i = 0; i < 20000; ++i) {
    const float r = takeScan(params, world, {}, {}, 0.0, rng).ranges[90];
    if (r >= params.range_max) {
      ++dropped;
      continue;
    }
    EXPECT_NEAR(r * 100.0F, std::round(r * 100.0F), 1e-3);
    ++returns;
    sum += r - 4.9;
    square += (r - 4.9) * (r - 4.9);
  }
  EXPECT_NEAR(dropped / 20000.0, 0.01, 0.003);
  EXPECT_NEAR(sum / returns, 0.0, 0.001);
  // Rounding adds a variance of (1 cm)^2 / 12.
  EXPECT_NEAR(std::sqrt(square / returns), std::sqrt(0.0009 + 1e-4 / 12), 0.0008);
}

TEST(Laser, SeesPeople) {
  hyselam::Rng rng(1);
  LaserParams params;
  params.sigma = params.dropout = 0.0;
  const auto scan = takeScan(params, PlanRayCaster(kWall), {{{3.0, 0.0}, 0.25}}, {}, 0.0, rng);
  EXPECT_FLOAT_EQ(scan.ranges[90], 2.65F);
  EXPECT_GT(scan.ranges[110], 4.0F);
}

TEST(Laser, RefusesImpossibleParameters) {
  hyselam::Rng rng(1);
  const PlanRayCaster world(kWall);
  const auto refused = [&](auto change) {
    LaserParams params;
    change(params);
    EXPECT_THROW(takeScan(params, world, {}, {}, 0.0, rng), hyselam::ParameterError);
  };
  refused([](LaserParams& p) { p.beams = 1; });
  refused([](LaserParams& p) { p.range_max = -1.0; });
  refused([](LaserParams& p) { p.range_max = std::nan(""); });
  refused([](LaserParams& p) { p.sigma = -0.1; });
  refused([](LaserParams& p) { p.dropout = 2.0; });
  refused([](LaserParams& p) { p.field_of_view = 0.0; });
}

}  // namespace
}  // namespace hyselam_sim
