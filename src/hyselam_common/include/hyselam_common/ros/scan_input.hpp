// Laser scans, each with the odometry of its moment: a scan waits for its transform, in order, but
// not for ever; a clock that is set back is noticed.
#pragma once

#include <diagnostic_msgs/DiagnosticStatus.h>
#include <ros/ros.h>
#include <sensor_msgs/LaserScan.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>

#include <functional>
#include <optional>
#include <string>

#include "hyselam_common/laser_scan.hpp"
#include "hyselam_common/pose2.hpp"
#include "hyselam_common/ros/drop_counter.hpp"
#include "hyselam_common/ros/scan_input_params.hpp"
#include "hyselam_common/ros/wait_for_transform.hpp"

namespace hyselam {

/// Subscribes to `scan`, looks up odom -> base at the time of each scan and base -> laser.
///
/// Everything runs on the queue of the node handle, which must serve one callback at a time; only
/// tf is filled by a thread of its own.
class ScanInput {
 public:
  /// Gets every usable scan; returns whether it used it, or else has counted in drops() why not. An
  /// InputError that it throws is counted as a refused scan.
  using ScanHandler =
      std::function<bool(const LaserScan&, const Pose2& base_in_odom, const ros::Time&)>;
  /// Called when time went back; waiting scans and transforms are forgotten by then.
  using TimeJumpHandler = std::function<void()>;

  /// @param log_name begins what is logged ("[/localization]").
  ScanInput(ros::NodeHandle nh, const ScanInputParams& params, const std::string& log_name,
            ScanHandler on_scan, TimeJumpHandler on_time_jump);

  /// Scans whose transforms are known wait, too, while `busy` says so of the oldest (by its stamp):
  /// the handler is not ready for it, and must be before long.
  void holdWhile(std::function<bool(const ros::Time&)> busy);

  /// Whether the clock was set back; the servers call it when no scan comes.
  void checkClock();
  /// The base in odom at a time, or the newest known (ros::Time(0)); empty if tf does not know.
  std::optional<Pose2> baseInOdom(const ros::Time& at = ros::Time(0)) const;
  /// The motion of the base in odom from `from` to the newest known; empty if tf does not know.
  std::optional<Pose2> motionSince(const ros::Time& from) const;

  DropCounter& drops() { return drops_; }
  std::size_t received() const { return received_; }
  std::size_t used() const { return used_; }
  /// Counts, rate since the last report, and a remark where scans are missing or being dropped.
  void report(diagnostic_msgs::DiagnosticStatus& status);

 private:
  using ScanPtr = sensor_msgs::LaserScan::ConstPtr;

  void onScan(const ScanPtr& scan);
  void restartClock(const std::string& jump);
  std::string missingTransformOf(const std_msgs::Header& header) const;
  void useScan(const sensor_msgs::LaserScan& msg);
  bool handleScan(const sensor_msgs::LaserScan& msg);
  void logGeometry(const sensor_msgs::LaserScan& scan);

  const ScanInputParams params_;
  const std::string log_name_;
  const std::string topic_;
  const ScanHandler on_scan_;
  const TimeJumpHandler on_time_jump_;
  DropCounter drops_;
  tf2_ros::Buffer tf_;
  tf2_ros::TransformListener tf_listener_;
  WaitForTransform<ScanPtr> waiting_;
  ros::Time last_now_;
  ros::Time last_stamp_;  // of the last scan taken; 0: none
  std::string geometry_;  // of the last scan handled, for the log
  std::size_t received_ = 0, used_ = 0, time_jumps_ = 0, geometry_changes_ = 0;
  std::size_t reported_received_ = 0, reported_drops_ = 0;
  ros::WallTime reported_;
  ros::WallTime jumps_told_;       // when time was last said to have gone back
  std::size_t jumps_counted_ = 0;  // time_jumps_ then
  ros::WallTime quiet_since_;      // of the last scan, or of the last reminder that there is none
  ros::Subscriber subscriber_;
};

}  // namespace hyselam
