#include <gtest/gtest.h>

#include <cmath>

#include "hyselam_common/errors.hpp"
#include "hyselam_topo/dialogue/glass_wall.hpp"
#include "two_rooms.hpp"

using hyselam::OccupancyGrid;
using hyselam::Point2;
using hyselam::Pose2;
using hyselam_topo::GlassWallSearch;
using hyselam_topo::Side;
using hyselam_topo::WallLine;

namespace {

/// A corridor along x, 2.4 m wide and 16 m long, in a grid with cells of 0.05 m that may be turned.
/// In both walls there are gaps where the laser looks through glass.
struct Corridor {
  OccupancyGrid grid;
  Pose2 frame;

  explicit Corridor(const Pose2& frame_in_map = {}) : frame(frame_in_map) {
    hyselam::GridGeometry g;
    g.resolution = 0.05;
    g.width = 400;
    g.height = 200;
    g.origin = frame_in_map * Pose2{-2.0, -5.0, 0.0};
    grid = OccupancyGrid(g, OccupancyGrid::kFree);
    box(0.0, 1.2, 16.0, 1.4);
    box(0.0, -1.4, 16.0, -1.2);
    box(-0.2, -1.4, 0.0, 1.4);
    box(16.0, -1.4, 16.2, 1.4);
  }

  void box(double x0, double y0, double x1, double y1,
           std::int8_t value = OccupancyGrid::kOccupied) {
    for (int y = 0; y < grid.geometry.height; ++y) {
      for (int x = 0; x < grid.geometry.width; ++x) {
        const Point2 p = frame.inverse() * grid.geometry.center({x, y});
        if (p.x > x0 && p.x < x1 && p.y > y0 && p.y < y1) grid.at({x, y}) = value;
      }
    }
  }
  void glassOnTheLeft(double from, double to) { box(from, 1.15, to, 1.45, OccupancyGrid::kFree); }
  void glassOnTheRight(double from, double to) {
    box(from, -1.45, to, -1.15, OccupancyGrid::kFree);
  }
  Pose2 at(double x, double y, double theta) const { return frame * Pose2{x, y, theta}; }
  /// In the corridor's own frame, from the lower x to the higher.
  WallLine own(const WallLine& wall) const {
    WallLine w{frame.inverse() * wall.a, frame.inverse() * wall.b};
    if (w.a.x > w.b.x) std::swap(w.a, w.b);
    return w;
  }
};

void expectAt(const std::optional<WallLine>& found, const Corridor& c, double from, double to,
              double y) {
  ASSERT_TRUE(found);
  const WallLine w = c.own(*found);
  EXPECT_NEAR(w.a.x, from, 0.2);
  EXPECT_NEAR(w.b.x, to, 0.2);
  EXPECT_NEAR(w.a.y, y, 0.2);
  EXPECT_NEAR(w.b.y, y, 0.2);
}

}  // namespace

TEST(GlassWall, IsFoundOnTheDescribedSide) {
  Corridor c;
  c.glassOnTheLeft(4.0, 5.35);
  c.glassOnTheRight(5.0, 8.58);
  const GlassWallSearch left(c.grid, c.at(4.5, 0.0, 0.0), Side::kLeft);
  expectAt(left.likeliest(), c, 4.0, 5.35, 1.3);
  EXPECT_NEAR(left.likeliest()->length(), 1.35, 0.1);
  EXPECT_NEAR(left.likeliest()->distanceTo({4.5, 0.0}), 1.2, 0.1);
  const GlassWallSearch right(c.grid, c.at(6.0, 0.0, 0.0), Side::kRight);
  expectAt(right.likeliest(), c, 5.0, 8.58, -1.3);
  // Looking back, left is right; the front and the back are those of a robot that looks across.
  expectAt(GlassWallSearch(c.grid, c.at(4.5, 0.0, hyselam::kPi), Side::kRight).likeliest(), c, 4.0,
           5.35, 1.3);
  expectAt(GlassWallSearch(c.grid, c.at(4.5, 0.0, 0.5 * hyselam::kPi), Side::kFront).likeliest(), c,
           4.0, 5.35, 1.3);
  expectAt(GlassWallSearch(c.grid, c.at(4.5, 0.0, -0.5 * hyselam::kPi), Side::kBack).likeliest(), c,
           4.0, 5.35, 1.3);
}

TEST(GlassWall, IsFoundInATurnedMapFromManyPlaces) {
  for (const double turn : {0.0, 0.3, 1.1, -2.0}) {
    Corridor c({3.0, -7.0, turn});
    c.glassOnTheLeft(7.0, 8.5);
    for (double x = 7.0; x <= 8.5; x += 0.25) {
      for (const double y : {-0.6, 0.0, 0.6}) {
        const GlassWallSearch search(c.grid, c.at(x, y, 0.2), Side::kLeft);
        SCOPED_TRACE(::testing::Message() << turn << " " << x << " " << y);
        expectAt(search.likeliest(), c, 7.0, 8.5, 1.3);
      }
    }
  }
}

