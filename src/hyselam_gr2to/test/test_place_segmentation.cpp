// Places of maps drawn by hand and of generated floors: what must hold for any map, and what people
// would see in these.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <opencv2/imgproc.hpp>
#include <set>

#include "agreement.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/rng.hpp"
#include "hyselam_gr2to/gr2to.hpp"
#include "hyselam_gr2to/segmentation/place_segmentation.hpp"
#include "hyselam_sim/generate_plan.hpp"
#include "hyselam_sim/rasterize.hpp"

using namespace hyselam_topo;  // NOLINT: a test, not a header
using hyselam::OccupancyGrid;

namespace {

OccupancyGrid gridOf(double width, double height, double resolution, std::int8_t value) {
  hyselam::GridGeometry g;
  g.width = static_cast<int>(std::lround(width / resolution));
  g.height = static_cast<int>(std::lround(height / resolution));
  g.resolution = resolution;
  return OccupancyGrid(g, value);
}

void fill(OccupancyGrid& grid, double x0, double y0, double x1, double y1, std::int8_t value) {
  const double r = grid.geometry.resolution;
  for (int y = static_cast<int>(std::lround(y0 / r)); y < std::lround(y1 / r); ++y)
    for (int x = static_cast<int>(std::lround(x0 / r)); x < std::lround(x1 / r); ++x)
      if (grid.geometry.contains({x, y})) grid.at({x, y}) = value;
}

/// Four rooms of 4 x 4 m above a corridor of 2 m, each with a door of 0.9 m to it, walls of 0.2 m.
OccupancyGrid fourRooms(double resolution = 0.05) {
  OccupancyGrid grid = gridOf(18.0, 8.0, resolution, OccupancyGrid::kOccupied);
  fill(grid, 0.6, 0.6, 17.2, 2.6, OccupancyGrid::kFree);
  for (int room = 0; room < 4; ++room) {
    const double left = 0.6 + 4.2 * room;
    fill(grid, left, 2.8, left + 4.0, 6.8, OccupancyGrid::kFree);
    fill(grid, left + 1.6, 2.6, left + 2.5, 2.8, OccupancyGrid::kFree);
  }
  return grid;
}

int labelAt(const OccupancyGrid& grid, const cv::Mat& labels, double x, double y) {
  const hyselam::Cell c = grid.geometry.cellAt({x, y});
  return labels.at<std::uint16_t>(c.y, c.x);
}

/// Labels 1 .. places, each there, in one piece, in the order of their first cells.
void expectValid(const PlaceSegmentation& s, const OccupancyGrid& grid) {
  ASSERT_EQ(CV_16UC1, s.labels.type());
  ASSERT_EQ(cv::Size(grid.geometry.width, grid.geometry.height), s.labels.size());
  int highest = 0;
  for (int y = 0; y < s.labels.rows; ++y)
    for (int x = 0; x < s.labels.cols; ++x) {
      const int label = s.labels.at<std::uint16_t>(y, x);
      ASSERT_LE(label, highest + 1) << "first cells are out of order at " << x << ' ' << y;
      highest = std::max(highest, label);
    }
  EXPECT_EQ(s.places, highest);
  for (int label = 1; label <= s.places; ++label) {
    cv::Mat pieces;
    EXPECT_EQ(2, cv::connectedComponents(s.labels == label, pieces, 4)) << "label " << label;
  }
  for (const DoorLine& door : s.doors) {
    EXPECT_GE(door.place_a, 1);
    EXPECT_LT(door.place_a, door.place_b);
    EXPECT_LE(door.place_b, s.places);
  }
}

OccupancyGrid generated(std::uint64_t seed, double resolution, bool furniture = false,
                        double rotation = 0.0) {
  hyselam_sim::PlanParams params;
  params.furniture = furniture;
  params.rotation = rotation;
  params.openings = false;
  return hyselam_sim::rasterize(hyselam_sim::generatePlan(seed, params), resolution, 0.0);
}

}  // namespace

TEST(PlaceSegmentation, RoomsAndTheCorridorInFrontOfThem) {
  const OccupancyGrid grid = fourRooms();
  const PlaceSegmentation s = segment(grid);
  expectValid(s, grid);
  ASSERT_EQ(5, s.places);
  std::set<int> seen;
  for (int room = 0; room < 4; ++room) seen.insert(labelAt(grid, s.labels, 2.6 + 4.2 * room, 5.0));
  const int corridor = labelAt(grid, s.labels, 1.0, 1.6);
  EXPECT_EQ(corridor, labelAt(grid, s.labels, 17.0, 1.6));
  seen.insert(corridor);
  EXPECT_EQ(5u, seen.size());
  ASSERT_EQ(4u, s.doors.size());
  for (std::size_t room = 0; room < 4; ++room) {
    EXPECT_TRUE(s.doors[room].real);
    EXPECT_NEAR(0.9, s.doors[room].width, 0.1);
  }
}

