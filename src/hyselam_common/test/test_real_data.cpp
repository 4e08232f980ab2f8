// The published logs: counts as their tables state them, maps as large as their buildings.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>

#include "hyselam_common/carmen_log.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/map_io.hpp"
#include "hyselam_common/occupancy_mapper.hpp"
#include "hyselam_common/ros/bag_io.hpp"
#include "hyselam_common/testing/files.hpp"
#include "hyselam_common/trajectory_io.hpp"

namespace hyselam {
namespace {

struct Expected {
  const char* file;
  std::size_t scans;
  std::size_t beams;
  double duration;  ///< [s]; 0: the log has no usable times
  double path;      ///< length of the raw odometry [m]; 0: not stated
};

void PrintTo(const Expected& e, std::ostream* out) {
  *out << e.file;
}

class RealLog : public ::testing::TestWithParam<Expected> {};

TEST_P(RealLog, HasTheCountsOfItsTable) {
  HYSELAM_NEED_DATA(data);
  const Expected& expected = GetParam();
  std::vector<CarmenIssue> issues;
  const RobotLog log = readCarmenLog(data + "/laser/" + expected.file, {}, &issues);
  EXPECT_EQ(log.scans.size(), expected.scans);
  for (const LaserScan& s : log.scans) ASSERT_EQ(s.ranges.size(), expected.beams);
  for (const CarmenIssue& i : issues) EXPECT_NE(i.kind, CarmenIssue::Kind::kSkipped) << toString(i);
  if (expected.duration > 0.0) {
    const auto span = timeSpan(log);
    EXPECT_NEAR(span->end - span->begin, expected.duration, 1.0);
  }
  if (expected.path > 0.0) {
    double path = 0.0;
    for (std::size_t i = 1; i < log.odometry.size(); ++i) {
      path += distance(log.odometry[i - 1].pose, log.odometry[i].pose);
    }
    EXPECT_NEAR(path, expected.path, 0.005 * expected.path + 0.5);
  }
  for (const LaserScan& s : log.scans) ASSERT_TRUE(poseAt(log.odometry, s.stamp));
}

INSTANTIATE_TEST_SUITE_P(
    Laser, RealLog,
    ::testing::Values(Expected{"intel/intel.log.gz", 13631, 180, 2691, 508.4},
                      Expected{"aces/aces.log.gz", 7374, 180, 1365, 325.2},
                      Expected{"mit-killian/mit-killian.log.gz", 17480, 180, 7677, 1910.8},
                      Expected{"intel/intel.corrected.log.gz", 910, 180, 2691, 0},
                      Expected{"aces/aces.corrected.log.gz", 440, 180, 1365, 0},
                      Expected{"mit-killian/infinite-corridor.corrected.log.gz", 1941, 180, 0, 0},
                      Expected{"fr101/fr101.corrected.log.gz", 292, 360, 0, 0},
                      Expected{"fr101/fr101.keyframes.log.gz", 292, 360, 0, 212},
                      Expected{"fhw/fhw.corrected.log.gz", 488, 180, 0, 0},
                      Expected{"fhw/fhw.keyframes.log.gz", 488, 180, 0, 404},
                      Expected{"edmonton/edmonton.corrected.log.gz", 340, 180, 0, 0},
                      Expected{"edmonton/edmonton.keyframes.log.gz", 340, 180, 0, 333},
                      Expected{"seattle-uw/seattle-uw.corrected.log.gz", 241, 361, 0, 0},
                      Expected{"seattle-uw/seattle-uw.keyframes.log.gz", 241, 361, 0, 212},
                      Expected{"acapulco/acapulco.corrected.log.gz", 861, 181, 0, 0},
                      Expected{"acapulco/acapulco.keyframes.log.gz", 861, 181, 0, 825},
                      Expected{"orebro/orebro.corrected.log.gz", 237, 181, 0, 0},
                      Expected{"wean-hall/robotdata1.log.gz", 713, 180, 135, 89},
                      Expected{"wean-hall/robotdata2.log.gz", 2251, 180, 240, 162},
                      Expected{"wean-hall/robotdata3.log.gz", 1241, 180, 132, 78}));

TEST(RealLog, FullLogIsConvertedTheSameTwice) {
  HYSELAM_NEED_DATA(data);
  testing::TemporaryDirectory d;
  const RobotLog log = readCarmenLog(data + "/laser/aces/aces.log.gz");
  writeBag(d / "a.bag", log);
  writeBag(d / "b.bag", log);
  EXPECT_TRUE(testing::fileBytes(d / "a.bag") == testing::fileBytes(d / "b.bag"));
  const RobotLog back = readBag(d / "a.bag");
  ASSERT_EQ(back.scans.size(), log.scans.size());
  ASSERT_EQ(back.odometry.size(), log.odometry.size());
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    ASSERT_EQ(back.scans[i].ranges, log.scans[i].ranges);
    ASSERT_NEAR(back.scans[i].stamp, log.scans[i].stamp, 2e-9);
  }
}

TEST(RealLog, NoReturnReadingsLieAtTheLimit) {
  HYSELAM_NEED_DATA(data);
  // The largest real reading of intel is 26.37 m; 81.83 m means no return.
  const RobotLog log = readCarmenLog(data + "/laser/intel/intel.log.gz");
  float largest = 0.0F;
  for (const LaserScan& s : log.scans) {
    for (const float r : s.ranges) {
      if (r < s.range_max) largest = std::max(largest, r);
    }
  }
  EXPECT_FLOAT_EQ(largest, 26.37F);
}

TEST(RealBag, PioneerBagsHaveTheCountsOfTheirTable) {
  HYSELAM_NEED_DATA(data);
  const RobotLog log = readBag(data + "/laser/bags/p3dx_cs_lower_ground_trace0.bag.gz");
  EXPECT_EQ(log.scans.size(), 958U);
  EXPECT_EQ(log.scans[0].ranges.size(), 726U);
  EXPECT_EQ(log.odometry.size(), 958U);
  EXPECT_EQ(readBag(data + "/laser/bags/p3dx_cs_lower_ground_trace1.bag.gz").scans.size(), 906U);
}

TEST(RealBag, ScanOnlyBagsSayThatTheyHaveNoOdometry) {
  HYSELAM_NEED_DATA(data);
  const std::string path = data + "/laser/bags/pcar_csmfail.bag.gz";
  EXPECT_THROW(readBag(path), InputError);
  BagOptions options;
  options.odometry_required = false;
  EXPECT_EQ(readBag(path, options).scans.size(), 268U);
}

struct BuiltMap {
  OccupancyGrid grid;
  double on_wall = 0.0;  ///< share of the returns that end in or beside an occupied cell
};

/// One cell of 5 cm is about the error of the reference poses.
bool besideOccupied(const OccupancyGrid& grid, Cell c) {
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      if (grid.valueOr({c.x + dx, c.y + dy}) == OccupancyGrid::kOccupied) return true;
    }
  }
  return false;
}