TEST(GlassWall, IsNotFoundInPlainWallsAndInnerCorners) {
  Corridor c;
  for (const double x : {1.0, 8.0, 15.0}) {
    for (const Side side : {Side::kLeft, Side::kRight, Side::kFront, Side::kBack}) {
      const GlassWallSearch search(c.grid, c.at(x, 0.1, 0.05), side);
      EXPECT_TRUE(search.corners().empty()) << x;
      EXPECT_FALSE(search.likeliest());
      EXPECT_FALSE(search.ofLength(1.0));
    }
  }
}

TEST(GlassWall, AfterNoTheDescribedLengthDecides) {
  Corridor c;
  c.glassOnTheLeft(6.0, 6.9);  // an open door, nearer
  c.glassOnTheLeft(8.0, 10.0);
  GlassWallSearch search(c.grid, c.at(6.4, 0.0, 0.0), Side::kLeft);
  const auto first = search.likeliest();
  expectAt(first, c, 6.0, 6.9, 1.3);
  search.reject(*first);
  expectAt(search.ofLength(2.1), c, 8.0, 10.0, 1.3);
  EXPECT_FALSE(*search.likeliest() == *first);
}

TEST(GlassWall, ThinWallsOfALaserMapHaveCornersToo) {
  Corridor c;
  c.box(-1.0, 1.15, 17.0, 1.45, OccupancyGrid::kFree);
  c.box(0.0, 1.2, 5.0, 1.25);
  c.box(6.6, 1.2, 16.0, 1.25);
  expectAt(GlassWallSearch(c.grid, c.at(6.0, 0.0, 0.0), Side::kLeft).likeliest(), c, 5.0, 6.6,
           1.22);
}

TEST(GlassWall, RefusesInvalidInput) {
  Corridor c;
  EXPECT_THROW(GlassWallSearch(c.grid, c.at(6.0, 0.0, 0.0), Side::kUnknown), hyselam::InputError);
  EXPECT_THROW(GlassWallSearch(c.grid, c.at(600.0, 0.0, 0.0), Side::kLeft), hyselam::InputError);
  EXPECT_THROW(GlassWallSearch(c.grid, {std::nan(""), 0.0, 0.0}, Side::kLeft), hyselam::InputError);
  hyselam_topo::GlassWallParams params;
  params.max_length = params.min_length;
  EXPECT_THROW(GlassWallSearch(c.grid, c.at(6.0, 0.0, 0.0), Side::kLeft, params),
               hyselam::ParameterError);
}

TEST(GlassWall, DrawnWallsBlockEveryPath) {
  for (const double turn : {0.0, 0.4, 0.8, 2.5}) {
    Corridor c({0.0, 0.0, turn});
    c.glassOnTheLeft(6.0, 8.0);
    OccupancyGrid copy = c.grid;
    const auto found = GlassWallSearch(c.grid, c.at(7.0, 0.0, 0.0), Side::kLeft).likeliest();
    ASSERT_TRUE(found);
    hyselam_topo::drawWalls({*found}, &copy);
    // All cells that are reached from the corridor by 8 neighbours.
    const auto& g = copy.geometry;
    std::vector<hyselam::Cell> front{g.cellAt(c.frame * Point2{7.0, 0.0})};
    std::vector<bool> reached(g.cellCount());
    reached[g.index(front[0])] = true;
    for (std::size_t i = 0; i < front.size(); ++i) {
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
          const hyselam::Cell n{front[i].x + dx, front[i].y + dy};
          if (copy.valueOr(n, 100) >= 65 || reached[g.index(n)]) continue;
          reached[g.index(n)] = true;
          front.push_back(n);
        }
      }
    }
    const auto beyond = g.cellAt(c.frame * Point2{7.0, 2.0});
    EXPECT_FALSE(reached[g.index(beyond)]) << turn;
  }
  // What lies outside is left out.
  Corridor c;
  hyselam_topo::drawWalls({{{-100.0, 0.0}, {1000.0, 0.0}}, {{1e30, 0.0}, {0.0, 0.0}}}, &c.grid);
}

TEST(GlassWall, LimitsThePlacesOnItsSides) {
  auto map = two_rooms::map();
  const WallLine between{{4.05, 0.1}, {4.05, 0.9}};
  hyselam_topo::putWall({between, hyselam_topo::WallKind::kGlass}, &map);
  ASSERT_EQ(map.places[0].walls.size(), 1u);
  ASSERT_EQ(map.places[1].walls.size(), 1u);
  EXPECT_EQ(map.places[0].walls[0].kind, hyselam_topo::WallKind::kGlass);
  EXPECT_LT(map.places[0].walls[0].normal.x, -0.9);
  EXPECT_GT(map.places[1].walls[0].normal.x, 0.9);
  EXPECT_NO_THROW(hyselam_topo::checkMap(map, "map"));
  const auto once = map;
  hyselam_topo::putWall({between, hyselam_topo::WallKind::kGlass}, &map);
  EXPECT_TRUE(map == once);
}
