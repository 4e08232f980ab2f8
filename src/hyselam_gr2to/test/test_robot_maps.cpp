// What robots' maps have and drawn ones have not: fans of rays, corridors whose walls are
// interrupted, rooms that stand wide open, halls with rows of desks.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>

#include "hyselam_common/pose2.hpp"
#include "hyselam_gr2to/segmentation/place_segmentation.hpp"
#include "segmentation/chamfer_distance.hpp"
#include "segmentation/corridor_basins.hpp"
#include "segmentation/furniture.hpp"
#include "segmentation/geometric_evidence.hpp"
#include "segmentation/prepared_basins.hpp"
#include "segmentation/ray_fans.hpp"
#include "segmentation/straight_corridors.hpp"

using namespace hyselam_topo;  // NOLINT: a test, not a header
using hyselam::OccupancyGrid;

namespace {

constexpr double kCell = 0.05;

OccupancyGrid unseen(double width, double height) {
  hyselam::GridGeometry g;
  g.width = static_cast<int>(std::lround(width / kCell));
  g.height = static_cast<int>(std::lround(height / kCell));
  g.resolution = kCell;
  return OccupancyGrid(g, OccupancyGrid::kUnknown);
}

void fill(OccupancyGrid& grid, double x0, double y0, double x1, double y1, std::int8_t value) {
  for (int y = static_cast<int>(std::lround(y0 / kCell)); y < std::lround(y1 / kCell); ++y)
    for (int x = static_cast<int>(std::lround(x0 / kCell)); x < std::lround(x1 / kCell); ++x)
      if (grid.geometry.contains({x, y})) grid.at({x, y}) = value;
}

/// Free space with walls of two cells around it.
void room(OccupancyGrid& grid, double x0, double y0, double x1, double y1) {
  for (int y = static_cast<int>(std::lround(y0 / kCell)) - 2; y < std::lround(y1 / kCell) + 2; ++y)
    for (int x = static_cast<int>(std::lround(x0 / kCell)) - 2; x < std::lround(x1 / kCell) + 2;
         ++x)
      if (grid.at({x, y}) != OccupancyGrid::kFree) grid.at({x, y}) = OccupancyGrid::kOccupied;
  fill(grid, x0, y0, x1, y1, OccupancyGrid::kFree);
}

/// A ray that passes what stands in its way, and is one cell wide.
void ray(OccupancyGrid& grid, double x, double y, double angle, double length) {
  for (double t = 0.0; t < length; t += 0.5 * kCell) {
    const hyselam::Cell c =
        grid.geometry.cellAt({x + t * std::cos(angle), y + t * std::sin(angle)});
    if (grid.geometry.contains(c)) grid.at(c) = OccupancyGrid::kFree;
  }
}

int labelAt(const OccupancyGrid& grid, const cv::Mat& labels, double x, double y) {
  const hyselam::Cell c = grid.geometry.cellAt({x, y});
  return labels.at<std::uint16_t>(c.y, c.x);
}

}  // namespace

TEST(StraightCorridors, WallsThatAreInterruptedMakeOneCorridor) {
  OccupancyGrid grid = unseen(32, 12);
  room(grid, 2, 2, 28, 4);
  // Rooms of 5 m on one side, the second open over all of its width but for its partitions.
  for (int i = 0; i < 5; ++i) {
    room(grid, 2.0 + 5.2 * i, 4.2, 7.0 + 5.2 * i, 9.2);
    const double gap = i == 1 ? 0.2 : 2.0;
    fill(grid, 2.0 + 5.2 * i + gap, 4.0, 7.0 + 5.2 * i - gap, 4.2, OccupancyGrid::kFree);
  }
  const FreeSpace space = findFreeSpace(grid, {}, true);
  const std::vector<StraightCorridor> corridors =
      findStraightCorridors(space, findFurniture(space));
  ASSERT_FALSE(corridors.empty());
  const StraightCorridor& c = corridors.front();
  EXPECT_GT(c.odds(), 0.0);
  EXPECT_NEAR(2.0, 2.0 * c.halfWidth() * kCell, 0.2);
  EXPECT_GE(cv::norm(c.end() - c.start()) * kCell, 20.0);
  EXPECT_TRUE(c.contains(cv::Point2d(15.0 / kCell - space.origin.x, 3.0 / kCell - space.origin.y)));
  EXPECT_FALSE(
      c.contains(cv::Point2d(15.0 / kCell - space.origin.x, 6.0 / kCell - space.origin.y)));
}

