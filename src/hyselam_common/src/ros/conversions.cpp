#include "hyselam_common/ros/conversions.hpp"

#include <cmath>

#include "hyselam_common/errors.hpp"

namespace hyselam {
namespace {

constexpr double kTooLate = 4294967296.0;  // ros::Time counts seconds in 32 bits
constexpr double kShortestQuaternion = 0.1;
constexpr double kTilted =
    0.5;  // |cosine| of the laser's inclination below which its plane is none

Pose2 checkedPose(double x, double y, const geometry_msgs::Quaternion& q,
                  const std::string& source) {
  if (!std::isfinite(x) || !std::isfinite(y)) {
    throw InputError(source, "", "the position is not finite");
  }
  return {x, y, yawFromMsg(q, source)};
}

}  // namespace

double toSeconds(const ros::Time& time) {
  return time.sec + 1e-9 * time.nsec;
}

ros::Time toRosTime(double seconds, const std::string& source) {
  if (!(seconds >= 0.0 && seconds < kTooLate)) {
    throw InputError(source, "",
                     "the time " + std::to_string(seconds) +
                         " s is outside of what a bag can hold (0 .. 2^32 s)");
  }
  const double whole = std::floor(seconds);
  auto sec = static_cast<std::uint32_t>(whole);
  auto nsec = static_cast<std::uint32_t>(std::llround((seconds - whole) * 1e9));
  if (nsec >= 1000000000U) {
    if (sec == 0xffffffffU) return ros::Time(sec, 999999999U);
    ++sec;
    nsec = 0;
  }
  if (sec == 0 && nsec == 0) nsec = 1;
  return ros::Time(sec, nsec);
}

double yawFromMsg(const geometry_msgs::Quaternion& q, const std::string& source) {
  const double norm = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
  if (!std::isfinite(norm)) throw InputError(source, "", "the quaternion is not finite");
  if (norm < kShortestQuaternion) {
    throw InputError(
        source, "",
        "the quaternion has length " + std::to_string(norm) + ": it states no direction");
  }
  const double x = q.x / norm, y = q.y / norm, z = q.z / norm, w = q.w / norm;
  return normalizeAngle(std::atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z)));
}

geometry_msgs::Quaternion yawToMsg(double yaw) {
  geometry_msgs::Quaternion q;
  q.z = std::sin(0.5 * yaw);
  q.w = std::cos(0.5 * yaw);
  return q;
}

Pose2 fromMsg(const geometry_msgs::Pose& pose, const std::string& source) {
  return checkedPose(pose.position.x, pose.position.y, pose.orientation, source);
}

Pose2 fromMsg(const geometry_msgs::Transform& transform, const std::string& source) {
  return checkedPose(transform.translation.x, transform.translation.y, transform.rotation, source);
}

tf2::Transform spatialFromMsg(const geometry_msgs::Transform& t, const std::string& source) {
  fromMsg(t, source);  // checks it
  if (!std::isfinite(t.translation.z)) throw InputError(source, "", "the position is not finite");
  const tf2::Quaternion turn(t.rotation.x, t.rotation.y, t.rotation.z, t.rotation.w);
  return tf2::Transform(turn.normalized(),
                        tf2::Vector3(t.translation.x, t.translation.y, t.translation.z));
}

std_msgs::String toStringMsg(const std::string& text) {
  std_msgs::String msg;
  msg.data = text;
  return msg;
}

geometry_msgs::Pose2D toPose2dMsg(const Pose2& pose) {
  geometry_msgs::Pose2D msg;
  msg.x = pose.x;
  msg.y = pose.y;
  msg.theta = pose.theta;
  return msg;
}

geometry_msgs::Pose toPoseMsg(const Pose2& pose) {
  geometry_msgs::Pose msg;
  msg.position.x = pose.x;
  msg.position.y = pose.y;
  msg.orientation = yawToMsg(pose.theta);
  return msg;
}

geometry_msgs::Transform toTransformMsg(const Pose2& pose) {
  geometry_msgs::Transform msg;
  msg.translation.x = pose.x;
  msg.translation.y = pose.y;
  msg.rotation = yawToMsg(pose.theta);
  return msg;
}