BuiltMap buildMap(const RobotLog& log, const std::vector<StampedPose2>& poses) {
  OccupancyMapper mapper;
  for (std::size_t i = 0; i < log.scans.size(); ++i) mapper.insert(poses[i].pose, log.scans[i]);
  BuiltMap map{mapper.grid()};
  std::size_t returns = 0, on_wall = 0;
  for (std::size_t i = 0; i < log.scans.size(); i += 10) {
    const LaserScan& s = log.scans[i];
    for (std::size_t k = 0; k < s.ranges.size(); ++k) {
      if (!(s.ranges[k] >= s.range_min && s.ranges[k] < s.range_max)) continue;
      const double a = s.angle_min + static_cast<double>(k) * s.angle_increment;
      const Point2 end =
          poses[i].pose * Point2{s.ranges[k] * std::cos(a), s.ranges[k] * std::sin(a)};
      ++returns;
      on_wall += besideOccupied(map.grid, map.grid.geometry.cellAt(end)) ? 1 : 0;
    }
  }
  map.on_wall = static_cast<double>(on_wall) / static_cast<double>(returns);
  return map;
}

TEST(RealMap, IntelIsAsLargeAsItsBuildingAndItsWallsAreSharp) {
  HYSELAM_NEED_DATA(data);
  const RobotLog log = readCarmenLog(data + "/laser/intel/intel.log.gz");
  const auto poses = readReferenceTable(data + "/laser/intel/intel.reference.txt.gz");
  ASSERT_EQ(poses.size(), log.scans.size());
  const BuiltMap map = buildMap(log, poses);
  const auto free = std::count(map.grid.cells.begin(), map.grid.cells.end(), OccupancyGrid::kFree);
  const double area = static_cast<double>(free) * std::pow(map.grid.geometry.resolution, 2);
  EXPECT_GT(area, 450.0);  // about 28 m x 28 m without the courts
  EXPECT_LT(area, 750.0);
  // Where poses fit, returns end on walls; raw odometry smears them.
  const BuiltMap smeared = buildMap(log, log.odometry);
  std::cout << "returns on walls: " << map.on_wall << ", with raw odometry " << smeared.on_wall
            << "\n";
  EXPECT_GT(map.on_wall, 0.7);
  EXPECT_GT(map.on_wall, 1.5 * smeared.on_wall);
  // The robot drove through free space only.
  const auto in_free = std::count_if(poses.begin(), poses.end(), [&](const StampedPose2& p) {
    return map.grid.valueOr(map.grid.geometry.cellAt({p.pose.x, p.pose.y})) == OccupancyGrid::kFree;
  });
  EXPECT_GT(static_cast<std::size_t>(in_free), poses.size() * 99 / 100);
}

TEST(RealMap, AllPublishedGridMapsCanBeRead) {
  HYSELAM_NEED_DATA(data);
  std::size_t maps = 0;
  for (const auto& entry : std::filesystem::directory_iterator(data + "/gridmaps")) {
    if (entry.path().extension() != ".yaml") continue;
    const OccupancyGrid grid = loadMap(entry.path().string());
    EXPECT_GT(grid.geometry.cellCount(), 1000U) << entry.path();
    EXPECT_NE(std::count(grid.cells.begin(), grid.cells.end(), OccupancyGrid::kFree), 0);
    ++maps;
  }
  EXPECT_GT(maps, 10U);
}

}  // namespace
}  // namespace hyselam