TEST(StraightCorridors, ASquareHallIsNone) {
  OccupancyGrid grid = unseen(16, 16);
  room(grid, 2, 2, 14, 14);
  const FreeSpace space = findFreeSpace(grid, {}, true);
  EXPECT_TRUE(findStraightCorridors(space, findFurniture(space)).empty());
}

TEST(RayFans, ADoorBetweenTwoWallsStaysAndRaysGo) {
  OccupancyGrid grid = unseen(24, 10);
  room(grid, 2, 2, 8, 8);
  room(grid, 8.2, 2, 12, 8);
  fill(grid, 8.0, 4.0, 8.2, 4.8, OccupancyGrid::kFree);                        // a door
  for (int i = 0; i < 7; ++i) ray(grid, 11.5, 4.0 + 0.25 * i, 0.02 * i, 9.0);  // a window
  const cv::Mat labels = segmentPlaces(grid).labels;
  EXPECT_NE(0, labelAt(grid, labels, 4.0, 5.0));
  EXPECT_NE(0, labelAt(grid, labels, 10.0, 5.0));
  EXPECT_NE(labelAt(grid, labels, 4.0, 5.0), labelAt(grid, labels, 10.0, 5.0));
  EXPECT_EQ(0, labelAt(grid, labels, 17.0, 4.6));
}

TEST(RayFans, WhatFewRaysSawFromAfarIsNoPlace) {
  OccupancyGrid grid = unseen(30, 14);
  room(grid, 2, 2, 10, 12);
  fill(grid, 10.0, 6.75, 10.1, 7.25, OccupancyGrid::kFree);  // an open door, and what lies behind
  for (double y = 6.8; y < 7.25; y += 0.04) ray(grid, 9.0, y, (y - 7.0) * 0.1, 14.0);
  const cv::Mat labels = segmentPlaces(grid).labels;
  const int places = [&] {
    double most = 0.0;
    cv::minMaxLoc(labels, nullptr, &most);
    return static_cast<int>(most);
  }();
  EXPECT_EQ(1, places);
}

TEST(StraightCorridors, ARoomNotMuchLongerThanWideIsNone) {
  OccupancyGrid grid = unseen(12, 9);
  room(grid, 2, 2, 9, 5.5);
  const FreeSpace space = findFreeSpace(grid, {}, true);
  EXPECT_TRUE(findStraightCorridors(space, findFurniture(space)).empty());
}

namespace {

/// A corridor of 2 m with something `depth` deep that stands open to it over 4 m.
PreparedBasins besideCorridor(double depth) {
  OccupancyGrid grid = unseen(28, 12);
  room(grid, 2, 2, 26, 4);
  room(grid, 12, 4, 16, 4.0 + depth);
  return prepareBasins(grid, {}, Preparation::kFull);
}

int basinAt(const PreparedBasins& places, double x, double y) {
  const cv::Point cell(static_cast<int>(std::lround(x / kCell)) - places.space.origin.x,
                       static_cast<int>(std::lround(y / kCell)) - places.space.origin.y);
  return places.basins.labels.at<int>(cell);
}

}  // namespace

TEST(CorridorBasins, ARoomThatStandsOpenIsCutOff) {
  const PreparedBasins places = besideCorridor(5.0);
  ASSERT_FALSE(places.context.corridors.corridors.empty());
  EXPECT_NE(basinAt(places, 14.0, 3.5), basinAt(places, 14.0, 4.5));
}

TEST(CorridorBasins, ANicheIsNot) {
  const PreparedBasins places = besideCorridor(1.0);
  ASSERT_FALSE(places.context.corridors.corridors.empty());
  EXPECT_EQ(basinAt(places, 14.0, 3.5), basinAt(places, 14.0, 4.5));
}

