// Scans with the odometry of their moment: each scan waits for its transform, in order, not for
// ever; time that goes back is noticed.
#pragma once

#include <diagnostic_msgs/DiagnosticStatus.h>
#include <ros/ros.h>
#include <sensor_msgs/LaserScan.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>

#include <deque>
#include <functional>
#include <optional>
#include <string>

#include "fsd_localization/ros/drop_counter.hpp"
#include "fsd_localization/ros/parameters.hpp"
#include "hyselam_common/laser_scan.hpp"

namespace fsd_localization {

/// Subscribes to `scan`, looks up odom -> base at the time of each scan and base -> laser.
///
/// Everything runs on the queue of the node handle, which must serve one callback at a time; only
/// tf is filled by a thread of its own.
class ScanInput {
 public:
  /// Gets every usable scan; returns whether it used it, or else has told drops() why not. An
  /// InputError that it throws is counted as a refused scan.
  using ScanHandler = std::function<bool(const hyselam::LaserScan&,
                                         const hyselam::Pose2& base_in_odom, const ros::Time&)>;
  /// Told that time went back; waiting scans and transforms are forgotten by then.
  using TimeHandler = std::function<void()>;

  ScanInput(ros::NodeHandle nh, const ScanInputParams& params, const std::string& who,
            ScanHandler on_scan, TimeHandler on_time_back);

  /// Looks whether the clock was set back; the servers call it when no scan comes.
  void checkClock();
  /// The motion of the base in odom from `from` to the newest known; empty if tf does not know.
  std::optional<hyselam::Pose2> motionSince(const ros::Time& from) const;

  DropCounter& drops() { return drops_; }
  std::size_t received() const { return received_; }
  std::size_t used() const { return used_; }
  /// Counts, rate since the last report, and a remark where scans are missing or being dropped.
  void report(diagnostic_msgs::DiagnosticStatus& status);

 private:
  struct Waiting {
    sensor_msgs::LaserScan::ConstPtr scan;
    ros::Time since;
    ros::WallTime wall_since;
  };
  void onScan(const sensor_msgs::LaserScan::ConstPtr& scan);
  void timeWentBack(const std::string& what);
  void serveWaiting();
  bool waitedLongEnough(const Waiting& waiting) const;
  /// Which transform a scan of this header waits for, and why; empty: none.
  std::string missingTransform(const std_msgs::Header& header) const;
  bool serve(const sensor_msgs::LaserScan& scan);
  void noteGeometry(const sensor_msgs::LaserScan& scan);

  ScanInputParams params_;
  std::string who_;
  std::string topic_;
  ScanHandler on_scan_;
  TimeHandler on_time_back_;
  DropCounter drops_;
  tf2_ros::Buffer tf_;
  tf2_ros::TransformListener tf_listener_;
  std::deque<Waiting> waiting_;
  ros::Time last_now_;
  ros::Time last_stamp_;  // of the last scan taken; 0: none
  std::string geometry_;  // of the last scan served, for the log
  std::size_t received_ = 0, used_ = 0, time_jumps_ = 0, geometry_changes_ = 0;
  std::size_t reported_received_ = 0, reported_drops_ = 0;
  ros::WallTime reported_;
  ros::WallTime quiet_since_;  // of the last scan, or of the last reminder that there is none
  ros::WallTimer retry_;
  ros::Subscriber subscriber_;
};

}  // namespace fsd_localization
