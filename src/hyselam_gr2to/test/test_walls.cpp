// Borders, walls and the map that is built of them, on maps drawn by hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "hyselam_common/errors.hpp"
#include "hyselam_gr2to/map_builder/borders.hpp"
#include "hyselam_gr2to/map_builder/doors.hpp"
#include "hyselam_gr2to/map_builder/map_builder.hpp"
#include "hyselam_topological_map/map_geometry.hpp"

using namespace hyselam_topo;  // NOLINT: a test, not a header
using hyselam::OccupancyGrid;
using hyselam::Point2;

namespace {

struct Drawing {
  OccupancyGrid grid;
  PlaceSegmentation segmentation;
};

OccupancyGrid gridOf(int width, int height, double resolution, std::int8_t value) {
  hyselam::GridGeometry g;
  g.width = width;
  g.height = height;
  g.resolution = resolution;
  return OccupancyGrid(g, value);
}

// All of the floor is one place.
PlaceSegmentation onePlace(const OccupancyGrid& grid) {
  PlaceSegmentation s;
  s.labels = cv::Mat(grid.geometry.height, grid.geometry.width, CV_16UC1, cv::Scalar(0));
  for (std::size_t i = 0; i < grid.cells.size(); ++i) {
    s.labels.ptr<std::uint16_t>(0)[i] = grid.cells[i] == 0 ? 1 : 0;
  }
  s.places = 1;
  return s;
}

// Two rooms of 4 x 3 m, cells of 5 cm, a wall of 0.2 m with a door of 0.9 m; place 2 on the left.
Drawing twoRooms() {
  Drawing d;
  d.grid = gridOf(172, 68, 0.05, OccupancyGrid::kOccupied);
  d.grid.geometry.origin = {1.0, -2.0, 0.5};
  d.segmentation.labels = cv::Mat(68, 172, CV_16UC1, cv::Scalar(0));
  for (int y = 4; y < 64; ++y) {
    for (int x = 4; x < 168; ++x) {
      if (x >= 84 && x < 88 && (y < 24 || y >= 42)) continue;
      d.grid.at({x, y}) = OccupancyGrid::kFree;
      d.segmentation.labels.at<std::uint16_t>(y, x) = x < 86 ? 2 : 1;
    }
  }
  d.segmentation.places = 2;
  d.segmentation.doors = refineDoors(d.grid, d.segmentation.labels);
  return d;
}

double total(const std::vector<Wall>& walls, WallKind kind) {
  double sum = 0.0;
  for (const Wall& w : walls) sum += w.kind == kind ? w.length : 0.0;
  return sum;
}

}  // namespace

TEST(Borders, OfTwoPlacesAndARing) {
  cv::Mat labels = (cv::Mat_<std::uint16_t>(5, 6) << 1, 1, 2, 2, 0, 3,  //
                    1, 1, 1, 2, 0, 3,                                   //
                    0, 0, 0, 0, 0, 0,                                   //
                    1, 1, 2, 2, 2, 2,                                   //
                    1, 1, 2, 2, 2, 2);
  const auto borders = findBorders(labels);
  ASSERT_EQ(2u, borders.size());
  EXPECT_EQ(1, borders[0].a);
  EXPECT_EQ(2, borders[0].b);
  EXPECT_EQ(3, borders[0].length);
  EXPECT_EQ(cv::Point(2, 0), borders[0].first);
  EXPECT_EQ(cv::Point(3, 2), borders[0].last);
  EXPECT_FALSE(borders[0].closed);
  EXPECT_EQ(2, borders[1].length);

  labels = cv::Mat(9, 9, CV_16UC1, cv::Scalar(4));
  labels(cv::Rect(3, 3, 3, 3)).setTo(7);
  const auto ring = findBorders(labels);
  ASSERT_EQ(1u, ring.size());
  EXPECT_TRUE(ring[0].closed);
  EXPECT_EQ(12, ring[0].length);
  EXPECT_TRUE(findBorders(cv::Mat(3, 3, CV_16UC1, cv::Scalar(0))).empty());
}

