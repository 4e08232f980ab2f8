// What only the present has: how it is learnt, forgotten and left out, and that a pose is tracked
// without it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "drawn_room.hpp"
#include "fsd_localization/localizer.hpp"
#include "fsd_localization/search/short_term_layer.hpp"

using namespace fsd_localization;  // NOLINT: a test, not a header
using hyselam::Point2;
using hyselam::Pose2;

TEST(ShortTermLayer, whatIsSeenAgainBesideTheMapIsOfThePresent) {
  ShortTermLayer layer;
  const Point2 thing{-2.03, 1.53}, wall{3.0, -4.0};
  for (int i = 0; i < ShortTermLayer::kSeen; ++i) {
    EXPECT_FALSE(layer.isOfThePresent(thing)) << "seen " << i << " times";
    layer.add({thing, wall}, {false, true}, 0.1 * i);
  }
  EXPECT_TRUE(layer.isOfThePresent(thing));
  EXPECT_FALSE(layer.isOfThePresent(wall));
  EXPECT_FALSE(layer.isOfThePresent({thing.x + 0.3, thing.y}));
  ASSERT_EQ(layer.points().size(), 1U);
  EXPECT_NEAR(layer.points()[0].x, thing.x, 0.05);
  EXPECT_NEAR(layer.points()[0].y, thing.y, 0.05);
  for (int i = 0; i < 10; ++i) layer.add({thing}, {true}, 1.0);  // the map has it after all
  EXPECT_FALSE(layer.isOfThePresent(thing));
}

TEST(ShortTermLayer, forgetsWhatIsFarBack) {
  ShortTermLayer layer;
  const Point2 thing{1.0, 1.0}, elsewhere{9.0, 9.0};
  for (int i = 0; i < 5; ++i) layer.add({thing}, {false}, 0.1 * i);
  layer.add({elsewhere}, {false}, ShortTermLayer::kKept - 1.0);
  EXPECT_TRUE(layer.isOfThePresent(thing));
  layer.add({elsewhere}, {false}, ShortTermLayer::kKept + 6.0);
  EXPECT_FALSE(layer.isOfThePresent(thing));
  layer.clear();
  EXPECT_TRUE(layer.empty());
}

TEST(ShortTermLayer, leavesOutItsReturnsFromAnywhereAndNoOthers) {
  hyselam::LaserScan scan;
  scan.angle_min = 0.0;
  scan.angle_increment = hyselam::kPi / 2;
  scan.range_max = 10.0;
  scan.ranges = {2.0F, 3.0F, 10.0F};  // ahead, to the left, nothing behind
  scan.laser_in_base = {0.2, 0.0, 0.0};
  const Pose2 base{1.0, -1.0, 0.5};
  ShortTermLayer layer;
  const auto ends = ShortTermLayer::endsOf(scan, base, 30.0);
  ASSERT_EQ(ends.size(), 2U);
  EXPECT_NEAR(ends[0].x, 1.0 + 2.2 * std::cos(0.5), 1e-9);
  for (int i = 0; i < 3; ++i) layer.add(ends, {false, true}, 0.0);
  const hyselam::LaserScan rest = layer.without(scan, base);
  EXPECT_TRUE(std::isnan(rest.ranges[0]));
  EXPECT_EQ(rest.ranges[1], 3.0F);
  EXPECT_EQ(rest.ranges[2], 10.0F);
  const Pose2 closer = base * Pose2{1.0, 0.0, 0.0};
  scan.ranges[0] = 1.0F;
  EXPECT_TRUE(std::isnan(layer.without(scan, closer).ranges[0]));
  EXPECT_EQ(layer.without(scan, base).ranges[0], 1.0F) << "something else, before it";
}

namespace {

/// A robot that circles in a room where a wide thing stands that the map does not have.
struct Circling {
  explicit Circling(bool with_layer) : localizer(room(), paramsOf(with_layer)) {
    auto world = room();
    for (int y = 30; y < 60; ++y) {
      for (int x = 80; x < 84; ++x) world.at({x, y}) = 100;
    }
    rays = std::make_unique<GridRayCaster>(world);
    localizer.setInitialPose(at, {0.1, 0.1, 0.05});
  }
  static LocalizerParams paramsOf(bool with_layer) {
    LocalizerParams params;
    params.short_term_layer = with_layer;
    return params;
  }
  void drive(int scans) {
    for (int i = 0; i < scans; ++i) {
      at = at * Pose2{0.03, 0.0, 0.025};
      if (const auto r = localizer.update(look(*rays, at, 0.1 * ++count), at)) last = r;
    }
  }

  Localizer localizer;
  std::unique_ptr<GridRayCaster> rays;
  Pose2 at{5.0, 2.5, 0.0};
  int count = 0;
  std::optional<LocalizationResult> last;
};

}  // namespace

TEST(Localizer, learnsWhatTheMapLacksWhileItTracksAndForgetsItWhenItSearches) {
  Circling with(true), without(false);
  for (Circling* c : {&with, &without}) c->drive(300);
  ASSERT_TRUE(with.last && without.last);
  EXPECT_EQ(with.last->phase, Phase::kTracking);
  EXPECT_LT(distance(with.last->base_in_map, with.at), 0.15);
  EXPECT_TRUE(without.localizer.shortTermPoints(without.last->base_in_map).empty());
  const auto points = with.localizer.shortTermPoints(with.last->base_in_map);
  EXPECT_GT(points.size(), 10U);
  for (const Point2& p : points) {
    EXPECT_TRUE(p.x > 7.7 && p.x < 8.7 && p.y > 2.7 && p.y < 6.3)
        << "the map has what is at " << p.x << ' ' << p.y;
  }
  with.localizer.relocalizeGlobally();
  EXPECT_TRUE(with.localizer.shortTermPoints(with.last->base_in_map).empty());
}