LaserScan fromMsg(const sensor_msgs::LaserScan& msg, const std::string& source,
                  const Pose2& laser_in_base) {
  const auto fail = [&](const std::string& reason) { throw InputError(source, "", reason); };
  if (msg.ranges.empty()) fail("the scan has no ranges");
  if (!std::isfinite(msg.angle_min) || !std::isfinite(msg.angle_increment)) {
    fail("angle_min or angle_increment is not finite");
  }
  if (msg.angle_increment == 0.0F && msg.ranges.size() > 1) fail("angle_increment is 0");
  // An infinite limit is a driver's way of saying that there is none.
  if (std::isnan(msg.range_min) || std::isnan(msg.range_max) || !std::isfinite(msg.range_min)) {
    fail("range_min or range_max is not a number");
  }
  if (!(msg.range_max > msg.range_min)) {
    fail("range_max " + std::to_string(msg.range_max) + " is not above range_min " +
         std::to_string(msg.range_min));
  }
  LaserScan scan;
  scan.stamp = toSeconds(msg.header.stamp);
  scan.angle_min = msg.angle_min;
  scan.angle_increment = msg.angle_increment;
  scan.range_min = msg.range_min;
  scan.range_max = msg.range_max;
  scan.ranges = msg.ranges;
  scan.laser_in_base = laser_in_base;
  return scan;
}

sensor_msgs::LaserScan toMsg(const LaserScan& scan, const std::string& frame_id) {
  sensor_msgs::LaserScan msg;
  msg.header.stamp = toRosTime(scan.stamp, "scan");
  msg.header.frame_id = frame_id;
  const double beams = static_cast<double>(scan.ranges.size());
  msg.angle_min = static_cast<float>(scan.angle_min);
  msg.angle_increment = static_cast<float>(scan.angle_increment);
  msg.angle_max =
      static_cast<float>(scan.angle_min + std::max(beams - 1.0, 0.0) * scan.angle_increment);
  msg.range_min = static_cast<float>(scan.range_min);
  msg.range_max = static_cast<float>(scan.range_max);
  msg.ranges = scan.ranges;
  return msg;
}

void placeLaser(const tf2::Transform& laser_in_base, const std::string& source, LaserScan* scan) {
  const tf2::Matrix3x3& axes = laser_in_base.getBasis();
  const double up = axes[2][2];
  const Pose2 pose{laser_in_base.getOrigin().x(), laser_in_base.getOrigin().y(),
                   std::atan2(axes[1][0], axes[0][0])};
  if (!pose.isFinite() || !std::isfinite(up)) {
    throw InputError(source, "", "the laser's pose on the robot is not finite");
  }
  if (std::abs(up) < kTilted) throw InputError(source, "", "the laser's plane is not horizontal");
  scan->laser_in_base = pose;
  if (up < 0.0) {
    scan->angle_min = -scan->angle_min;
    scan->angle_increment = -scan->angle_increment;
  }
}

OccupancyGrid fromMsg(const nav_msgs::OccupancyGrid& msg, const std::string& source) {
  const auto fail = [&](const std::string& reason) { throw InputError(source, "", reason); };
  constexpr std::uint32_t kMaxSide = 1U << 30;
  const auto& info = msg.info;
  if (info.width == 0 || info.height == 0) fail("the map has no cells");
  if (info.width > kMaxSide || info.height > kMaxSide) fail("the map's size is not sensible");
  const std::size_t cells = static_cast<std::size_t>(info.width) * info.height;
  if (msg.data.size() != cells) {
    fail("the map has " + std::to_string(msg.data.size()) + " cells instead of " +
         std::to_string(info.width) + " x " + std::to_string(info.height));
  }
  if (!(info.resolution > 0.0F) || !std::isfinite(info.resolution)) {
    fail("the map's resolution " + std::to_string(info.resolution) + " is not > 0");
  }
  OccupancyGrid grid;
  grid.geometry.width = static_cast<int>(info.width);
  grid.geometry.height = static_cast<int>(info.height);
  // The message holds 32 bits; 0.05 shall come out as 0.05, or far cells shift against the map
  // file.
  grid.geometry.resolution = std::round(static_cast<double>(info.resolution) * 1e7) / 1e7;
  if (!(grid.geometry.resolution > 0.0)) grid.geometry.resolution = info.resolution;
  grid.geometry.origin = fromMsg(info.origin, source + ": origin");
  grid.cells.assign(msg.data.begin(), msg.data.end());
  for (const std::int8_t v : grid.cells) {
    if (v < -1 || v > 100) fail("the map holds the value " + std::to_string(v));
  }
  return grid;
}

nav_msgs::OccupancyGrid toMsg(const OccupancyGrid& grid, const std::string& frame_id,
                              const ros::Time& stamp) {
  nav_msgs::OccupancyGrid msg;
  msg.header.frame_id = frame_id;
  msg.header.stamp = stamp;
  msg.info.map_load_time = stamp;
  msg.info.resolution = static_cast<float>(grid.geometry.resolution);
  msg.info.width = static_cast<std::uint32_t>(grid.geometry.width);
  msg.info.height = static_cast<std::uint32_t>(grid.geometry.height);
  msg.info.origin = toPoseMsg(grid.geometry.origin);
  msg.data.assign(grid.cells.begin(), grid.cells.end());
  return msg;
}

}  // namespace hyselam