TEST(Doors, InAThickWallIsInItsMiddle) {
  const Drawing d = twoRooms();
  ASSERT_EQ(1u, d.segmentation.doors.size());
  const DoorLine& door = d.segmentation.doors[0];
  EXPECT_TRUE(door.real);
  EXPECT_EQ(1, door.place_a);
  EXPECT_EQ(2, door.place_b);
  EXPECT_NEAR(0.9, door.width, 0.01);
  const Point2 middle = d.grid.geometry.origin.inverse() *
                        Point2{0.5 * (door.a.x + door.b.x), 0.5 * (door.a.y + door.b.y)};
  EXPECT_NEAR(86 * 0.05, middle.x, 0.051);
  EXPECT_NEAR(33 * 0.05, middle.y, 0.051);
}

TEST(Doors, ACorridorCutInTwoHasAnOpenBorder) {
  OccupancyGrid grid = gridOf(200, 44, 0.05, OccupancyGrid::kOccupied);
  cv::Mat labels(44, 200, CV_16UC1, cv::Scalar(0));
  for (int y = 4; y < 40; ++y) {
    for (int x = 4; x < 196; ++x) {
      grid.at({x, y}) = OccupancyGrid::kFree;
      labels.at<std::uint16_t>(y, x) = x < 90 ? 1 : 2;
    }
  }
  const auto doors = refineDoors(grid, labels);
  ASSERT_EQ(1u, doors.size());
  EXPECT_FALSE(doors[0].real);
  EXPECT_NEAR(1.8, doors[0].width, 0.06);
  EXPECT_NEAR(4.5, 0.5 * (doors[0].a.x + doors[0].b.x), 0.15);
}

// The same with doors into rooms beside the border: they do not make the corridor wider.
TEST(Doors, DoorsAtTheSideMakeNoJambs) {
  OccupancyGrid grid = gridOf(200, 104, 0.05, OccupancyGrid::kOccupied);
  cv::Mat labels(104, 200, CV_16UC1, cv::Scalar(0));
  const auto clear = [&](const cv::Rect& box, int label) {
    for (int y = box.y; y < box.y + box.height; ++y) {
      for (int x = box.x; x < box.x + box.width; ++x) {
        grid.at({x, y}) = OccupancyGrid::kFree;
        labels.at<std::uint16_t>(y, x) = static_cast<std::uint16_t>(label);
      }
    }
  };
  clear({4, 4, 96, 36}, 1);
  clear({100, 4, 96, 36}, 2);
  clear({4, 44, 94, 56}, 3);
  clear({102, 44, 94, 56}, 4);
  clear({74, 40, 20, 4}, 3);
  clear({106, 40, 20, 4}, 4);
  int real = 0;
  for (const DoorLine& d : refineDoors(grid, labels)) {
    real += d.real ? 1 : 0;
    EXPECT_EQ(d.real, d.place_b > 2);
  }
  EXPECT_EQ(2, real);
}

// A room that was cut in two beside a desk: the ways past it are no doors.
TEST(Doors, PassagesAroundATableAreOpenBorders) {
  OccupancyGrid grid = gridOf(88, 128, 0.05, OccupancyGrid::kOccupied);
  cv::Mat labels(128, 88, CV_16UC1, cv::Scalar(0));
  for (int y = 4; y < 124; ++y) {
    for (int x = 4; x < 84; ++x) {
      if (x >= 24 && x < 64 && y >= 50 && y < 66) continue;
      grid.at({x, y}) = OccupancyGrid::kFree;
      labels.at<std::uint16_t>(y, x) = y < 58 ? 1 : 2;
    }
  }
  auto doors = refineDoors(grid, labels);
  ASSERT_EQ(2u, doors.size());
  EXPECT_FALSE(doors[0].real || doors[1].real);
  // Against the wall on one side it leaves one way, which may be a door.
  for (int y = 50; y < 66; ++y) {
    for (int x = 4; x < 24; ++x) {
      grid.at({x, y}) = OccupancyGrid::kOccupied;
      labels.at<std::uint16_t>(y, x) = 0;
    }
  }
  doors = refineDoors(grid, labels);
  ASSERT_EQ(1u, doors.size());
  EXPECT_TRUE(doors[0].real);
}

