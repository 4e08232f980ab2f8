// Poses, grid geometry, interpolation, random numbers.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "hyselam_common/coarsen.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/occupancy_grid.hpp"
#include "hyselam_common/rng.hpp"
#include "hyselam_common/robot_log.hpp"

#ifdef HYSELAM_HAVE_RAPIDCHECK
#include "hyselam_common/testing/properties.hpp"
#endif

namespace hyselam {
namespace {

::testing::AssertionResult near(const Pose2& a, const Pose2& b, double tolerance) {
  if (distance(a, b) <= tolerance && std::abs(normalizeAngle(a.theta - b.theta)) <= tolerance) {
    return ::testing::AssertionSuccess();
  }
  return ::testing::AssertionFailure() << "(" << a.x << ", " << a.y << ", " << a.theta << ") and ("
                                       << b.x << ", " << b.y << ", " << b.theta << ")";
}

TEST(Pose2, ComposesAsDrawn) {
  // One metre ahead of a robot at (1, 2) that looks along +y.
  EXPECT_TRUE(near(Pose2{1, 2, kPi / 2} * Pose2{1, 0, kPi / 2}, Pose2{1, 3, kPi}, 1e-12));
  EXPECT_TRUE(near(between({1, 2, kPi / 2}, {1, 3, kPi}), Pose2{1, 0, kPi / 2}, 1e-12));
}

TEST(Pose2, AnglesAreWrappedToHalfOpenInterval) {
  EXPECT_DOUBLE_EQ(normalizeAngle(kPi), kPi);
  EXPECT_DOUBLE_EQ(normalizeAngle(-kPi), kPi);
  EXPECT_NEAR(normalizeAngle(3.5 * kPi), -0.5 * kPi, 1e-12);
  EXPECT_TRUE(std::isnan(normalizeAngle(std::numeric_limits<double>::infinity())));
}

#ifdef HYSELAM_HAVE_RAPIDCHECK
using testing::anyPose;

RC_GTEST_PROP(Pose2, IsAGroup, ()) {
  const Pose2 a = *anyPose(), b = *anyPose(), c = *anyPose();
  RC_ASSERT(near((a * b) * c, a * (b * c), 1e-9));
  RC_ASSERT(near(a * a.inverse(), Pose2{}, 1e-9));
  RC_ASSERT(near(a * Pose2{}, a, 1e-12));
  RC_ASSERT(near(a * between(a, b), b, 1e-9));
}

RC_GTEST_PROP(Pose2, MovesPointsAsItMovesPoses, ()) {
  const Pose2 a = *anyPose(), b = *anyPose();
  const Point2 p{b.x, b.y};
  RC_ASSERT(std::hypot((a * p).x - (a * b).x, (a * p).y - (a * b).y) < 1e-9);
}

RC_GTEST_PROP(GridGeometry, CentreLiesInItsCellUnderAnyOrigin, ()) {
  GridGeometry g;
  g.width = *rc::gen::inRange(1, 2000);
  g.height = *rc::gen::inRange(1, 2000);
  g.resolution = *testing::between(0.01, 1.0);
  g.origin = *anyPose();
  const Cell c{*rc::gen::inRange(-50, 2050), *rc::gen::inRange(-50, 2050)};
  RC_ASSERT(g.cellAt(g.center(c)) == c);
  if (g.contains(c)) RC_ASSERT(g.index(c) < g.cellCount());
}

RC_GTEST_PROP(Interpolate, TurnsTheShorterWay, ()) {
  const Pose2 a = *anyPose(), b = *anyPose();
  const Pose2 middle = interpolate(a, b, 0.5);
  const double turn = std::abs(normalizeAngle(b.theta - a.theta));
  RC_ASSERT(std::abs(std::abs(normalizeAngle(middle.theta - a.theta)) - turn / 2.0) < 1e-9);
  RC_ASSERT(near(interpolate(a, b, 0.0), a, 1e-12));
  RC_ASSERT(near(interpolate(a, b, 1.0), b, 1e-9));
}
#endif

TEST(PoseAt, InterpolatesInsideAndHoldsWithinTolerance) {
  const std::vector<StampedPose2> t{{1.0, {0, 0, radians(170)}}, {2.0, {2, 4, radians(-170)}}};
  EXPECT_TRUE(near(*poseAt(t, 1.5), {1, 2, kPi}, 1e-12));
  EXPECT_TRUE(near(*poseAt(t, 2.0), t[1].pose, 0.0));
  EXPECT_FALSE(poseAt(t, 0.99));
  EXPECT_FALSE(poseAt(t, 2.01));
  EXPECT_TRUE(near(*poseAt(t, 0.95, 0.1), t[0].pose, 0.0));
  EXPECT_TRUE(near(*poseAt(t, 2.05, 0.1), t[1].pose, 0.0));
  EXPECT_FALSE(poseAt(t, 2.11, 0.1));
}

TEST(PoseAt, EmptyTrajectoryAndNoTimeGiveNothing) {
  EXPECT_FALSE(poseAt({}, 1.0, 10.0));
  EXPECT_FALSE(poseAt({{1.0, {}}}, std::numeric_limits<double>::quiet_NaN(), 10.0));
}

TEST(Rng, GivesTheSameNumbersOnEveryMachine) {
  EXPECT_EQ(splitmix64(0), 0xe220a8397b1dcdafULL);  // first output of the published SplitMix64
  Rng rng(7), copy = rng, other(7, 1);
  const double first = rng.uniform();
  EXPECT_EQ(first, copy.uniform());
  EXPECT_NE(first, other.uniform());
}

TEST(Rng, HasTheStatisticsItClaims) {
  Rng rng(1);
  constexpr int kDraws = 200000;
  double sum = 0, square = 0, uniform = 0;
  int counts[6] = {};
  for (int i = 0; i < kDraws; ++i) {
    const double g = rng.gaussian(2.0, 3.0);
    sum += g;
    square += (g - 2.0) * (g - 2.0);
    const double u = rng.uniform(-1.0, 1.0);
    ASSERT_GE(u, -1.0);
    ASSERT_LT(u, 1.0);
    uniform += u;
    ++counts[rng.below(6)];
  }
  // Five standard errors of the mean and of the variance.
  EXPECT_NEAR(sum / kDraws, 2.0, 5 * 3.0 / std::sqrt(kDraws));
  EXPECT_NEAR(square / kDraws, 9.0, 5 * 9.0 * std::sqrt(2.0 / kDraws));
  EXPECT_NEAR(uniform / kDraws, 0.0, 5 * 0.58 / std::sqrt(kDraws));
  for (const int c : counts) EXPECT_NEAR(c, kDraws / 6.0, 5 * std::sqrt(kDraws / 6.0));
}

TEST(Coarsen, keepsThinWallsAndPlaces) {
  GridGeometry g;
  g.width = 5;
  g.height = 4;
  g.resolution = 0.05;
  g.origin = {1.0, -2.0, 0.5};
  OccupancyGrid map(g);
  map.at({0, 0}) = 0;
  map.at({1, 1}) = 100;  // one cell of four
  map.at({2, 0}) = 30;
  map.at({4, 3}) = 0;  // in a block that reaches over the edge
  const OccupancyGrid coarse = coarsen(map, coarseningFactor(g.resolution, 0.1));
  ASSERT_EQ(coarse.geometry.width, 3);
  ASSERT_EQ(coarse.geometry.height, 2);
  EXPECT_DOUBLE_EQ(coarse.geometry.resolution, 0.1);
  EXPECT_EQ(coarse.cells, (std::vector<std::int8_t>{100, 30, -1, -1, -1, 0}));
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 5; ++x)
      EXPECT_EQ(coarse.geometry.cellAt(g.center({x, y})), (Cell{x / 2, y / 2}));
  EXPECT_EQ(coarsen(map, 1).cells, map.cells);
  EXPECT_THROW(coarsen(map, 0), ParameterError);
  EXPECT_EQ(coarseningFactor(0.05, 0.1), 2);
  EXPECT_EQ(coarseningFactor(0.1, 0.1), 1);
  EXPECT_EQ(coarseningFactor(0.2, 0.1), 1);
}

}  // namespace
}  // namespace hyselam
