// Messages to values and back, and what is refused.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/rng.hpp"
#include "hyselam_common/ros/conversions.hpp"
#include "hyselam_common/testing/files.hpp"

namespace hyselam {
namespace {

using testing::messageOf;

const double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(Conversions, PosesThereAndBack) {
  Rng rng(1);
  for (int i = 0; i < 1000; ++i) {
    const Pose2 p{rng.uniform(-9, 9), rng.uniform(-9, 9), rng.uniform(-kPi, kPi)};
    for (const Pose2& q : {fromMsg(toPoseMsg(p), "t"), fromMsg(toTransformMsg(p), "t")}) {
      EXPECT_DOUBLE_EQ(q.x, p.x);
      EXPECT_DOUBLE_EQ(q.y, p.y);
      EXPECT_NEAR(normalizeAngle(q.theta - p.theta), 0.0, 1e-12);
    }
  }
}

TEST(Conversions, QuaternionsAreNormalised) {
  geometry_msgs::Quaternion q = yawToMsg(1.0);
  q.z *= 3;
  q.w *= 3;
  EXPECT_NEAR(yawFromMsg(q, "t"), 1.0, 1e-12);
}

TEST(Conversions, QuaternionsThatSayNothingAreRefused) {
  geometry_msgs::Pose pose;  // 0, 0, 0, 0: the default of the message
  EXPECT_EQ(messageOf<InputError>([&] { fromMsg(pose, "/initialpose"); }).find("/initialpose"), 0U);
  pose.orientation.w = kNan;
  EXPECT_THROW(fromMsg(pose, "t"), InputError);
  pose.orientation.w = 1.0;
  pose.position.x = kNan;
  EXPECT_THROW(fromMsg(pose, "t"), InputError);
}

TEST(Conversions, TimesThereAndBack) {
  for (const double t : {1e-9, 0.5, 976052857.123456, 4294967295.5}) {
    EXPECT_NEAR(toSeconds(toRosTime(t)), t, 1e-6);
  }
  EXPECT_EQ(toRosTime(0.0), ros::Time(0, 1));  // a bag cannot hold 0
  EXPECT_EQ(toRosTime(1.9999999999), ros::Time(2, 0));
  EXPECT_EQ(toRosTime(2691.289754), ros::Time(2691, 289754000));
}

TEST(Conversions, TimesThatRosCannotHoldAreRefused) {
  for (const double t : {-1e-3, 4294967296.0, kNan, std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(toRosTime(t), InputError) << t;
  }
}

sensor_msgs::LaserScan goodScan() {
  sensor_msgs::LaserScan msg;
  msg.header.stamp = ros::Time(5, 0);
  msg.angle_min = -1.0F;
  msg.angle_increment = 0.5F;
  msg.range_min = 0.1F;
  msg.range_max = 8.0F;
  msg.ranges = {1.0F, std::numeric_limits<float>::infinity(), std::nanf(""), 2.0F};
  return msg;
}

TEST(Conversions, ScansThereAndBack) {
  const LaserScan scan = fromMsg(goodScan(), "/scan", {0.2, 0, 0});
  EXPECT_DOUBLE_EQ(scan.stamp, 5.0);
  EXPECT_DOUBLE_EQ(scan.laser_in_base.x, 0.2);
  const sensor_msgs::LaserScan msg = toMsg(scan, "laser");
  EXPECT_EQ(msg.header.frame_id, "laser");
  EXPECT_FLOAT_EQ(msg.angle_max, 0.5F);
  EXPECT_EQ(msg.ranges.size(), 4U);
  EXPECT_TRUE(std::isnan(msg.ranges[2]));
}

TEST(Conversions, ScansThatCannotBeUsedAreRefused) {
  const auto refused = [](auto change, const std::string& part) {
    sensor_msgs::LaserScan msg = goodScan();
    change(msg);
    const std::string message = messageOf<InputError>([&] { fromMsg(msg, "/scan"); });
    EXPECT_EQ(message.find("/scan"), 0U);
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  refused([](auto& m) { m.ranges.clear(); }, "no ranges");
  refused([](auto& m) { m.angle_increment = 0.0F; }, "angle_increment is 0");
  refused([](auto& m) { m.angle_min = std::nanf(""); }, "not finite");
  refused([](auto& m) { m.range_max = 0.05F; }, "range_max");
  refused([](auto& m) { m.range_max = std::nanf(""); }, "range_max");
}

nav_msgs::OccupancyGrid goodMap() {
  nav_msgs::OccupancyGrid msg;
  msg.info.resolution = 0.05F;
  msg.info.width = 2;
  msg.info.height = 3;
  msg.info.origin = toPoseMsg({1, 2, 0.3});
  msg.data = {0, 100, -1, 50, 1, 99};
  return msg;
}

TEST(Conversions, MapsThereAndBack) {
  const OccupancyGrid grid = fromMsg(goodMap(), "/map");
  EXPECT_DOUBLE_EQ(grid.geometry.resolution, 0.05);
  EXPECT_EQ(grid.at({1, 0}), 100);
  EXPECT_EQ(grid.at({0, 2}), 1);
  const nav_msgs::OccupancyGrid msg = toMsg(grid, "map", ros::Time(1, 0));
  EXPECT_EQ(msg.data, goodMap().data);
  EXPECT_EQ(msg.info.resolution, 0.05F);
  EXPECT_NEAR(fromMsg(msg.info.origin, "t").theta, 0.3, 1e-12);
}

TEST(Conversions, MapsThatCannotBeUsedAreRefused) {
  const auto refused = [](auto change, const std::string& part) {
    nav_msgs::OccupancyGrid msg = goodMap();
    change(msg);
    const std::string message = messageOf<InputError>([&] { fromMsg(msg, "/map"); });
    EXPECT_EQ(message.find("/map"), 0U);
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  refused([](auto& m) { m.data.pop_back(); }, "5 cells instead of 2 x 3");
  refused([](auto& m) { m.info.width = 0; }, "no cells");
  refused([](auto& m) { m.info.width = m.info.height = 0xffffffffU; }, "not sensible");
  refused([](auto& m) { m.info.resolution = 0.0F; }, "resolution");
  refused([](auto& m) { m.info.resolution = std::nanf(""); }, "resolution");
  refused([](auto& m) { m.info.origin.orientation = geometry_msgs::Quaternion(); }, "quaternion");
  refused([](auto& m) { m.info.origin.position.y = kNan; }, "position");
  refused([](auto& m) { m.data[2] = 101; }, "101");
}

}  // namespace
}  // namespace hyselam
