#include "hyselam_common/ros/scan_input.hpp"

#include <sstream>
#include <utility>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/ros/conversions.hpp"
#include "hyselam_common/ros/diagnostics.hpp"
#include "hyselam_common/ros/transport.hpp"

namespace hyselam {

namespace {

constexpr double kClockSlack = 0.5;           // [s] a smaller step back is a clock being adjusted
constexpr double kStampSlack = 2.0;           // [s] an older scan is not late: the bag began again
constexpr double kRemindEvery = 10.0;         // [s] of wall time without scans
constexpr double kJumpReminderPeriod = 10.0;  // [s] of wall time between warnings of jumps

std::string seconds(double s) {
  std::ostringstream out;
  out.precision(3);
  out << std::fixed << s << " s";
  return out.str();
}

}  // namespace

ScanInput::ScanInput(ros::NodeHandle nh, const ScanInputParams& params, const std::string& log_name,
                     ScanHandler on_scan, TimeJumpHandler on_time_jump)
    : params_(params),
      log_name_(log_name),
      topic_(nh.resolveName("scan")),
      on_scan_(std::move(on_scan)),
      on_time_jump_(std::move(on_time_jump)),
      drops_(log_name),
      tf_listener_(tf_, true, tcpNoDelay()),
      waiting_(
          nh, {static_cast<std::size_t>(params.queue_size), params.transform_wait},
          [this](const ScanPtr& scan) { return missingTransformOf(scan->header); },
          [this](const ScanPtr& scan) { useScan(*scan); },
          [this](const ScanPtr&, WaitingQueue<ScanPtr>::GivenUp why, const std::string& missing) {
            if (why == WaitingQueue<ScanPtr>::GivenUp::kQueueFull) {
              drops_.drop("queue full",
                          std::to_string(params_.queue_size) + " scans wait for their transforms");
            } else {
              drops_.drop("no transform", missing);
            }
          }),
      last_now_(ros::Time::now()),
      reported_(ros::WallTime::now()),
      quiet_since_(reported_) {
  subscriber_ = nh.subscribe("scan", static_cast<std::uint32_t>(params_.queue_size),
                             &ScanInput::onScan, this, tcpNoDelay());
}

void ScanInput::holdWhile(std::function<bool(const ros::Time&)> busy) {
  waiting_.holdWhile(
      [busy = std::move(busy)](const ScanPtr& scan) { return busy(scan->header.stamp); });
}

void ScanInput::checkClock() {
  const ros::Time now = ros::Time::now();
  const double back = (last_now_ - now).toSec();
  last_now_ = now;
  if (back > kClockSlack) restartClock("the clock by " + seconds(back));
}

void ScanInput::restartClock(const std::string& jump) {
  ++time_jumps_;
  // Two clocks that fight give twenty a second: the first is told at once, the others counted.
  const ros::WallTime now = ros::WallTime::now();
  if (jumps_told_.isZero() || (now - jumps_told_).toSec() > kJumpReminderPeriod) {
    const std::size_t untold = time_jumps_ - jumps_counted_ - 1;
    ROS_WARN_STREAM(log_name_ << " time went back: " << jump << "; starting again"
                              << (untold > 0 ? ", and " + std::to_string(untold) +
                                                   " times since the last warning: two clocks?"
                                             : ""));
    jumps_told_ = now;
    jumps_counted_ = time_jumps_;
  }
  waiting_.clear();
  tf_.clear();
  last_stamp_ = ros::Time();
  on_time_jump_();
}

void ScanInput::onScan(const ScanPtr& scan) {
  checkClock();
  ++received_;
  const ros::Time stamp = scan->header.stamp;
  if (stamp.isZero()) {
    drops_.drop("refused", "the scan has no stamp");
    return;
  }
  if (scan->header.frame_id.empty()) {
    drops_.drop("refused", "the scan has no frame_id");
    return;
  }
  if (stamp <= last_stamp_) {
    const double back = (last_stamp_ - stamp).toSec();
    if (back < kStampSlack) {
      drops_.drop("refused", "its stamp " + seconds(stamp.toSec()) +
                                 " is not later than that of the scan before");
      return;
    }
    restartClock("the stamps of the scans by " + seconds(back));
  }
  last_stamp_ = stamp;
  waiting_.add(scan);
}

std::string ScanInput::missingTransformOf(const std_msgs::Header& header) const {
  std::string missing =
      missingTransform(tf_, params_.odom_frame_id, params_.base_frame_id, header.stamp);
  if (missing.empty()) {
    missing = missingTransform(tf_, params_.base_frame_id, header.frame_id, ros::Time(0));
  }
  return missing;
}

void ScanInput::useScan(const sensor_msgs::LaserScan& msg) {
  try {
    used_ += handleScan(msg);
  } catch (const InputError& e) {
    drops_.drop("refused", e.what());
  } catch (const tf2::TransformException& e) {  // gone between the question and the answer
    drops_.drop("no transform", e.what());
  }
}

bool ScanInput::handleScan(const sensor_msgs::LaserScan& msg) {
  LaserScan scan = fromMsg(msg, topic_);
  // Where the laser sits is taken to be rigid: the newest value is as good as the one at the time.
  const std::string laser = topic_ + ": frame " + msg.header.frame_id;
  placeLaser(
      spatialFromMsg(
          tf_.lookupTransform(params_.base_frame_id, msg.header.frame_id, ros::Time(0)).transform,
          laser),
      laser, &scan);
  const Pose2 base_in_odom = fromMsg(
      tf_.lookupTransform(params_.odom_frame_id, params_.base_frame_id, msg.header.stamp).transform,
      "tf " + params_.odom_frame_id + " -> " + params_.base_frame_id);
  const bool used = on_scan_(scan, base_in_odom, msg.header.stamp);
  logGeometry(msg);
  return used;
}

void ScanInput::logGeometry(const sensor_msgs::LaserScan& scan) {
  std::ostringstream text;
  text << scan.ranges.size() << " beams from " << scan.angle_min << " rad by "
       << scan.angle_increment << " rad, " << scan.range_min << " .. " << scan.range_max
       << " m, frame " << scan.header.frame_id;
  if (text.str() == geometry_) return;
  if (geometry_.empty()) {
    ROS_INFO_STREAM(log_name_ << " laser: " << text.str());
  } else {
    ++geometry_changes_;
    ROS_WARN_STREAM(log_name_ << " the laser changed: " << text.str() << " (it was: " << geometry_
                              << ")");
  }
  geometry_ = text.str();
}

std::optional<Pose2> ScanInput::baseInOdom(const ros::Time& at) const {
  try {
    return fromMsg(tf_.lookupTransform(params_.odom_frame_id, params_.base_frame_id, at).transform,
                   "tf");
  } catch (const tf2::TransformException&) {
  } catch (const InputError&) {
  }
  return std::nullopt;
}

std::optional<Pose2> ScanInput::motionSince(const ros::Time& from) const {
  const std::optional<Pose2> then = baseInOdom(from);
  const std::optional<Pose2> now = baseInOdom();
  if (!then || !now) return std::nullopt;
  return between(*then, *now);
}

void ScanInput::report(diagnostic_msgs::DiagnosticStatus& status) {
  using Status = diagnostic_msgs::DiagnosticStatus;
  const ros::WallTime now = ros::WallTime::now();
  const double elapsed = (now - reported_).toSec();
  const std::size_t fresh = received_ - reported_received_;
  const std::size_t dropped = drops_.total() - reported_drops_;
  reported_ = now;
  reported_received_ = received_;
  reported_drops_ = drops_.total();
  if (fresh > 0) {
    quiet_since_ = now;
  } else if ((now - quiet_since_).toSec() > kRemindEvery) {
    quiet_since_ = now;
    ROS_WARN_STREAM(log_name_ << " no scans on " << subscriber_.getTopic() << " ("
                              << subscriber_.getNumPublishers() << " publishers)");
  }
  if (fresh == 0) {
    addRemark(status, Status::WARN, "no scans");
  } else if (dropped > 0) {
    addRemark(status, Status::WARN, "dropping scans (" + drops_.last() + ")");
  }
  addValue(status, "scans received", received_);
  addValue(status, "scans used", used_);
  addValue(status, "scans waiting", waiting_.size());
  addValue(status, "scan rate [1/s]", elapsed > 0.0 ? static_cast<double>(fresh) / elapsed : 0.0);
  drops_.report(status);
  addValue(status, "time went back", time_jumps_);
  addValue(status, "laser", geometry_);
  addValue(status, "laser changed", geometry_changes_);
}

}  // namespace hyselam
