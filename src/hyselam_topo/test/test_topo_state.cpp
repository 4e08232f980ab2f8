#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "hyselam_common/errors.hpp"
#include "hyselam_topo/dialogue/place_pose.hpp"
#include "hyselam_topo/dialogue/topo_state.hpp"
#include "hyselam_topological_map/map_geometry.hpp"
#include "two_rooms.hpp"

using hyselam::Pose2;
using hyselam_topo::TopoState;

namespace {

// Place 1: x 0 .. 4, place 2: x 4.1 .. 8.1; the door at (4.05, 1.5), 0.9 m wide.
const hyselam_topo::AugmentedTopologicalMap kMap = two_rooms::map();

}  // namespace

TEST(TopoState, KnowsThePlaceOfAPose) {
  TopoState state;
  EXPECT_EQ(state.robot().place, 0u);
  EXPECT_TRUE(state.update(kMap, 1.0, {2.0, 1.0, 0.3}));
  EXPECT_EQ(state.robot().place, 1u);
  EXPECT_FALSE(state.robot().in_doorway);
  EXPECT_FALSE(state.update(kMap, 2.0, {2.1, 1.0, 0.3}));
  EXPECT_DOUBLE_EQ(state.robot().stamp, 2.0);
}

TEST(TopoState, HoldsThePlaceInTheDoorwayAndChangesItWellInside) {
  TopoState state;
  double t = 0.0;
  for (double x = 3.0; x < 3.6; x += 0.05) state.update(kMap, t += 0.1, {x, 1.5, 0.0});
  EXPECT_EQ(state.robot().place, 1u);
  EXPECT_FALSE(state.robot().in_doorway);
  for (double x = 3.7; x < 4.4; x += 0.05) {
    state.update(kMap, t += 0.1, {x, 1.5, 0.0});
    EXPECT_EQ(state.robot().place, 1u) << x;
    EXPECT_TRUE(state.robot().in_doorway) << x;
  }
  // Back and forth on the threshold nothing changes.
  for (int i = 0; i < 20; ++i) state.update(kMap, t += 0.1, {i % 2 == 0 ? 4.3 : 3.8, 1.5, 0.0});
  EXPECT_EQ(state.robot().place, 1u);
  state.update(kMap, t += 0.1, {4.6, 1.5, 0.0});
  EXPECT_EQ(state.robot().place, 2u);
  EXPECT_EQ(state.robot().previous, 1u);
  EXPECT_FALSE(state.robot().in_doorway);
}

TEST(TopoState, AcceptsAPlaceAfterSettleTime) {
  TopoState state;
  state.update(kMap, 0.0, {3.8, 1.5, 0.0});
  state.update(kMap, 1.0, {4.3, 1.5, 0.0});
  state.update(kMap, 3.0, {4.3, 1.5, 0.0});
  EXPECT_EQ(state.robot().place, 1u);
  state.update(kMap, 4.5, {4.3, 1.5, 0.0});
  EXPECT_EQ(state.robot().place, 2u);
}

TEST(TopoState, NoDoorwayHoldsAKidnappedRobot) {
  TopoState state;
  state.update(kMap, 0.0, {1.0, 1.5, 0.0});
  state.update(kMap, 0.1, {4.3, 1.5, 0.0});
  EXPECT_EQ(state.robot().place, 2u);
}

TEST(TopoState, DoesNotKnowThePlaceOutsideOrWithoutAPose) {
  TopoState state;
  state.update(kMap, 0.0, {2.0, 1.5, 0.0});
  EXPECT_TRUE(state.update(kMap, 1.0, {50.0, 1.5, 0.0}));
  EXPECT_EQ(state.robot().place, 0u);
  EXPECT_EQ(state.robot().previous, 1u);
  state.update(kMap, 2.0, {2.0, 1.5, 0.0});
  EXPECT_EQ(state.robot().place, 1u);
  EXPECT_TRUE(state.update(kMap, 3.0, {std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0}));
  EXPECT_EQ(state.robot().place, 0u);
  EXPECT_FALSE(state.lost(4.0));
}

TEST(TopoState, ForgetsAPlaceThatLeavesTheMap) {
  TopoState state;
  state.update(kMap, 0.0, {2.0, 1.5, 0.0});
  auto other = kMap;
  EXPECT_FALSE(state.mapChanged(other));
  other.places.erase(other.places.begin());
  other.edges.clear();
  EXPECT_TRUE(state.mapChanged(other));
  EXPECT_EQ(state.robot().place, 0u);
}

TEST(TopoState, RefusesParametersOutOfRange) {
  EXPECT_THROW(TopoState({-1.0, 0.3, 3.0, 1.0}), hyselam::ParameterError);
  EXPECT_THROW(TopoState({0.4, std::nan(""), 3.0, 1.0}), hyselam::ParameterError);
  EXPECT_THROW(TopoState({0.4, 0.3, 3.0, 0.0}), hyselam::ParameterError);
}

TEST(PlacePose, LiesInsideFarFromTheWallsAndLooksInside) {
  const auto pose = hyselam_topo::placePose(kMap, 2);
  ASSERT_TRUE(pose);
  EXPECT_EQ(hyselam_topo::placeAt(kMap, {pose->pose.x, pose->pose.y})->place, 2u);
  EXPECT_GT(pose->clearance, 0.9);
  EXPECT_NEAR(pose->pose.x, 6.1, 0.1);
  EXPECT_NEAR(pose->pose.y, 1.5, 0.1);
  EXPECT_NEAR(pose->pose.theta, 0.0, 0.1);  // the door is at its left
  // Of a rectangle of 4 by 3 m.
  EXPECT_NEAR(pose->covariance[0], 16.0 / 12.0, 0.05);
  EXPECT_NEAR(pose->covariance[4], 9.0 / 12.0, 0.05);
  EXPECT_NEAR(pose->covariance[1], 0.0, 0.05);
  EXPECT_NEAR(pose->covariance[8], std::pow(hyselam::kPi, 2) / 3.0, 1e-9);
}

TEST(PlacePose, NoneOfAPlaceThatDoesNotExist) {
  EXPECT_FALSE(hyselam_topo::placePose(kMap, 7));
  auto told = kMap;
  told.places.push_back({});
  told.places.back().id = 9;
  EXPECT_FALSE(hyselam_topo::placePose(told, 9));
  told.places.back().centre = hyselam_topo::Point3{1.0, 2.0, 0.0};
  ASSERT_TRUE(hyselam_topo::placePose(told, 9));
  EXPECT_DOUBLE_EQ(hyselam_topo::placePose(told, 9)->pose.y, 2.0);
}
