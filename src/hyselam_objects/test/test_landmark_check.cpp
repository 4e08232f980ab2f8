// A robot that is not where it believes to be sees hardly movable things in other places.
#include <gtest/gtest.h>

#include <cmath>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/rng.hpp"
#include "hyselam_objects/mapping/landmark_check.hpp"

using namespace hyselam_objects;  // NOLINT: a test, not a header

namespace {

/// A room with two pieces of furniture and five things, seen on many visits.
ObjectMap room() {
  ObjectMap map;
  const auto add = [&](double x, double y, double z, std::array<double, 3> size, float look) {
    ObjectInstance& object = *map.find(map.addObject("thing"));
    object.pose = ObjectPose{{x, y, z + 0.5 * size[2]}, size, 0.0, {}};
    object.descriptor = {look};
    object.existence = 0.99;
    object.detections = 20;
    for (int i = 0; i < 4; ++i) object.history.push_back({1000.0 * i, 1000.0 * i + 5, {x, y, z}});
    return object.id;
  };
  for (const auto& [x, y] : {std::pair<double, double>{2.0, 0.0}, {4.0, 2.5}}) {
    map.find(add(x, y, 0.0, {1.2, 0.8, 0.7}, 0.0f))->properties["furniture"] = "yes";
  }
  add(1.8, 0.2, 0.7, {0.1, 0.1, 0.12}, 1.0f);
  add(2.3, -0.2, 0.7, {0.1, 0.1, 0.12}, 1.0f);  // two that look the same
  add(3.8, 2.4, 0.7, {0.2, 0.1, 0.3}, 2.0f);
  add(4.3, 2.6, 0.7, {0.3, 0.2, 0.05}, 3.0f);
  add(0.5, 2.0, 0.0, {0.3, 0.3, 0.4}, 4.0f);
  return map;
}

/// What is seen of the map by a robot that believes to be off by (-x, -y).
std::vector<DetectedObject> see(const ObjectMap& map, double x, double y, double noise = 0.01) {
  hyselam::Rng rng(5);
  std::vector<DetectedObject> all;
  for (const ObjectInstance& object : map.objects) {
    const ObjectPose& pose = *object.pose;
    DetectedObject seen;
    seen.furniture = object.properties.count("furniture") != 0;
    const double part = seen.furniture ? 0.3 : 0.0;  // of a piece of furniture a part is seen
    const double nx = noise * rng.gaussian(), ny = noise * rng.gaussian();
    seen.low = {pose.position.x - 0.5 * pose.size[0] + part - x + nx,
                pose.position.y - 0.5 * pose.size[1] - y + ny,
                pose.position.z - 0.5 * pose.size[2]};
    seen.high = {pose.position.x + 0.5 * pose.size[0] - x + nx,
                 pose.position.y + 0.5 * pose.size[1] - y + ny,
                 pose.position.z + 0.5 * pose.size[2]};
    seen.descriptor = object.descriptor;
    all.push_back(seen);
  }
  return all;
}

}  // namespace

TEST(LandmarkCheck, DetectsOffsetOfAMeterInAnyDirection) {
  const ObjectMap map = room();
  for (int i = 0; i < 16; ++i) {
    const double angle = i * M_PI / 8.0, x = std::cos(angle), y = std::sin(angle);
    const LandmarkCheck check = checkLandmarks(map, see(map, x, y));
    EXPECT_EQ(check.verdict, LandmarkVerdict::kDisplaced) << i << " " << toString(check.verdict);
    EXPECT_NEAR(check.x, x, 0.1);
    EXPECT_NEAR(check.y, y, 0.1);
    EXPECT_GT(check.chi2, 3.0 * check.chi2_with_offset);
    EXPECT_EQ(check.compared, 7);
    EXPECT_EQ(check.inliers, 7);
  }
}

TEST(LandmarkCheck, ToleratesSmallPoseErrors) {
  const ObjectMap map = room();
  for (int i = 0; i < 16; ++i) {
    const double angle = i * M_PI / 8.0;
    const LandmarkCheck check =
        checkLandmarks(map, see(map, 0.08 * std::cos(angle), 0.08 * std::sin(angle)));
    EXPECT_EQ(check.verdict, LandmarkVerdict::kConsistent);
    EXPECT_LT(check.chi2, 3.0);
    EXPECT_EQ(check.x, 0.0);
  }
}

TEST(LandmarkCheck, ToleratesOneMovedAndOneNewObject) {
  ObjectMap map = room();
  std::vector<DetectedObject> seen = see(map, 0.0, 0.0);
  seen[4].low.x += 1.0;
  seen[4].high.x += 1.0;
  DetectedObject unknown = seen[5];
  unknown.descriptor = {9.0f};
  seen.push_back(unknown);
  const LandmarkCheck check = checkLandmarks(map, seen);
  EXPECT_EQ(check.verdict, LandmarkVerdict::kConsistent);
  EXPECT_EQ(check.compared, 7);
  EXPECT_EQ(check.inliers, 6);
}

TEST(LandmarkCheck, IsUnknownWithFewOrMovableObjects) {
  ObjectMap map = room();
  std::vector<DetectedObject> seen = see(map, 1.0, 0.0);
  seen.resize(2);
  EXPECT_EQ(checkLandmarks(map, seen).verdict, LandmarkVerdict::kUnknown);
  EXPECT_EQ(checkLandmarks(map, {}).verdict, LandmarkVerdict::kUnknown);
  for (ObjectInstance& object : map.objects) {
    object.properties.clear();
    object.pose->size = {0.1, 0.1, 0.1};
    object.history.resize(1);  // seen on one visit: nobody knows whether it stays
  }
  EXPECT_EQ(checkLandmarks(map, see(map, 1.0, 0.0)).verdict, LandmarkVerdict::kUnknown);
  LandmarkParams bad;
  bad.position_sigma = 0.0;
  EXPECT_THROW(checkLandmarks(map, {}, bad), hyselam::ParameterError);
}

TEST(LandmarkMonitor, CombinesFramesWithFewObjects) {
  const ObjectMap map = room();
  const std::vector<DetectedObject> seen = see(map, 0.0, 1.0);
  LandmarkMonitor watch;
  EXPECT_EQ(watch.add(map, {seen[4]}).verdict, LandmarkVerdict::kUnknown);
  EXPECT_EQ(watch.add(map, {seen[5]}).verdict, LandmarkVerdict::kUnknown);
  EXPECT_EQ(watch.add(map, {seen[6]}).verdict, LandmarkVerdict::kDisplaced);
  watch.clear();
  EXPECT_EQ(watch.add(map, {seen[6]}).verdict, LandmarkVerdict::kUnknown);
}
