#include <geometry_msgs/TransformStamped.h>
#include <nav_msgs/Odometry.h>
#include <rosbag/bag.h>
#include <tf2_msgs/TFMessage.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/ros/bag_io.hpp"
#include "hyselam_common/ros/conversions.hpp"

namespace hyselam {
namespace {

constexpr double kLaserMoves = 1e-3;  // [m, rad]; logs state the laser's pose in rounded numbers

void check(const RobotLog& log, const std::string& path) {
  if (log.scans.empty() && log.odometry.empty()) {
    throw InputError(path, "", "there is nothing to write: neither scans nor odometry");
  }
  for (const auto* poses : {&log.odometry, &log.ground_truth}) {
    for (const StampedPose2& p : *poses) {
      if (!p.pose.isFinite()) throw InputError(path, "log to be written", "a pose is not finite");
    }
  }
  for (const LaserScan& scan : log.scans) {
    const Pose2 moved = between(log.scans.front().laser_in_base, scan.laser_in_base);
    if (!(std::hypot(moved.x, moved.y) <= kLaserMoves && std::abs(moved.theta) <= kLaserMoves)) {
      throw InputError(path, "log to be written", "the laser moves on the robot");
    }
  }
}

geometry_msgs::TransformStamped transform(const ros::Time& stamp, const std::string& parent,
                                          const std::string& child, const Pose2& pose) {
  geometry_msgs::TransformStamped t;
  t.header.stamp = stamp;
  t.header.frame_id = parent;
  t.child_frame_id = child;
  t.transform = toTransformMsg(pose);
  return t;
}

/// The velocity at sample i as its neighbours give it, in the frame of the robot.
geometry_msgs::Twist velocity(const std::vector<StampedPose2>& poses, std::size_t i) {
  geometry_msgs::Twist twist;
  const StampedPose2& a = poses[i > 0 ? i - 1 : i];
  const StampedPose2& b = poses[std::min(i + 1, poses.size() - 1)];
  const double dt = b.stamp - a.stamp;
  if (dt <= 0.0) return twist;
  const double c = std::cos(poses[i].pose.theta), s = std::sin(poses[i].pose.theta);
  const double dx = b.pose.x - a.pose.x, dy = b.pose.y - a.pose.y;
  twist.linear.x = (c * dx + s * dy) / dt;
  twist.linear.y = (-s * dx + c * dy) / dt;
  twist.angular.z = normalizeAngle(b.pose.theta - a.pose.theta) / dt;
  return twist;
}

nav_msgs::Odometry odometry(const std::vector<StampedPose2>& poses, std::size_t i,
                            const std::string& parent, const std::string& child) {
  nav_msgs::Odometry msg;
  msg.header.stamp = toRosTime(poses[i].stamp, "odometry");
  msg.header.frame_id = parent;
  msg.child_frame_id = child;
  msg.pose.pose = toPoseMsg(poses[i].pose);
  msg.twist.twist = velocity(poses, i);
  return msg;
}

boost::shared_ptr<ros::M_string> latchedHeader(const std::string& topic) {
  using Traits = tf2_msgs::TFMessage;
  auto header = boost::make_shared<ros::M_string>();
  (*header)["topic"] = topic;
  (*header)["type"] = ros::message_traits::datatype<Traits>();
  (*header)["md5sum"] = ros::message_traits::md5sum<Traits>();
  (*header)["message_definition"] = ros::message_traits::definition<Traits>();
  (*header)["latching"] = "1";
  return header;
}

/// The order of messages with one stamp. A player sorts by the time of recording and puts equal
/// times in any order, so each kind is recorded some nanoseconds after its stamp, as a real
/// recorder would; the transform of a scan is then known when the scan arrives.
enum class Rank : std::uint32_t { kStatic, kTransform, kOdometry, kTruth, kScan };

ros::Time recorded(const ros::Time& stamp, Rank rank) {
  const std::uint32_t later = stamp.nsec + static_cast<std::uint32_t>(rank);
  if (later < 1000000000U) return ros::Time(stamp.sec, later);
  if (stamp.sec == std::numeric_limits<std::uint32_t>::max()) return stamp;
  return ros::Time(stamp.sec + 1, later - 1000000000U);
}

void writeMessages(rosbag::Bag& bag, const RobotLog& log, const BagOptions& options) {
  const double begin = timeSpan(log)->begin;
  if (!log.scans.empty()) {
    tf2_msgs::TFMessage fixed;
    const ros::Time stamp = toRosTime(begin, "log");
    fixed.transforms.push_back(
        transform(stamp, options.base_frame, options.laser_frame, log.scans.front().laser_in_base));
    bag.write("/tf_static", recorded(stamp, Rank::kStatic), fixed, latchedHeader("/tf_static"));
  }
  // Three ordered lists merged.
  std::size_t i_odometry = 0, i_truth = 0, i_scan = 0;
  constexpr double kNever = std::numeric_limits<double>::infinity();
  for (;;) {
    const double t_odometry =
        i_odometry < log.odometry.size() ? log.odometry[i_odometry].stamp : kNever;
    const double t_truth =
        i_truth < log.ground_truth.size() ? log.ground_truth[i_truth].stamp : kNever;
    const double t_scan = i_scan < log.scans.size() ? log.scans[i_scan].stamp : kNever;
    const double next = std::min({t_odometry, t_truth, t_scan});
    if (next == kNever) break;
    if (t_odometry == next) {
      const auto msg = odometry(log.odometry, i_odometry, options.odom_frame, options.base_frame);
      tf2_msgs::TFMessage tf;
      tf.transforms.push_back(transform(msg.header.stamp, options.odom_frame, options.base_frame,
                                        log.odometry[i_odometry].pose));
      bag.write("/tf", recorded(msg.header.stamp, Rank::kTransform), tf);
      bag.write(options.odometry_topic, recorded(msg.header.stamp, Rank::kOdometry), msg);
      ++i_odometry;
    } else if (t_truth == next) {
      const auto msg = odometry(log.ground_truth, i_truth++, options.map_frame, options.base_frame);
      bag.write(options.ground_truth_topic, recorded(msg.header.stamp, Rank::kTruth), msg);
    } else {
      const auto msg = toMsg(log.scans[i_scan++], options.laser_frame);
      bag.write(options.scan_topic, recorded(msg.header.stamp, Rank::kScan), msg);
    }
  }
}

}  // namespace

void writeBag(const std::string& path, const RobotLog& log, const BagOptions& options) {
  check(log, path);
  try {
    replaceFileAtomically(path, [&](const std::string& temporary) {
      rosbag::Bag bag(temporary, rosbag::bagmode::Write);
      writeMessages(bag, log, options);
      bag.close();
    });
  } catch (const rosbag::BagException& e) {
    throw InputError(path, "", std::string("cannot be written: ") + e.what());
  }
}

}  // namespace hyselam
