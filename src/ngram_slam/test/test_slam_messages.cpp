// What rviz shows of SLAM.
#include <gtest/gtest.h>

#include <map>
#include <set>
#include <string>

#include "ngram_slam/ros/slam_messages.hpp"

namespace ngram_slam {
namespace {

MapChange change(MapChange::Kind kind, double x, double size, bool again = false) {
  MapChange c;
  c.kind = kind;
  c.center = {x, 1.0};
  c.size = size;
  c.again = again;
  c.cells = {{x, 1.0}, {x + 0.05, 1.0}};
  return c;
}

TEST(ChangeMarkers, AreSeenFromFar) {
  const auto array = changeMarkers(
      {change(MapChange::Kind::kAppeared, 1.0, 0.6), change(MapChange::Kind::kGone, 5.0, 0.1),
       change(MapChange::Kind::kGone, 9.0, 0.4, true)},
      0.05, {});
  std::map<std::string, int> count;
  std::set<std::pair<std::string, int>> ids;
  for (const auto& m : array.markers) {
    ++count[m.ns];
    EXPECT_TRUE(ids.insert({m.ns, m.id}).second) << m.ns << ' ' << m.id;
    if (m.ns == "places") {
      EXPECT_GT(m.scale.x, 1.0);  // a small change too
      EXPECT_EQ(m.scale.x, m.scale.y);
      const bool appeared = m.pose.position.x < 2.0;
      EXPECT_EQ(m.color.g > m.color.r, appeared);
    }
    if (m.ns == "names") {
      EXPECT_EQ(m.text, m.pose.position.x < 2.0 ? "appeared" : "gone again");
      EXPECT_GT(m.pose.position.z, 1.6);  // above regions and their names
    }
  }
  EXPECT_EQ(count["appeared"], 1);
  EXPECT_EQ(count["gone"], 1);
  EXPECT_EQ(count["places"], 3);
  EXPECT_EQ(count["names"], 2);
}

TEST(ChangeMarkers, OfNothingClearWhatWasThere) {
  const auto array = changeMarkers({}, 0.05, {});
  ASSERT_EQ(array.markers.size(), 1U);
  EXPECT_EQ(array.markers[0].action, visualization_msgs::Marker::DELETEALL);
}

}  // namespace
}  // namespace ngram_slam
