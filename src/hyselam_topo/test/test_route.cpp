#include <gtest/gtest.h>

#include <cmath>

#include "hyselam_common/errors.hpp"
#include "hyselam_topo/dialogue/route.hpp"
#include "hyselam_topological_map/map_geometry.hpp"
#include "two_rooms.hpp"

using hyselam::Pose2;
using hyselam_topo::Id;
using hyselam_topo::planRoute;

TEST(Route, LeadsThroughTheDoor) {
  const auto map = two_rooms::map();
  const auto leg = planRoute(map, {1.0, 2.5, 0.0}, {2});
  ASSERT_TRUE(leg);
  EXPECT_EQ(leg->places, (std::vector<Id>{1, 2}));
  EXPECT_EQ(leg->doors, std::vector<Id>{1});
  ASSERT_EQ(leg->waypoints.size(), 2u);
  EXPECT_NEAR(leg->waypoints[0].x, 4.05, 1e-9);
  EXPECT_NEAR(leg->waypoints[0].y, 1.5, 1e-9);
  EXPECT_NEAR(leg->waypoints[0].theta, 0.0, 0.3);
  EXPECT_EQ(hyselam_topo::placeAt(map, {leg->waypoints[1].x, leg->waypoints[1].y})->place, 2u);
  EXPECT_NEAR(leg->path.front().x, 1.0, 0.1);
  EXPECT_NEAR(leg->path.back().x, leg->waypoints[1].x, 0.1);
  EXPECT_GT(leg->length, 5.0);
  EXPECT_LT(leg->length, 6.5);
  for (const Pose2& pose : leg->path) {
    // Never in the wall beside the door, clear of the door posts.
    if (pose.x > 3.8 && pose.x < 4.3) {
      EXPECT_NEAR(pose.y, 1.5, 0.2);
    }
    EXPECT_GT(pose.y, 0.3);
    EXPECT_LT(pose.y, 2.7);
  }
}

TEST(Route, WithinAPlaceGoesToItsMiddle) {
  const auto leg = planRoute(two_rooms::map(), {1.0, 2.5, 0.0}, {1});
  ASSERT_TRUE(leg);
  EXPECT_EQ(leg->places, std::vector<Id>{1});
  EXPECT_TRUE(leg->doors.empty());
  ASSERT_EQ(leg->waypoints.size(), 1u);
}

TEST(Route, ToTheNearestOfSeveral) {
  const auto leg = planRoute(two_rooms::map(), {5.0, 1.5, 0.0}, {1, 2});
  ASSERT_TRUE(leg);
  EXPECT_EQ(leg->places.back(), 2u);
}

TEST(Route, LeadsThroughNoShutDoor) {
  auto map = two_rooms::map();
  EXPECT_FALSE(planRoute(map, {1.0, 2.5, 0.0}, {2}, {}, {1}));
  map.edges[0].doors.push_back(hyselam_topo::doorBetween({4.05, 1.9}, {4.05, 1.5}));
  map.edges[0].doors.back().id = 2;
  const auto leg = planRoute(map, {1.0, 2.5, 0.0}, {2}, {}, {1});
  ASSERT_TRUE(leg);
  EXPECT_EQ(leg->doors, std::vector<Id>{2});
}

TEST(Route, TakesAClosedDoorOnlyWithoutAnother) {
  auto map = two_rooms::map();
  map.edges[0].doors[0].state = hyselam_topo::DoorState::kClosed;
  EXPECT_TRUE(planRoute(map, {1.0, 2.5, 0.0}, {2}));
  map.edges[0].doors.push_back(hyselam_topo::doorBetween({4.05, 1.9}, {4.05, 1.5}));
  map.edges[0].doors.back().id = 2;
  const auto leg = planRoute(map, {1.0, 2.5, 0.0}, {2});
  ASSERT_TRUE(leg);
  EXPECT_EQ(leg->doors, std::vector<Id>{2});
}

TEST(Route, WithoutADoorPassesWherePlacesMeet) {
  auto map = two_rooms::map();
  map.edges[0].doors.clear();
  const auto leg = planRoute(map, {1.0, 2.5, 0.0}, {2});
  ASSERT_TRUE(leg);
  EXPECT_EQ(leg->doors, std::vector<Id>{0});
  EXPECT_NEAR(leg->waypoints[0].x, 4.05, 0.1);
}

TEST(Route, NoRouteWithoutAPath) {
  auto map = two_rooms::map();
  EXPECT_FALSE(planRoute(map, {100.0, 0.0, 0.0}, {2})) << "the robot is nowhere";
  EXPECT_FALSE(planRoute(map, {1.0, 1.0, 0.0}, {7})) << "no such place";
  EXPECT_FALSE(planRoute(map, {1.0, 1.0, 0.0}, {}));
  map.edges.clear();
  EXPECT_FALSE(planRoute(map, {1.0, 1.0, 0.0}, {2})) << "not joined";
  map = two_rooms::map();
  map.grid.reset();
  EXPECT_FALSE(planRoute(map, {1.0, 1.0, 0.0}, {2})) << "no grid";
  hyselam_topo::RouteParams params;
  params.spacing = 0.0;
  EXPECT_THROW(planRoute(two_rooms::map(), {}, {1}, params), hyselam::ParameterError);
}