TEST(GeometricEvidence, SpeaksAgainstARoomAndACorridorBeingOne) {
  const PreparedBasins places = besideCorridor(5.0);
  const RegionAdjacencyGraph graph(places.clearance, places.basins, places.space.resolution,
                                   places.context);
  const int corridor = basinAt(places, 14.0, 3.5), open_room = basinAt(places, 14.0, 4.5);
  ASSERT_EQ(1u, graph.node(corridor).borders.count(open_room));
  EXPECT_LT(geometricEvidence(graph, corridor, open_room), -0.5);
}

TEST(RayFans, LabelsDoNotGrowIntoClosedOnes) {
  OccupancyGrid grid = unseen(24, 10);
  room(grid, 2, 2, 8, 8);
  fill(grid, 8.0, 4.8, 12.0, 5.1, OccupancyGrid::kFree);  // between unseen cells
  fill(grid, 8.0, 4.8, 8.1, 5.1, OccupancyGrid::kFree);
  const FreeSpace space = findFreeSpace(grid, {}, true);
  ASSERT_GT(cv::countNonZero(space.closed), 0);
  const cv::Mat labels = segmentPlaces(grid).labels;
  EXPECT_NE(0, labelAt(grid, labels, 7.5, 5.0));
  EXPECT_EQ(0, labelAt(grid, labels, 8.4, 4.95));
}

TEST(RayFans, WhatHasWallsAroundIsAPlaceAndAWedgeOfTheUnseenIsNot) {
  cv::Mat labels(120, 200, CV_32S, cv::Scalar(0)), occupied(120, 200, CV_8U, cv::Scalar(0));
  cv::rectangle(occupied, {8, 8}, {91, 111}, 255, 2);
  cv::rectangle(labels, {10, 10}, {89, 109}, 1, cv::FILLED);
  cv::rectangle(occupied, {98, 8}, {131, 61}, 255, 2);
  cv::rectangle(labels, {100, 10}, {129, 59}, 2, cv::FILLED);
  for (int x = 140; x < 190; ++x)  // a wedge
    cv::line(labels, {x, 40 - (x - 140) / 3}, {x, 40 + (x - 140) / 3}, 3);
  const std::vector<char> outside = findOutside(labels, 3, occupied, kCell);
  EXPECT_EQ(0, outside[1]);
  EXPECT_EQ(0, outside[2]);
  EXPECT_EQ(1, outside[3]);
}

TEST(Furniture, ADeskIsFurnitureAndAPieceOfWallIsNot) {
  OccupancyGrid grid = unseen(14, 14);
  room(grid, 2, 2, 12, 12);
  fill(grid, 4, 4, 5.6, 4.8, OccupancyGrid::kOccupied);  // a desk
  fill(grid, 8, 6, 8.1, 8.5, OccupancyGrid::kOccupied);  // a piece of wall
  const FreeSpace space = findFreeSpace(grid, {}, true);
  const cv::Mat furniture = findFurniture(space);
  const auto at = [&](double x, double y) {
    return furniture.at<std::uint8_t>(static_cast<int>(y / kCell) - space.origin.y,
                                      static_cast<int>(x / kCell) - space.origin.x);
  };
  EXPECT_EQ(255, at(4.8, 4.4));
  EXPECT_EQ(0, at(8.05, 7.0));
}

namespace {

/// A hall of 12 m by 8 m with two things across its middle that leave 1.2 m between them;
/// `to_wall`: they reach to the walls, else 0.6 m are left there.
PreparedBasins acrossAHall(bool to_wall) {
  OccupancyGrid grid = unseen(16, 12);
  room(grid, 2, 2, 14, 10);
  const double off = to_wall ? 0.0 : 0.6;
  fill(grid, 7.6, 2.0 + off, 8.4, 5.4, OccupancyGrid::kOccupied);
  fill(grid, 7.6, 6.6, 8.4, 10.0 - off, OccupancyGrid::kOccupied);
  return prepareBasins(grid, {}, Preparation::kFull);
}

RegionAdjacencyGraph graphOf(const PreparedBasins& places) {
  return RegionAdjacencyGraph(places.clearance, places.basins, places.space.resolution,
                              places.context);
}

}  // namespace

