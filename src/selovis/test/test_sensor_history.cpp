// Readings that come late or in another order than they were taken.
#include <gtest/gtest.h>
#include <std_msgs/Header.h>

#include <memory>

#include "selovis/ros/sensor_history.hpp"

namespace selovis {
namespace {

struct Reading {
  using ConstPtr = std::shared_ptr<const Reading>;
  std_msgs::Header header;
};

Reading::ConstPtr at(double seconds) {
  auto reading = std::make_shared<Reading>();
  reading->header.stamp = ros::Time(seconds);
  return reading;
}

TEST(SensorHistory, LateMessageIsSortedIn) {
  SensorHistory<Reading> history;
  for (const double t : {10.0, 10.2, 10.1}) history.add(at(t));
  EXPECT_TRUE(history.reaches(ros::Time(10.2)));
  EXPECT_EQ(history.nearest(ros::Time(10.01), 0.05)->header.stamp, ros::Time(10.0));
  EXPECT_EQ(history.nearest(ros::Time(10.11), 0.05)->header.stamp, ros::Time(10.1));
  EXPECT_EQ(history.nearest(ros::Time(10.21), 0.05)->header.stamp, ros::Time(10.2));
  EXPECT_FALSE(history.nearest(ros::Time(10.5), 0.05));
}

TEST(SensorHistory, OldestMessagesAreRemoved) {
  SensorHistory<Reading> history(2);
  for (const double t : {10.0, 10.1, 10.2}) history.add(at(t));
  EXPECT_FALSE(history.nearest(ros::Time(10.0), 0.05));
  EXPECT_TRUE(history.nearest(ros::Time(10.1), 0.05));
  EXPECT_TRUE(history.reaches(ros::Time(10.2)));
}

TEST(SensorHistory, TimeThatGoesBackClearsTheHistory) {
  SensorHistory<Reading> history;
  for (const double t : {10.0, 10.2, 3.0}) history.add(at(t));
  EXPECT_FALSE(history.reaches(ros::Time(10.0)));
  EXPECT_FALSE(history.nearest(ros::Time(10.0), 1.0));
  EXPECT_TRUE(history.nearest(ros::Time(3.0), 0.1));
}

}  // namespace
}  // namespace selovis