TEST(Doors, RefusesLabelsOfAnotherSize) {
  const Drawing d = twoRooms();
  EXPECT_THROW(refineDoors(d.grid, cv::Mat(3, 3, CV_16UC1, cv::Scalar(0))), hyselam::InputError);
  DoorParams params;
  params.max_width = 0.1;
  EXPECT_THROW(refineDoors(d.grid, d.segmentation.labels, params), hyselam::ParameterError);
}

TEST(Walls, OfARoomAreFourWithNormalsInwards) {
  OccupancyGrid grid = gridOf(90, 70, 0.05, OccupancyGrid::kOccupied);
  for (int y = 5; y < 65; ++y) {
    for (int x = 5; x < 85; ++x) grid.at({x, y}) = OccupancyGrid::kFree;
  }
  const auto walls = extractWalls(grid, onePlace(grid));
  ASSERT_EQ(1u, walls.size());
  ASSERT_EQ(4u, walls[0].walls.size());
  EXPECT_NEAR(4.0 * 3.0, signedArea(walls[0].outline), 1e-6);
  for (const Wall& w : walls[0].walls) {
    EXPECT_EQ(WallKind::kSolid, w.kind);
    EXPECT_EQ(0.0, w.curvature);
    // The middle of the room lies in front of each.
    const double in = (2.25 - w.position.x) * w.normal.x + (1.75 - w.position.y) * w.normal.y;
    EXPECT_NEAR(std::abs(w.normal.x) > 0.5 ? 2.0 : 1.5, in, 1e-6);
    EXPECT_NEAR(std::abs(w.normal.x) > 0.5 ? 3.0 : 4.0, w.length, 1e-6);
    ASSERT_TRUE(w.position_covariance.has_value());
    EXPECT_LT((*w.position_covariance)[0], 0.05 * 0.05);
  }
}

TEST(Walls, OfARoundHallAreArcs) {
  OccupancyGrid grid = gridOf(160, 160, 0.05, OccupancyGrid::kOccupied);
  for (int y = 0; y < 160; ++y) {
    for (int x = 0; x < 160; ++x) {
      const double r = 0.05 * std::hypot(x - 79.5, y - 79.5);
      if (r < 3.5 && r > 1.5) grid.at({x, y}) = OccupancyGrid::kFree;
    }
  }
  const auto walls = extractWalls(grid, onePlace(grid));
  double outer = 0.0, inner = 0.0;
  for (const Wall& w : walls[0].walls) {
    if (std::abs(w.curvature - 1.0 / 3.5) < 0.02) outer += w.length;
    if (std::abs(w.curvature + 1.0 / 1.5) < 0.05) inner += w.length;
    for (const Point2& p : polyline(w, 0.005)) {
      const double r = std::hypot(p.x - 4.0, p.y - 4.0);
      EXPECT_LT(std::min(std::abs(r - 3.5), std::abs(r - 1.5)), 0.08);
    }
  }
  EXPECT_GT(outer, 0.9 * 2.0 * hyselam::kPi * 3.5);
  EXPECT_GT(inner, 0.9 * 2.0 * hyselam::kPi * 1.5);
}

TEST(Walls, UnknownAndPillars) {
  OccupancyGrid grid = gridOf(90, 70, 0.05, OccupancyGrid::kUnknown);
  for (int y = 5; y < 65; ++y) {
    for (int x = 5; x < 85; ++x) grid.at({x, y}) = OccupancyGrid::kFree;
  }
  for (int x = 4; x < 86; ++x) grid.at({x, 4}) = OccupancyGrid::kOccupied;
  for (int y = 30; y < 36; ++y) grid.at({20, y}) = OccupancyGrid::kOccupied;  // a pillar
  // A gap of 10 cm in the wall, and the wall one cell off.
  grid.at({30, 4}) = grid.at({31, 4}) = OccupancyGrid::kUnknown;
  const auto walls = extractWalls(grid, onePlace(grid));
  EXPECT_NEAR(4.0, total(walls[0].walls, WallKind::kSolid), 0.06);
  EXPECT_NEAR(4.0 + 3.0 + 3.0, total(walls[0].walls, WallKind::kVirtual), 0.1);
  WallParams all;
  all.min_island = 0.0;
  EXPECT_NEAR(4.0 + 0.7, total(extractWalls(grid, onePlace(grid), all)[0].walls, WallKind::kSolid),
              0.2);
}

