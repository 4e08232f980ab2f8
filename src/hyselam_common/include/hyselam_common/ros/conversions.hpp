// Between messages and the plain values of hyselam_common. Every message is checked: what comes out
// is finite and consistent, or InputError says what is wrong, beginning with `source` (a topic or
// file).
#pragma once

#include <geometry_msgs/Pose.h>
#include <geometry_msgs/Pose2D.h>
#include <geometry_msgs/Quaternion.h>
#include <geometry_msgs/Transform.h>
#include <nav_msgs/OccupancyGrid.h>
#include <ros/time.h>
#include <sensor_msgs/LaserScan.h>
#include <std_msgs/String.h>
#include <tf2/LinearMath/Transform.h>

#include <string>

#include "hyselam_common/laser_scan.hpp"
#include "hyselam_common/occupancy_grid.hpp"
#include "hyselam_common/pose2.hpp"

namespace hyselam {

/// Times [s]; ros::Time cannot hold 0 in a bag, negative or not finite values.
double toSeconds(const ros::Time& time);
/// Rounded to ns. 0 becomes 1 ns, because bags and tf take 0 for "no time". @throws InputError for
/// negative, not finite or too large (>= 2^32 s) values.
ros::Time toRosTime(double seconds, const std::string& source = "time");

std_msgs::String toStringMsg(const std::string& text);

/// The heading of a quaternion, which is normalised. @throws InputError if it is not finite or so
/// short
/// (|q| < 0.1) that it says nothing; an all-zero quaternion is such a case.
double yawFromMsg(const geometry_msgs::Quaternion& q, const std::string& source);
geometry_msgs::Quaternion yawToMsg(double yaw);

/// z, roll and pitch are dropped.
Pose2 fromMsg(const geometry_msgs::Pose& pose, const std::string& source);
Pose2 fromMsg(const geometry_msgs::Transform& transform, const std::string& source);
/// All of it, the rotation normalised. @throws InputError as above, and for a height that is not
/// finite.
tf2::Transform spatialFromMsg(const geometry_msgs::Transform& transform, const std::string& source);
geometry_msgs::Pose2D toPose2dMsg(const Pose2& pose);
geometry_msgs::Pose toPoseMsg(const Pose2& pose);
geometry_msgs::Transform toTransformMsg(const Pose2& pose);

/// Refuses: no ranges, angles or limits that are not finite, increment 0 with several beams,
/// range_max <= range_min. Ranges themselves may be anything (see LaserScan).
LaserScan fromMsg(const sensor_msgs::LaserScan& msg, const std::string& source,
                  const Pose2& laser_in_base = Pose2{});
sensor_msgs::LaserScan toMsg(const LaserScan& scan, const std::string& frame_id);

/// Says where the laser of `scan` sits on the robot (laser in base). One that is mounted upside
/// down comes out with mirrored angles and a negative increment. @throws InputError for a transform
/// that is not finite, and for a laser whose plane is inclined by more than 60 degrees.
void placeLaser(const tf2::Transform& laser_in_base, const std::string& source, LaserScan* scan);

/// Refuses: no cells, more or fewer data than width * height, resolution not positive, a bad
/// origin, values outside -1 .. 100.
OccupancyGrid fromMsg(const nav_msgs::OccupancyGrid& msg, const std::string& source);
nav_msgs::OccupancyGrid toMsg(const OccupancyGrid& grid, const std::string& frame_id,
                              const ros::Time& stamp);

}  // namespace hyselam