TEST(Furniture, SupportsNoBorderAsWallsDo) {
  const PreparedBasins desks = acrossAHall(false), walls = acrossAHall(true);
  const auto evidence = [](const PreparedBasins& places) {
    const int left = basinAt(places, 5.0, 6.0), right = basinAt(places, 11.0, 6.0);
    EXPECT_NE(left, right);
    const RegionAdjacencyGraph graph = graphOf(places);
    EXPECT_EQ(1u, graph.node(left).borders.count(right));
    return geometricEvidence(graph, left, right);
  };
  EXPECT_NEAR(0.0, evidence(walls), 1e-9);
  EXPECT_GE(evidence(desks), 0.9);
}

TEST(GeometricEvidence, NothingNarrowsABentCorridorAndADoorDoes) {
  OccupancyGrid grid = unseen(24, 24);
  cv::RNG random(3);
  for (int y = 0; y < grid.geometry.height; ++y)
    for (int x = 0; x < grid.geometry.width; ++x) {
      const double r = std::hypot(x * kCell - 12.0, y * kCell - 12.0) + random.uniform(-0.04, 0.04);
      const bool gone = y * kCell < 12.0 && x * kCell > 12.0;  // a quarter
      if (r > 7.9 && r < 10.1) grid.at({x, y}) = OccupancyGrid::kOccupied;
      if (r > 8.0 && r < 10.0 && !gone) grid.at({x, y}) = OccupancyGrid::kFree;
    }
  const PreparedBasins bent = prepareBasins(grid, {}, Preparation::kFull);
  EXPECT_TRUE(bent.context.corridors.corridors.empty());
  const RegionAdjacencyGraph ring = graphOf(bent);
  int borders = 0;
  for (int a = 1; a <= ring.size(); ++a)
    for (const auto& [b, index] : ring.node(a).borders) {
      if (b < a || ring.border(index).open <= 0.0) continue;
      ++borders;
      EXPECT_GT(ring.border(index).passage.evenness, 0.9) << a << ' ' << b;
      EXPECT_GT(geometricEvidence(ring, a, b), 0.25) << a << ' ' << b;
    }
  EXPECT_GE(borders, 1);
  EXPECT_EQ(1, segmentPlaces(grid).places);

  OccupancyGrid rooms = unseen(16, 10);
  room(rooms, 2, 2, 7, 8);
  room(rooms, 7.2, 2, 13, 8);
  fill(rooms, 7.0, 4.5, 7.2, 5.5, OccupancyGrid::kFree);
  const PreparedBasins places = prepareBasins(rooms, {}, Preparation::kFull);
  const RegionAdjacencyGraph graph = graphOf(places);
  const int left = basinAt(places, 4.5, 5.0), right = basinAt(places, 10.0, 5.0);
  ASSERT_EQ(1u, graph.node(left).borders.count(right));
  EXPECT_LT(graph.border(graph.node(left).borders.at(right)).passage.evenness, 0.5);
  EXPECT_NEAR(0.0, geometricEvidence(graph, left, right), 1e-9);
}

TEST(CorridorBasins, WhereTwoCorridorsCrossNothingPartsThem) {
  OccupancyGrid grid = unseen(32, 26);
  room(grid, 2, 12, 30, 14);
  room(grid, 15, 2, 17, 24);
  fill(grid, 15, 11.8, 17, 14.2, OccupancyGrid::kFree);
  room(grid, 17, 4, 22, 8);  // stands open, so that the basin of both is cut
  fill(grid, 16.8, 4, 17.2, 8, OccupancyGrid::kFree);
  const PreparedBasins places = prepareBasins(grid, {}, Preparation::kFull);
  ASSERT_EQ(2u, places.context.corridors.corridors.size());
  const int one = basinAt(places, 16.0, 13.0), open_room = basinAt(places, 20.0, 6.0);
  const int other = basinAt(places, 16.0, 10.0);
  ASSERT_NE(one, other);
  const RegionAdjacencyGraph graph = graphOf(places);
  ASSERT_EQ(1u, graph.node(one).borders.count(other));
  EXPECT_GT(geometricEvidence(graph, one, other), 0.5);
  ASSERT_EQ(1u, graph.node(other).borders.count(open_room));
  EXPECT_LT(geometricEvidence(graph, other, open_room), 0.0);
}

