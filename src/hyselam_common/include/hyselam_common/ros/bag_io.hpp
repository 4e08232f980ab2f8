// Robot logs as ROS bags.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hyselam_common/carmen_log.hpp"
#include "hyselam_common/robot_log.hpp"

namespace hyselam {

struct BagOptions {
  /// Topics are found with or without their leading slash.
  std::string scan_topic = "/scan";
  std::string odometry_topic = "/odom";
  std::string ground_truth_topic = "/ground_truth";
  std::string odom_frame = "odom";
  std::string base_frame = "base_link";
  std::string laser_frame = "laser";  ///< for writing; when reading, the scans' frame_id counts
  std::string map_frame = "map";      ///< of the ground truth, for writing
  /// For reading: where the laser sits, instead of what tf says.
  std::optional<Pose2> laser_in_base;
  /// For reading: accept a bag without odometry (scan-only logs).
  bool odometry_required = true;
};

/// Reads scans, odometry and ground truth of a bag; gzip-packed bags (.bag.gz) too.
///
/// Scans: `scan_topic`, or the only LaserScan topic if that one is missing. Odometry:
/// `odometry_topic` (nav_msgs/Odometry), or the only Odometry topic, else the odom_frame ->
/// base_frame transform of /tf. A topic named other than by default is not
/// replaced. Ground truth: `ground_truth_topic` as nav_msgs/Odometry or
/// geometry_msgs/PoseStamped, if present. laser_in_base: the option, else the first chain of
/// transforms of /tf_static and /tf from base_frame to the scans' frame_id, else identity; a laser
/// mounted upside down comes out with mirrored angles and a negative increment. Times are those of
/// the headers; messages are put in the order of their headers. @throws InputError for: a missing
/// file, no bag, a truncated or damaged bag, no scans, several scan topics without a choice, topics
/// named that do not exist, a base frame that is in no transform while others are, no odometry, and
/// messages that cannot be used (topic and time are named).
RobotLog readBag(const std::string& path, const BagOptions& options = {});

/// Writes /scan, /odom (with the velocities that neighboring samples give), /tf (odom -> base_link
/// at each odometry), /tf_static (latched, base_link -> laser) and /ground_truth
/// (nav_msgs/Odometry) if known, in the order of time. The same log gives the same bytes; an
/// existing file is replaced at once. A time of 0 becomes 1 ns, since bags cannot hold 0. @throws
/// InputError if the file cannot be written, a time cannot be held by a bag, the log has neither
/// scans nor odometry, a pose is not finite, or the laser moves on the robot.
void writeBag(const std::string& path, const RobotLog& log, const BagOptions& options = {});

/// readBag() for names that end in .bag or .bag.gz, readCarmenLog() for all others.
RobotLog readRobotLog(const std::string& path, const BagOptions& bag_options = {},
                      const CarmenOptions& carmen_options = {},
                      std::vector<CarmenIssue>* issues = nullptr);

}  // namespace hyselam