TEST(PlaceSegmentation, LongBentCorridorStaysWhole) {
  OccupancyGrid grid = gridOf(32, 32, 0.05, OccupancyGrid::kOccupied);
  fill(grid, 1, 1, 31, 3, OccupancyGrid::kFree);
  fill(grid, 29, 1, 31, 31, OccupancyGrid::kFree);
  const PlaceSegmentation s = segment(grid);
  EXPECT_EQ(1, s.places);
}

TEST(PlaceSegmentation, CurvedCorridorStaysWhole) {
  OccupancyGrid grid = gridOf(30, 30, 0.05, OccupancyGrid::kOccupied);
  for (int y = 0; y < grid.geometry.height; ++y)
    for (int x = 0; x < grid.geometry.width; ++x) {
      const double radius = std::hypot(x * 0.05 - 2.0, y * 0.05 - 2.0);
      if (radius > 20.0 && radius < 22.0 && x > 40 && y > 40)
        grid.at({x, y}) = OccupancyGrid::kFree;
    }
  EXPECT_EQ(1, segment(grid).places);
}

TEST(PlaceSegmentation, HallWithPillarsIsOnePlace) {
  OccupancyGrid grid = gridOf(22, 22, 0.05, OccupancyGrid::kOccupied);
  fill(grid, 1, 1, 21, 21, OccupancyGrid::kFree);
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
      fill(grid, 4.8 + 4 * i, 4.8 + 4 * j, 5.2 + 4 * i, 5.2 + 4 * j, OccupancyGrid::kOccupied);
  EXPECT_EQ(1, segment(grid).places);
}

TEST(PlaceSegmentation, ChairLegsDoNotSplitARoom) {
  OccupancyGrid grid = fourRooms();
  hyselam::Rng rng(4);
  for (int leg = 0; leg < 150; ++leg) {
    const double x = rng.uniform(1.0, 16.8), y = rng.uniform(3.2, 6.4);
    if (grid.at(grid.geometry.cellAt({x, y})) == OccupancyGrid::kFree)
      fill(grid, x, y, x + 0.1, y + 0.1, OccupancyGrid::kOccupied);
  }
  const PlaceSegmentation s = segment(grid);
  expectValid(s, grid);
  EXPECT_EQ(5, s.places);
}

TEST(PlaceSegmentation, DeskAcrossARoomDoesNotSplitIt) {
  OccupancyGrid grid = gridOf(7, 10, 0.05, OccupancyGrid::kUnknown);
  fill(grid, 0.5, 0.5, 5.7, 9.0, OccupancyGrid::kOccupied);
  fill(grid, 0.7, 0.7, 5.5, 2.7, OccupancyGrid::kFree);  // a corridor
  fill(grid, 2.0, 2.7, 2.9, 2.9, OccupancyGrid::kFree);  // a door
  fill(grid, 0.7, 2.9, 5.5, 8.8, OccupancyGrid::kFree);  // the room
  fill(grid, 1.8, 6.1, 4.4, 7.2, OccupancyGrid::kOccupied);
  const PlaceSegmentation s = segment(grid);
  expectValid(s, grid);
  EXPECT_EQ(2, s.places);
}

TEST(PlaceSegmentation, RaysThroughAWindowAreOutside) {
  OccupancyGrid grid = gridOf(30, 30, 0.05, OccupancyGrid::kUnknown);
  fill(grid, 1, 1, 11, 11, OccupancyGrid::kOccupied);
  fill(grid, 1.2, 1.2, 10.8, 10.8, OccupancyGrid::kFree);
  for (int ray = 0; ray < 12; ++ray) {
    const double angle = 0.1 * ray;
    for (double t = 0; t < 16.0; t += 0.02) {
      const hyselam::Cell c =
          grid.geometry.cellAt({10.8 + t * std::cos(angle), 4.0 + 0.3 * ray + t * std::sin(angle)});
      if (grid.geometry.contains(c)) grid.at(c) = OccupancyGrid::kFree;
    }
  }
  const PlaceSegmentation s = segment(grid);
  expectValid(s, grid);
  EXPECT_EQ(1, s.places);
  const int cells = cv::countNonZero(s.labels);
  EXPECT_GE(cells, 192 * 192);
  EXPECT_LE(cells, 192 * 192 * 1.05);
}