TEST(StraightCorridors, TheColumnsOfARowLeaveNoCellOut) {
  cv::RNG random(7);
  for (int round = 0; round < 200; ++round) {
    const auto at = [&random] {
      return cv::Point2d(random.uniform(-20.0, 120.0), random.uniform(-20.0, 80.0));
    };
    const cv::Point2d from = at();
    const double angle = round % 4 == 0 ? round * hyselam::kPi / 8.0 : random.uniform(0.0, 6.3);
    const double length = random.uniform(1.0, 100.0), beyond = random.uniform(0.0, 20.0);
    const StraightCorridor c(from, from + length * cv::Point2d(std::cos(angle), std::sin(angle)),
                             random.uniform(0.5, 20.0), 1.0);
    for (int y = 0; y < 60; ++y) {
      const auto [first, last] = c.columns(y, beyond, 100);
      ASSERT_GE(first, 0);
      ASSERT_LE(last, 100);
      for (int x = 0; x < 100; ++x) {
        const double far = c.beyond(cv::Point2d(x, y));
        if (far < 0.0 || far > beyond) continue;
        ASSERT_TRUE(first <= x && x < last) << x << ' ' << y;
      }
    }
  }
}

TEST(ChamferDistance, IsThatOfOpenCvBitForBit) {
  cv::RNG random(5);
  for (int round = 0; round < 200; ++round) {
    const cv::Size size(random.uniform(1, 70), random.uniform(1, 70));
    cv::Mat mask(size, CV_8U);
    random.fill(mask, cv::RNG::UNIFORM, 0, 256);
    mask = mask > random.uniform(0, 12);  // few zeros or many
    if (round % 2 == 0) cv::erode(mask, mask, {}, {-1, -1}, random.uniform(0, 3));
    mask.at<std::uint8_t>(random.uniform(0, size.height), random.uniform(0, size.width)) = 0;
    cv::Mat expected;
    cv::distanceTransform(mask, expected, cv::DIST_L2, cv::DIST_MASK_5);
    ASSERT_EQ(0, cv::norm(expected, chamferDistance(mask), cv::NORM_INF)) << round;
    const cv::Rect part(size.width / 3, size.height / 4, size.width / 2 + 1, size.height / 2 + 1);
    const cv::Mat within = mask(part & cv::Rect({0, 0}, size));
    if (cv::countNonZero(within) == static_cast<int>(within.total())) continue;
    cv::distanceTransform(within, expected, cv::DIST_L2, cv::DIST_MASK_5);
    ASSERT_EQ(0, cv::norm(expected, chamferDistance(within), cv::NORM_INF)) << round;
  }
}

namespace {

/// Two rooms, a passage of 3 m between them, and a corridor with doors, nothing symmetrical.
OccupancyGrid wing() {
  OccupancyGrid grid = unseen(30, 14);
  room(grid, 2, 2, 8, 7);
  room(grid, 8.2, 2, 15, 7);
  fill(grid, 8.0, 3.0, 8.2, 6.0, OccupancyGrid::kFree);
  room(grid, 2, 7.2, 28, 9.2);
  for (const double x : {4.0, 12.0, 20.0}) fill(grid, x, 7.0, x + 1.0, 7.2, OccupancyGrid::kFree);
  room(grid, 16, 2, 25, 7);
  return grid;
}

/// Turned by right angles.
OccupancyGrid turned(const OccupancyGrid& grid, int quarters) {
  if (quarters == 0) return grid;
  hyselam::GridGeometry g = grid.geometry;
  std::swap(g.width, g.height);
  OccupancyGrid out(g, OccupancyGrid::kUnknown);
  for (int y = 0; y < g.height; ++y)
    for (int x = 0; x < g.width; ++x) out.at({x, y}) = grid.at({y, g.width - 1 - x});
  return turned(out, quarters - 1);
}

}  // namespace

