// Outlines of objects: boxes that are turned, views that are combined, relations of turned boxes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "hyselam_common/pose2.hpp"
#include "hyselam_common/rng.hpp"
#include "hyselam_objects/mapping/object_relations.hpp"
#include "hyselam_objects/mapping/outline.hpp"

namespace hyselam_objects {
namespace {

/// Points of a rectangle, all over it; `from`, `until`: only this share of its length.
std::vector<Eigen::Vector2f> pointsOf(const GroundBox& box, double from = 0.0, double until = 1.0) {
  std::vector<Eigen::Vector2f> points;
  const double c = std::cos(box.yaw), s = std::sin(box.yaw);
  for (int i = 0; i <= 40; ++i) {
    for (int k = 0; k <= 40; ++k) {
      const double u = (from + (until - from) * i / 40.0 - 0.5) * box.length;
      const double v = (k / 40.0 - 0.5) * box.width;
      points.emplace_back(static_cast<float>(box.x + c * u - s * v),
                          static_cast<float>(box.y + s * u + c * v));
    }
  }
  return points;
}

bool isWithin(const GroundBox& box, double x, double y) {
  const double c = std::cos(box.yaw), s = std::sin(box.yaw), dx = x - box.x, dy = y - box.y;
  return std::abs(c * dx + s * dy) <= 0.5 * box.length &&
         std::abs(c * dy - s * dx) <= 0.5 * box.width;
}

GroundBox draw(hyselam::Rng& rng) {
  return {rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0), rng.uniform(0.2, 1.0),
          rng.uniform(0.1, 0.8), rng.uniform(-0.75, 0.75)};
}

}  // namespace

TEST(Outline, GivesTheBoxOfATurnedRectangle) {
  for (int degrees = -42; degrees <= 42; ++degrees) {
    const GroundBox box{2.0, -1.0, 0.4, 0.2, hyselam::radians(degrees)};
    const GroundBox found = boxAround(outlineOf(pointsOf(box), 0.0));
    EXPECT_NEAR(found.x, 2.0, 1e-3) << degrees;
    EXPECT_NEAR(found.y, -1.0, 1e-3) << degrees;
    // Directions are 5 degrees apart, and what gains little by being turned is not: up to 3
    // degrees.
    EXPECT_NEAR(found.yaw, box.yaw, hyselam::radians(3.1)) << degrees;
    EXPECT_NEAR(found.length, 0.4, 0.011) << degrees;
    EXPECT_NEAR(found.width, 0.2, 0.021) << degrees;
  }
}

TEST(Outline, DoesNotTurnWhatIsRound) {
  hyselam::Rng rng(1);
  std::vector<Eigen::Vector2f> points;
  for (int i = 0; i < 500; ++i) {
    const double angle = rng.uniform(0.0, 2.0 * hyselam::kPi);
    const double radius = 0.1 * std::sqrt(rng.uniform());
    points.emplace_back(static_cast<float>(1.0 + radius * std::cos(angle)),
                        static_cast<float>(radius * std::sin(angle)));
  }
  const GroundBox found = boxAround(outlineOf(points, 0.0));
  EXPECT_EQ(found.yaw, 0.0);
  EXPECT_NEAR(found.length, 0.2, 0.01);
  EXPECT_NEAR(found.width, 0.2, 0.01);
}

TEST(Outline, LeavesOutTheShareThatReachesFarthest) {
  const GroundBox box{0.0, 0.0, 0.3, 0.3, 0.0};
  std::vector<Eigen::Vector2f> points = pointsOf(box);
  for (int i = 0; i < 20; ++i) points.emplace_back(1.0f, 0.0f);  // of what is behind: 1.2 %
  EXPECT_GT(boxAround(outlineOf(points, 0.0)).length, 1.0);
  EXPECT_NEAR(boxAround(outlineOf(points, 0.02)).length, 0.3, 0.02);
  EXPECT_TRUE(outlineOf(std::vector<Eigen::Vector2f>(), 0.0).empty());
}