TEST(PlaceSegmentation, EveryFreeCellOfAFloorHasAPlace) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const OccupancyGrid grid = generated(seed, 0.05, seed % 2 == 0);
    const PlaceSegmentation s = segment(grid);
    expectValid(s, grid);
    cv::Mat free(grid.geometry.height, grid.geometry.width, CV_8U, cv::Scalar(0)), parts, stats, c;
    for (std::size_t i = 0; i < grid.cells.size(); ++i)
      if (grid.cells[i] == OccupancyGrid::kFree) free.data[i] = 255;
    const int n = cv::connectedComponentsWithStats(free, parts, stats, c, 4);
    for (int i = 1; i < n; ++i) {
      if (stats.at<int>(i, cv::CC_STAT_AREA) < 1.0 / (0.05 * 0.05)) continue;
      EXPECT_EQ(0, cv::countNonZero((parts == i) & (s.labels == 0))) << "seed " << seed;
    }
  }
}

TEST(PlaceSegmentation, SameGridGivesTheSameBits) {
  const OccupancyGrid grid = generated(3, 0.05, true);
  const PlaceSegmentation first = segment(grid), second = segment(grid);
  EXPECT_EQ(0, cv::countNonZero(first.labels != second.labels));
  ASSERT_EQ(first.doors.size(), second.doors.size());
  for (std::size_t i = 0; i < first.doors.size(); ++i) {
    EXPECT_EQ(first.doors[i].a.x, second.doors[i].a.x);
    EXPECT_EQ(first.doors[i].width, second.doors[i].width);
  }
}

TEST(PlaceSegmentation, IsInvariantToMargins) {
  const OccupancyGrid grid = generated(5, 0.05, true);
  hyselam::GridGeometry g = grid.geometry;
  g.width += 31;
  g.height += 17;
  OccupancyGrid moved(g);
  for (int y = 0; y < grid.geometry.height; ++y)
    for (int x = 0; x < grid.geometry.width; ++x) moved.at({x + 13, y + 7}) = grid.at({x, y});
  const PlaceSegmentation a = segment(grid), b = segment(moved);
  EXPECT_EQ(a.places, b.places);
  EXPECT_EQ(0, cv::countNonZero(a.labels != b.labels(cv::Rect({13, 7}, a.labels.size()))));
}

TEST(PlaceSegmentation, IsInvariantToTheOrigin) {
  OccupancyGrid grid = fourRooms();
  const PlaceSegmentation before = segment(grid);
  grid.geometry.origin = {-3.0, 12.0, 2.0};
  const PlaceSegmentation after = segment(grid);
  EXPECT_EQ(0, cv::countNonZero(before.labels != after.labels));
}

TEST(PlaceSegmentation, ResolutionsFromOneToTwentyCentimeters) {
  for (const double resolution : {0.01, 0.02, 0.025, 0.04, 0.05, 0.08, 0.1}) {
    const OccupancyGrid grid = fourRooms(resolution);
    const PlaceSegmentation s = segment(grid);
    expectValid(s, grid);
    EXPECT_EQ(5, s.places) << resolution;
  }
  // A door of 0.9 m and walls of 0.2 m are 4.5 cells and one.
  OccupancyGrid coarse = gridOf(18.0, 8.0, 0.2, OccupancyGrid::kOccupied);
  fill(coarse, 0.6, 0.6, 17.2, 2.6, OccupancyGrid::kFree);
  for (int room = 0; room < 4; ++room) {
    const double left = 0.6 + 4.2 * room;
    fill(coarse, left, 2.8, left + 4.0, 6.8, OccupancyGrid::kFree);
    fill(coarse, left + 1.6, 2.6, left + 2.6, 2.8, OccupancyGrid::kFree);
  }
  EXPECT_EQ(5, segment(coarse).places);
}

TEST(PlaceSegmentation, FindsRoomsOfFloorsAtAnyRotation) {
  double sum = 0.0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    for (const double rotation : {0.0, hyselam::radians(17.0)}) {
      hyselam_sim::PlanParams params;
      params.openings = false;
      params.rotation = rotation;
      const hyselam_sim::FloorPlan plan = hyselam_sim::generatePlan(seed, params);
      const OccupancyGrid grid = hyselam_sim::rasterize(plan, 0.05, 0.0);
      cv::Mat rooms(grid.geometry.height, grid.geometry.width, CV_16UC1, cv::Scalar(0));
      for (int y = 0; y < rooms.rows; ++y)
        for (int x = 0; x < rooms.cols; ++x)
          for (std::size_t i = 0; i < plan.places.size(); ++i)
            if (hyselam_sim::contains(plan.places[i].outline, grid.geometry.center({x, y})))
              rooms.at<std::uint16_t>(y, x) = static_cast<std::uint16_t>(i + 1);
      const double index = agreement(rooms, segment(grid).labels);
      EXPECT_GE(index, 0.8) << "seed " << seed << ", turned by " << rotation;
      sum += index;
    }
  }
  // Two of the floors that are not turned come out with places in parts.
  EXPECT_GE(sum / 12.0, 0.95);
}