TEST(Walls, RefusesParametersOutOfRange) {
  const OccupancyGrid grid = gridOf(9, 9, 0.05, OccupancyGrid::kFree);
  WallParams params;
  params.tolerance = 0.0;
  EXPECT_THROW(extractWalls(grid, onePlace(grid), params), hyselam::ParameterError);
  EXPECT_THROW(extractWalls(grid, cv::Mat(3, 3, CV_16UC1, cv::Scalar(0))), hyselam::InputError);
}

TEST(MapBuilder, TwoRoomsAndTheirDoor) {
  const Drawing d = twoRooms();
  const AugmentedTopologicalMap map = buildTopologicalMap(d.grid, d.segmentation);
  EXPECT_NO_THROW(checkMap(map, "test"));
  ASSERT_EQ(2u, map.places.size());
  ASSERT_EQ(1u, map.edges.size());
  ASSERT_EQ(1u, map.edges[0].doors.size());
  EXPECT_NEAR(82 * 60 * 0.0025 - 2 * 42 * 0.0025, map.places[0].area, 1e-9);
  const Door& door = map.edges[0].doors[0];
  EXPECT_TRUE(door.real);
  EXPECT_EQ(DoorState::kOpen, door.state);
  // From place 1, on the right, to place 2.
  const Point2 through = d.grid.geometry.origin.inverse() *
                         Point2{door.position.x + door.normal.x, door.position.y + door.normal.y};
  const Point2 at = d.grid.geometry.origin.inverse() * Point2{door.position.x, door.position.y};
  EXPECT_NEAR(-1.0, through.x - at.x, 0.1);
  for (const Place& place : map.places) {
    ASSERT_TRUE(place.centre.has_value());
    EXPECT_EQ(place.id,
              map.grid->placeOf(map.grid->geometry.cellAt({place.centre->x, place.centre->y})));
    EXPECT_EQ(PlaceKind::kRoom, place.kind);
    // The doorway is the only limit that is no wall.
    EXPECT_NEAR(0.9, total(place.walls, WallKind::kVirtual), 0.06);
    EXPECT_TRUE(contains(place.outline, {place.centre->x, place.centre->y}));
  }
}

TEST(MapBuilder, CenterOfABentPlaceLiesInIt) {
  OccupancyGrid grid = gridOf(100, 100, 0.1, OccupancyGrid::kOccupied);
  for (int i = 5; i < 95; ++i) {
    for (int k = 5; k < 20; ++k) {
      grid.at({i, k}) = OccupancyGrid::kFree;
      grid.at({k, i}) = OccupancyGrid::kFree;
    }
  }
  PlaceSegmentation s = onePlace(grid);
  const auto map = buildTopologicalMap(grid, s);
  const auto centre = *map.places[0].centre;
  EXPECT_EQ(1u, map.grid->placeOf(map.grid->geometry.cellAt({centre.x, centre.y})));
  EXPECT_EQ(0u, map.edges.size());
}

TEST(MapBuilder, AnEmptySegmentationIsAnEmptyMap) {
  const OccupancyGrid grid = gridOf(9, 9, 0.05, OccupancyGrid::kUnknown);
  const auto map = buildTopologicalMap(grid, onePlace(grid));
  EXPECT_NO_THROW(checkMap(map, "test"));
  EXPECT_EQ(0.0, map.places[0].area);
  EXPECT_FALSE(map.places[0].centre.has_value());
}