TEST(Outline, ViewsOfBothHalvesGiveTheWhole) {
  const GroundBox box{1.0, 1.0, 0.5, 0.2, hyselam::radians(30.0)};
  Outline known;
  for (int i = 0; i < 60; ++i) {
    addView(known, outlineOf(i % 2 == 0 ? pointsOf(box, 0.0, 0.6) : pointsOf(box, 0.4, 1.0), 0.0),
            0.1);
  }
  const GroundBox found = boxAround(known);
  EXPECT_NEAR(found.length, 0.5, 0.12) << "a single view has 0.3";
  EXPECT_GT(found.length, 0.38);
  EXPECT_NEAR(found.x, 1.0, 0.03);
  Outline both = outlineOf(pointsOf(box, 0.0, 0.6), 0.0);
  unite(both, outlineOf(pointsOf(box, 0.4, 1.0), 0.0));
  EXPECT_NEAR(boxAround(both).length, 0.5, 1e-3);
  shift(both, 0.5, -2.0);
  EXPECT_NEAR(boxAround(both).x, 1.5, 1e-3);
  EXPECT_NEAR(boxAround(both).y, -1.0, 1e-3);
}

TEST(Outline, AreasAndGapsAreThoseOfManyPoints) {
  hyselam::Rng rng(2);
  int apart = 0;
  for (int i = 0; i < 60; ++i) {
    const GroundBox a = draw(rng), b = draw(rng);
    constexpr double kStep = 0.01;
    double area = 0.0, gap = 1e9;
    for (double x = -2.0; x < 2.0; x += kStep) {
      for (double y = -2.0; y < 2.0; y += kStep) {
        area += isWithin(a, x, y) && isWithin(b, x, y) ? kStep * kStep : 0.0;
      }
    }
    for (const Eigen::Vector2f& p : pointsOf(a)) {
      for (const Eigen::Vector2f& q : pointsOf(b)) {
        gap = std::min(gap, static_cast<double>((p - q).norm()));
      }
    }
    EXPECT_NEAR(commonArea(a, b), area, 0.02) << i;
    EXPECT_NEAR(commonArea(a, b), commonArea(b, a), 1e-9) << i;
    EXPECT_NEAR(gapBetween(a, b), gap, 0.03) << i;
    EXPECT_NEAR(gapBetween(a, b), gapBetween(b, a), 1e-9) << i;
    apart += gap > 0.05;
  }
  EXPECT_GT(apart, 10);
  EXPECT_LT(apart, 50);
}

namespace {

Id add(ObjectMap& map, const GroundBox& ground, double low, double height) {
  const Id id = map.addObject("thing");
  ObjectInstance& object = *map.find(id);
  object.existence = 0.99;
  object.detections = 10;
  object.pose = ObjectPose{{ground.x, ground.y, low + 0.5 * height},
                           {ground.length, ground.width, height},
                           ground.yaw,
                           {}};
  return id;
}

bool isSaid(const ObjectMap& map, Id a, RelationWord word, Id b) {
  const auto all = map.relationsOf(a);
  return std::any_of(all.begin(), all.end(),
                     [&](const auto* r) { return r->word == word && r->other == b; });
}

}  // namespace

TEST(Relations, AreThoseOfTurnedBoxes) {
  const double turned = hyselam::radians(45.0);
  ObjectMap map;
  // Two long boxes side by side at 45 degrees; the boxes around them overlap.
  const Id a = add(map, {0.0, 0.0, 0.9, 0.1, turned}, 0.0, 0.1);
  const Id b = add(map, {0.45, -0.45, 0.9, 0.1, turned}, 0.0, 0.1);
  const Id c = add(map, {0.2, -0.2, 0.9, 0.1, turned}, 0.0, 0.1);
  updateRelations(map);
  EXPECT_FALSE(isSaid(map, a, RelationWord::kNear, b)) << "0.54 m apart";
  EXPECT_TRUE(isSaid(map, a, RelationWord::kNear, c)) << "0.18 m apart";
  // Over the corner of the box around a turned table there is no table.
  const Id table = add(map, {5.0, 0.0, 1.4, 0.6, turned}, 0.0, 0.7);
  const Id on = add(map, {5.35, 0.35, 0.1, 0.1, 0.0}, 0.7, 0.1);
  const Id beside = add(map, {5.5, -0.45, 0.1, 0.1, 0.0}, 0.7, 0.1);
  const Id in = add(map, {4.8, -0.2, 0.2, 0.1, turned}, 0.2, 0.1);
  updateRelations(map);
  EXPECT_TRUE(isSaid(map, on, RelationWord::kOn, table));
  EXPECT_FALSE(isSaid(map, beside, RelationWord::kOn, table));
  EXPECT_TRUE(isSaid(map, in, RelationWord::kInside, table));
}

}  // namespace hyselam_objects
