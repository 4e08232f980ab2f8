// Maps from scans with known poses, in worlds small enough to check by hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/occupancy_mapper.hpp"
#include "hyselam_common/rng.hpp"

namespace hyselam {
namespace {

OccupancyMapperParams coarse() {
  OccupancyMapperParams p;
  p.resolution = 0.1;
  p.min_observations = 1;
  return p;
}

LaserScan scanOf(std::vector<float> ranges, double angle_min = 0.0,
                 double increment = radians(1.0)) {
  LaserScan scan;
  scan.angle_min = angle_min;
  scan.angle_increment = increment;
  scan.range_min = 0.05;
  scan.range_max = 10.0;
  scan.ranges = std::move(ranges);
  return scan;
}

std::int8_t valueAt(const OccupancyGrid& grid, double x, double y) {
  return grid.valueOr(grid.geometry.cellAt({x, y}));
}

TEST(OccupancyMapper, OneBeamClearsItsWayAndMarksItsEnd) {
  OccupancyMapper mapper(coarse());
  mapper.insert({0.05, 0.05, 0.0}, scanOf({1.0F}));
  const OccupancyGrid grid = mapper.grid();
  for (double x = 0.05; x < 1.0; x += 0.1) EXPECT_EQ(valueAt(grid, x, 0.05), 0) << x;
  EXPECT_EQ(valueAt(grid, 1.05, 0.05), 100);
  EXPECT_EQ(valueAt(grid, 1.15, 0.05), -1);
  EXPECT_EQ(valueAt(grid, 0.55, 0.15), -1);
  EXPECT_EQ(grid.geometry.width, 11 + 4);
  EXPECT_EQ(grid.geometry.height, 1 + 4);
}

TEST(OccupancyMapper, TheLasersPlaceOnTheRobotCounts) {
  OccupancyMapper mapper(coarse());
  LaserScan scan = scanOf({1.0F});
  scan.laser_in_base = {0.5, 0.0, kPi / 2};    // looks to the left
  mapper.insert({0.05, 0.05, kPi / 2}, scan);  // the robot looks along +y, the laser along -x
  EXPECT_EQ(valueAt(mapper.grid(), -0.95, 0.55), 100);
}

TEST(OccupancyMapper, ReadingsThatSayNothingChangeNothing) {
  OccupancyMapper mapper(coarse());
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float inf = std::numeric_limits<float>::infinity();
  mapper.insert({}, scanOf({nan, -inf, 0.0F, -1.0F, inf, 10.0F, 50.0F}));
  EXPECT_EQ(mapper.scanCount(), 1U);
  EXPECT_EQ(mapper.grid().cells, std::vector<std::int8_t>{-1});
}

TEST(OccupancyMapper, NoReturnClearsAsFarAsTold) {
  auto parameters = coarse();
  parameters.no_return_clears = 2.0;
  OccupancyMapper mapper(parameters);
  mapper.insert({0.05, 0.05, 0}, scanOf({std::numeric_limits<float>::infinity()}));
  EXPECT_EQ(valueAt(mapper.grid(), 1.95, 0.05), 0);
  EXPECT_EQ(valueAt(mapper.grid(), 2.25, 0.05), -1);
}

TEST(OccupancyMapper, FarReturnsOnlyClear) {
  auto parameters = coarse();
  parameters.usable_range = 3.0;
  OccupancyMapper mapper(parameters);
  mapper.insert({0.05, 0.05, 0}, scanOf({5.0F}));
  const OccupancyGrid grid = mapper.grid();
  EXPECT_EQ(valueAt(grid, 2.95, 0.05), 0);
  EXPECT_EQ(valueAt(grid, 5.05, 0.05), -1);
  for (const auto v : grid.cells) EXPECT_NE(v, 100);
}

TEST(OccupancyMapper, HitsAndMissesAreWeighed) {
  auto parameters = coarse();
  parameters.occupied_ratio = 0.5;
  OccupancyMapper mapper(parameters);
  mapper.insert({0.05, 0.05, 0}, scanOf({1.0F}));
  EXPECT_EQ(valueAt(mapper.grid(), 1.05, 0.05), 100);
  mapper.insert({0.05, 0.05, 0}, scanOf({2.0F}));  // passes the same cell: 1 of 2 is not above 0.5
  EXPECT_EQ(valueAt(mapper.grid(), 1.05, 0.05), 0);
}

TEST(OccupancyMapper, CellsSeenTooRarelyStayUnknown) {
  auto parameters = coarse();
  parameters.min_observations = 2;
  OccupancyMapper mapper(parameters);
  mapper.insert({0.05, 0.05, 0}, scanOf({1.0F}));
  EXPECT_EQ(valueAt(mapper.grid(), 0.55, 0.05), -1);
  mapper.insert({0.05, 0.05, 0}, scanOf({1.0F}));
  EXPECT_EQ(valueAt(mapper.grid(), 0.55, 0.05), 0);
}

/// A square room, ray cast exactly: every wall cell found, everything inside free.
TEST(OccupancyMapper, RecoversARoomFromManyPosesAndGrows) {
  constexpr double kHalf = 4.02;  // walls at +-4.02, inside the cells [4.0, 4.1) and [-4.1, -4.0)
  OccupancyMapper mapper(coarse());
  Rng rng(2);
  for (int k = 0; k < 200; ++k) {
    const Pose2 pose{rng.uniform(-3.5, 3.5), rng.uniform(-3.5, 3.5), rng.uniform(-kPi, kPi)};
    std::vector<float> ranges;
    for (int i = 0; i < 720; ++i) {
      const double a = pose.theta + radians(0.5) * i;
      const double to_x = (std::cos(a) > 0 ? kHalf - pose.x : -kHalf - pose.x) / std::cos(a);
      const double to_y = (std::sin(a) > 0 ? kHalf - pose.y : -kHalf - pose.y) / std::sin(a);
      ranges.push_back(static_cast<float>(std::min(to_x, to_y)));
    }
    mapper.insert(pose, scanOf(ranges, 0.0, radians(0.5)));
  }
  const OccupancyGrid grid = mapper.grid();
  EXPECT_EQ(grid.geometry.width, 82 + 4);
  for (double s = -3.95; s < 4.0; s += 0.1) {
    EXPECT_EQ(valueAt(grid, s, 4.05), 100) << s;
    EXPECT_EQ(valueAt(grid, s, -4.05), 100) << s;
    EXPECT_EQ(valueAt(grid, 4.05, s), 100) << s;
    EXPECT_EQ(valueAt(grid, -4.05, s), 100) << s;
    for (double t = -3.95; t < 4.0; t += 0.1) ASSERT_EQ(valueAt(grid, s, t), 0) << s << " " << t;
  }
}

TEST(OccupancyMapper, GrowthInAnyDirectionKeepsWhatWasSeen) {
  for (const Point2 far : {Point2{-60, 0}, Point2{60, 0}, Point2{0, -60}, Point2{0, 60}}) {
    OccupancyMapper mapper(coarse());
    mapper.insert({0.05, 0.05, 0}, scanOf({1.0F}));
    mapper.insert({far.x + 0.05, far.y + 0.05, 0}, scanOf({1.0F}));
    const OccupancyGrid grid = mapper.grid();
    for (const Point2 at : {Point2{0, 0}, far}) {
      EXPECT_EQ(valueAt(grid, at.x + 0.55, at.y + 0.05), 0);
      EXPECT_EQ(valueAt(grid, at.x + 1.05, at.y + 0.05), 100);
      EXPECT_EQ(valueAt(grid, at.x + 1.15, at.y + 0.05), -1);
    }
    EXPECT_EQ(std::count(grid.cells.begin(), grid.cells.end(), 100), 2);
  }
}

TEST(OccupancyMapper, OrderOfScansDoesNotMatter) {
  Rng rng(9);
  std::vector<std::pair<Pose2, LaserScan>> scans;
  for (int k = 0; k < 50; ++k) {
    std::vector<float> ranges;
    for (int i = 0; i < 181; ++i) ranges.push_back(static_cast<float>(rng.uniform(0.0, 12.0)));
    scans.push_back({{rng.uniform(-20, 20), rng.uniform(-20, 20), rng.uniform(-3, 3)},
                     scanOf(ranges, -kPi / 2)});
  }
  OccupancyMapper forward(coarse()), backward(coarse());
  for (const auto& s : scans) forward.insert(s.first, s.second);
  for (auto s = scans.rbegin(); s != scans.rend(); ++s) backward.insert(s->first, s->second);
  EXPECT_EQ(forward.grid().cells, backward.grid().cells);
  EXPECT_EQ(forward.grid().geometry.origin.x, backward.grid().geometry.origin.x);
}

TEST(OccupancyMapper, ClearForgets) {
  OccupancyMapper mapper(coarse());
  mapper.insert({}, scanOf({1.0F}));
  mapper.clear();
  EXPECT_EQ(mapper.scanCount(), 0U);
  EXPECT_EQ(mapper.grid().cells.size(), 1U);
}

TEST(OccupancyMapper, PosesThatAreNoneAndMapsWithoutBoundAreRefused) {
  auto parameters = coarse();
  parameters.max_cells = 1000000;
  OccupancyMapper mapper(parameters);
  EXPECT_THROW(mapper.insert({std::nan(""), 0, 0}, scanOf({1.0F})), InputError);
  mapper.insert({}, scanOf({1.0F}));
  EXPECT_THROW(mapper.insert({1e4, 1e4, 0}, scanOf({1.0F})), std::length_error);
  EXPECT_THROW(mapper.insert({1e30, 0, 0}, scanOf({1.0F})), std::length_error);
  EXPECT_EQ(mapper.scanCount(), 1U);
  EXPECT_EQ(valueAt(mapper.grid(), 1.05, 0.05), 100);
}

TEST(OccupancyMapper, ParametersOutOfRangeAreRefused) {
  const auto refused = [](auto change) {
    OccupancyMapperParams p;
    change(p);
    EXPECT_THROW(OccupancyMapper{p}, ParameterError);
  };
  refused([](auto& p) { p.resolution = 0.0; });
  refused([](auto& p) { p.resolution = std::nan(""); });
  refused([](auto& p) { p.usable_range = -1.0; });
  refused([](auto& p) { p.no_return_clears = -1.0; });
  refused([](auto& p) { p.occupied_ratio = 1.0; });
  refused([](auto& p) { p.min_observations = 0; });
}

}  // namespace
}  // namespace hyselam