TEST(RobotMaps, ARightAngleChangesNothing) {
  const OccupancyGrid grid = wing();
  const auto figures = [](const OccupancyGrid& map) {
    const PreparedBasins places = prepareBasins(map, {}, Preparation::kFull);
    std::vector<double> lengths;
    for (const StraightCorridor& c : places.context.corridors.corridors)
      lengths.push_back(cv::norm(c.end() - c.start()));
    std::sort(lengths.begin(), lengths.end());
    return lengths;
  };
  const std::vector<double> lengths = figures(grid);
  ASSERT_FALSE(lengths.empty());
  const int places = segmentPlaces(grid).places;
  for (int quarters = 1; quarters < 4; ++quarters) {
    const OccupancyGrid other = turned(grid, quarters);
    const std::vector<double> others = figures(other);
    ASSERT_EQ(lengths.size(), others.size()) << quarters;
    for (std::size_t i = 0; i < lengths.size(); ++i) EXPECT_NEAR(lengths[i], others[i], 1.5);
    EXPECT_EQ(places, segmentPlaces(other).places) << quarters;
  }
}

TEST(RobotMaps, CoarserCellsGiveTheSamePlaces) {
  const OccupancyGrid grid = wing();
  const PlaceSegmentation fine_places = segmentPlaces(grid);
  for (const double factor : {1.1, 1.25, 1.4, 2.0}) {
    hyselam::GridGeometry g = grid.geometry;
    g.resolution *= factor;
    g.width = static_cast<int>(g.width / factor);
    g.height = static_cast<int>(g.height / factor);
    OccupancyGrid coarse(g, OccupancyGrid::kUnknown);
    const auto fine = [factor](int cell) { return static_cast<int>((cell + 0.5) * factor); };
    for (int y = 0; y < g.height; ++y)
      for (int x = 0; x < g.width; ++x) coarse.at({x, y}) = grid.at({fine(x), fine(y)});
    const PlaceSegmentation places = segmentPlaces(coarse);
    EXPECT_EQ(fine_places.places, places.places) << factor;
    int same = 0, both = 0, on_walls = 0;
    std::map<int, std::map<int, int>> shared;
    for (int y = 0; y < g.height; ++y)
      for (int x = 0; x < g.width; ++x) {
        const int a = fine_places.labels.at<std::uint16_t>(fine(y), fine(x));
        const int b = places.labels.at<std::uint16_t>(y, x);
        if (a != 0 && b != 0) ++shared[b][a], ++both;
        if (b != 0 && coarse.at({x, y}) == OccupancyGrid::kOccupied) ++on_walls;
      }
    for (const auto& [b, of_b] : shared) {
      int most = 0;
      for (const auto& [a, cells] : of_b) most = std::max(most, cells);
      same += most;
    }
    EXPECT_GT(same, 0.99 * both) << factor;
    EXPECT_EQ(0, on_walls) << factor;
  }
}

TEST(RobotMaps, ThreadsChangeNothing) {
  const OccupancyGrid grid = wing();
  cv::setNumThreads(1);
  const cv::Mat one = segmentPlaces(grid).labels;
  cv::setNumThreads(4);
  for (int round = 0; round < 5; ++round)
    EXPECT_EQ(0, cv::norm(one, segmentPlaces(grid).labels, cv::NORM_INF));
}

TEST(RobotMaps, ATinyMapAndMuchClutter) {
  for (const int size : {1, 2, 3, 12}) {
    hyselam::GridGeometry g;
    g.width = g.height = size;
    g.resolution = 0.05;
    SegmentationParams params;
    params.max_clutter_size = 5.0;
    params.min_place_area = 0.0;
    const PlaceSegmentation places = segmentPlaces(OccupancyGrid(g, OccupancyGrid::kFree), params);
    EXPECT_LE(places.places, 1) << size;
  }
}