TEST(PlaceSegmentation, MapsWithoutPlaces) {
  for (const std::int8_t value : {OccupancyGrid::kUnknown, OccupancyGrid::kOccupied}) {
    const OccupancyGrid grid = gridOf(5, 5, 0.05, value);
    const PlaceSegmentation s = segment(grid);
    expectValid(s, grid);
    EXPECT_EQ(0, s.places);
    EXPECT_TRUE(gr2to(grid).map.places.empty());
  }
  OccupancyGrid tiny = gridOf(0.05, 0.05, 0.05, OccupancyGrid::kFree);
  EXPECT_EQ(0, segment(tiny).places);
}

TEST(PlaceSegmentation, MapWithoutWallsIsOnePlace) {
  const OccupancyGrid grid = gridOf(12, 9, 0.05, OccupancyGrid::kFree);
  const PlaceSegmentation s = segment(grid);
  expectValid(s, grid);
  EXPECT_EQ(1, s.places);
  EXPECT_EQ(static_cast<int>(grid.cells.size()), cv::countNonZero(s.labels));
}

TEST(PlaceSegmentation, NoiseGivesValidLabels) {
  hyselam::Rng rng(7);
  for (int round = 0; round < 5; ++round) {
    OccupancyGrid grid = gridOf(8, 6, 0.05, OccupancyGrid::kUnknown);
    const double share = 0.2 * round;
    for (std::int8_t& cell : grid.cells) {
      const double dice = rng.uniform(0.0, 1.0);
      cell = dice < share ? OccupancyGrid::kFree
                          : static_cast<std::int8_t>(dice < 0.9 ? -1 : rng.below(101));
    }
    expectValid(segment(grid), grid);
  }
}

TEST(PlaceSegmentation, RefusesInvalidGrids) {
  EXPECT_THROW(segment(OccupancyGrid()), hyselam::InputError);
  OccupancyGrid grid = gridOf(2, 2, 0.05, OccupancyGrid::kFree);
  grid.cells.pop_back();
  EXPECT_THROW(segment(grid), hyselam::InputError);
  for (const double bad : {0.0, -0.05, std::nan(""), std::numeric_limits<double>::infinity()}) {
    OccupancyGrid other = gridOf(2, 2, 0.05, OccupancyGrid::kFree);
    other.geometry.resolution = bad;
    EXPECT_THROW(segment(other), hyselam::InputError) << bad;
  }
}

TEST(PlaceSegmentation, NamesTheParameterOutOfRange) {
  const OccupancyGrid grid = fourRooms();
  const auto refused = [&](const SegmentationParams& p, const std::string& name) {
    try {
      segment(grid, p);
      ADD_FAILURE() << name << " was taken";
    } catch (const hyselam::ParameterError& e) {
      EXPECT_NE(std::string::npos, std::string(e.what()).find(name)) << e.what();
    }
  };
  SegmentationParams p;
  p.free_max = 100;
  refused(p, "free_max");
  p = {};
  p.working_resolution = 0.5;
  refused(p, "working_resolution");
  p = {};
  p.max_clutter_size = std::nan("");
  refused(p, "max_clutter_size");
  p = {};
  p.min_place_area = -1.0;
  refused(p, "min_place_area");
}

TEST(Gr2To, GivesMapLabelsDoorsAndTimes) {
  const OccupancyGrid grid = fourRooms();
  for (const auto mode : {Gr2ToParams::Mode::kDefault, Gr2ToParams::Mode::kThesis}) {
    Gr2ToParams params;
    params.mode = mode;
    const Gr2ToResult result = gr2to(grid, params);
    if (mode == Gr2ToParams::Mode::kDefault) {
      EXPECT_EQ(5u, result.map.places.size());
      EXPECT_EQ(4u, result.doors.size());
    }
    EXPECT_FALSE(result.map.places.empty());
    EXPECT_GE(result.seconds.size(), 2u);
    for (const Place& place : result.map.places) {
      ASSERT_TRUE(place.centre);
      EXPECT_EQ(static_cast<int>(place.id),
                labelAt(grid, result.labels, place.centre->x, place.centre->y));
    }
  }
}
