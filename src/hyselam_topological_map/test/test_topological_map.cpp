#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "hyselam_topological_map/map_geometry.hpp"
#include "hyselam_topological_map/place_paths.hpp"
#include "hyselam_topological_map/topological_map.hpp"

namespace hyselam_topo {
namespace {

using hyselam::Point2;

double lengthOf(const std::vector<Point2>& line) {
  double length = 0.0;
  for (std::size_t i = 1; i < line.size(); ++i) {
    length += std::hypot(line[i].x - line[i - 1].x, line[i].y - line[i - 1].y);
  }
  return length;
}

TEST(MapGeometry, WallsAndDoorsKeepTheirEnds) {
  const Point2 a{1.0, 2.0}, b{4.0, -2.0};
  const auto wall = polyline(straightWall(a, b));
  ASSERT_EQ(wall.size(), 2u);
  const Segment door = ends(doorBetween(a, b));
  for (const auto& [first, second] : {Segment{wall[0], wall[1]}, door}) {
    EXPECT_NEAR(first.x, a.x, 1e-12);
    EXPECT_NEAR(first.y, a.y, 1e-12);
    EXPECT_NEAR(second.x, b.x, 1e-12);
    EXPECT_NEAR(second.y, b.y, 1e-12);
  }
  // Going east, north is on the left.
  EXPECT_EQ(straightWall({0, 0}, {1, 0}).normal.y, 1.0);
}

TEST(MapGeometry, CurvedWallIsAnArcAroundItsMassCenter) {
  for (const double curvature : {0.5, -0.5, 0.02, -1.9}) {
    Wall wall;
    wall.position = {3.0, -1.0, 0.0};
    wall.normal = {std::cos(0.7), std::sin(0.7), 0.0};
    wall.length = 3.0;
    wall.curvature = curvature;
    const auto line = polyline(wall, 1e-4);
    EXPECT_NEAR(lengthOf(line), 3.0, 0.003);
    // The mass centre of the drawn line.
    double x = 0.0, y = 0.0;
    for (std::size_t i = 1; i < line.size(); ++i) {
      const double piece = lengthOf({line[i - 1], line[i]});
      x += piece * 0.5 * (line[i].x + line[i - 1].x);
      y += piece * 0.5 * (line[i].y + line[i - 1].y);
    }
    EXPECT_NEAR(x / lengthOf(line), 3.0, 1e-3) << curvature;
    EXPECT_NEAR(y / lengthOf(line), -1.0, 1e-3) << curvature;
    // The normal points from the middle of the arc to the centre of the circle if curvature > 0.
    const Point2 middle = line[line.size() / 2];
    const double side =
        (wall.position.x - middle.x) * wall.normal.x + (wall.position.y - middle.y) * wall.normal.y;
    EXPECT_EQ(side > 0.0, curvature > 0.0) << curvature;
  }
}

TEST(MapGeometry, ArcGoesOverIntoAStraightWall) {
  Wall bent;
  bent.length = 4.0;
  Wall straight = bent;
  bent.curvature = 1e-4;
  const auto a = polyline(bent), b = polyline(straight);
  EXPECT_NEAR(a.front().y, b.front().y, 1e-3);
  EXPECT_NEAR(a.back().y, b.back().y, 1e-3);
}

AugmentedTopologicalMap mapWithGrid() {
  AugmentedTopologicalMap map;
  for (Id id = 1; id <= 3; ++id) {
    Place place;
    place.id = id;
    map.places.push_back(place);
  }
  PlaceGrid grid;
  grid.geometry = {4, 2, 0.5, {10.0, 20.0, hyselam::radians(90.0)}};
  grid.labels = {1, 1, 0, 2,  //
                 1, 1, 0, 2};
  grid.places = {1, 2};
  map.grid = grid;
  // A virtual place in the free-standing outline.
  map.places[2].outline = {{30, 30}, {32, 30}, {32, 32}, {30, 32}};
  map.places[2].area = 4.0;
  normalize(map);
  return map;
}

TEST(PlaceAt, FollowsTheGridThenTheOutlines) {
  const auto map = mapWithGrid();
  // Turned by 90 degrees: columns go along +y, rows along -x.
  const auto at = [&](double x, double y, double reach = 0.0) {
    const auto found = placeAt(map, {x, y}, reach);
    return found ? found->place : 0u;
  };
  EXPECT_EQ(at(9.75, 20.25), 1u);
  EXPECT_EQ(at(9.25, 20.75), 1u);
  EXPECT_EQ(at(9.75, 21.75), 2u);
  EXPECT_EQ(at(9.75, 21.25), 0u);
  EXPECT_EQ(at(9.75, 21.3, 1.0), 2u);
  EXPECT_EQ(at(9.75, 21.2, 1.0), 1u);
  EXPECT_EQ(at(31.0, 31.0), 3u);
  EXPECT_EQ(at(35.0, 31.0, 1.0), 0u);
  EXPECT_EQ(at(1e300, -1e300, 1.0), 0u);
  EXPECT_EQ(at(std::nan(""), 0.0, 1.0), 0u);
  EXPECT_NEAR(placeAt(map, {9.75, 21.3}, 1.0)->distance, 0.45, 1e-9);
  EXPECT_EQ(placeAt(map, {9.75, 20.25})->distance, 0.0);
  EXPECT_NE(at(1000.0, 1000.0, std::numeric_limits<double>::infinity()), 0u);
  EXPECT_EQ(placeAt(AugmentedTopologicalMap{}, {0, 0}, 5.0), std::nullopt);
}

TEST(PlaceAt, SmallestOutlineWins) {
  AugmentedTopologicalMap map;
  for (const double side : {10.0, 2.0, 20.0}) {
    Place place;
    place.id = map.next_place_id++;
    place.outline = {{-side, -side}, {side, -side}, {side, side}, {-side, side}};
    place.area = signedArea(place.outline);
    EXPECT_EQ(place.area, 4.0 * side * side);
    map.places.push_back(place);
  }
  EXPECT_EQ(placeAt(map, {1, 1})->place, 2u);
  EXPECT_EQ(placeAt(map, {3, 1})->place, 1u);
}

TEST(Ways, GoAroundCornersAndStayInThePlace) {
  // A horseshoe: from one end to the other there are two corners.
  const std::vector<std::string> rows = {"aaaaaaaaa",  //
                                         "aaaaaaaaa",  //
                                         "aa.....aa",  //
                                         "aa..b..aa",  //
                                         "aa.....aa"};
  PlaceGrid grid;
  grid.geometry.width = 9;
  grid.geometry.height = 5;
  grid.geometry.resolution = 0.5;
  grid.geometry.origin = {3.0, -1.0, 0.4};
  for (auto row = rows.rbegin(); row != rows.rend(); ++row) {
    for (const char c : *row) grid.labels.push_back(c == 'a' ? 1 : c == 'b' ? 2 : 0);
  }
  grid.places = {7, 9};
  const auto at = [&](double x, double y) { return grid.geometry.origin * Point2{x, y}; };
  const auto boxes = placeBoxes(grid);
  ASSERT_EQ(boxes.size(), 2u);
  EXPECT_EQ(boxes.at(9).x_begin, 4);
  EXPECT_EQ(boxes.at(9).y_begin, 1);
  EXPECT_EQ(boxes.at(9).x_end, 5);
  EXPECT_EQ(boxes.at(9).y_end, 2);
  const auto ways = waysWithin(grid, 7, boxes.at(7),
                               {at(0.25, 0.25), at(0.25, 2.25), at(-5.0, 0.25)}, at(4.25, 0.25));
  ASSERT_EQ(ways.size(), 3u);
  EXPECT_GE(ways[0].size(), 4u);
  EXPECT_GT(lengthOf(ways[0]), 5.5);  // 4 m as the crow flies
  EXPECT_LT(lengthOf(ways[0]), 8.0);
  EXPECT_LT(lengthOf(ways[1]), lengthOf(ways[0]));
  EXPECT_NEAR(lengthOf(ways[2]), lengthOf(ways[0]), 1e-9);  // from the nearest cell
  for (const auto& way : ways) {
    for (const Point2& corner : way) {
      EXPECT_EQ(grid.placeOf(grid.geometry.cellAt(corner)), 7u);
    }
  }
  EXPECT_TRUE(waysWithin(grid, 8, boxes.at(7), {at(1, 1)}, at(2, 1))[0].empty());
}

TEST(TopologicalMap, NormalizeSortsAndTurnsDoors) {
  AugmentedTopologicalMap map;
  for (const Id id : {7u, 3u}) {
    Place place;
    place.id = id;
    map.places.push_back(place);
  }
  Edge edge;
  edge.a = 7;
  edge.b = 3;
  edge.doors = {doorBetween({0, 0}, {1, 0})};
  edge.doors[0].id = 4;
  map.edges = {edge};
  normalize(map);
  EXPECT_EQ(map.places[0].id, 3u);
  EXPECT_EQ(map.next_place_id, 8u);
  EXPECT_EQ(map.next_door_id, 5u);
  EXPECT_EQ(map.edges[0].a, 3u);
  EXPECT_EQ(map.edges[0].doors[0].normal.y, -1.0);
  EXPECT_NO_THROW(checkMap(map, "map"));
  EXPECT_EQ(map.findEdge(7, 3), &map.edges[0]);
  EXPECT_EQ(map.findPlace(7), &map.places[1]);
  EXPECT_EQ(map.findPlace(8), nullptr);
}

}  // namespace
}  // namespace hyselam_topo
