#include "fsd_localization/ros/scan_input.hpp"

#include <cmath>
#include <sstream>

#include "fsd_localization/ros/diagnostics.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/ros/conversions.hpp"
#include "hyselam_common/ros/transport.hpp"

namespace fsd_localization {

namespace {

constexpr double kClockSlack = 0.5;    // [s] a smaller step back is a clock being adjusted
constexpr double kStampSlack = 2.0;    // [s] an older scan is not late: the bag began again
constexpr double kRetryEvery = 0.01;   // [s] while scans wait
constexpr double kRemindEvery = 10.0;  // [s] of wall time without scans

std::string seconds(double s) {
  std::ostringstream out;
  out.precision(3);
  out << std::fixed << s << " s";
  return out.str();
}

}  // namespace

ScanInput::ScanInput(ros::NodeHandle nh, const ScanInputParams& params, const std::string& who,
                     ScanHandler on_scan, TimeHandler on_time_back)
    : params_(params),
      who_(who),
      topic_(nh.resolveName("scan")),
      on_scan_(std::move(on_scan)),
      on_time_back_(std::move(on_time_back)),
      drops_(who),
      tf_listener_(tf_, true, hyselam::promptly()),
      last_now_(ros::Time::now()),
      reported_(ros::WallTime::now()),
      quiet_since_(reported_) {
  retry_ = nh.createWallTimer(
      ros::WallDuration(kRetryEvery), [this](const ros::WallTimerEvent&) { serveWaiting(); }, false,
      false);
  subscriber_ = nh.subscribe("scan", static_cast<std::uint32_t>(params_.queue_size),
                             &ScanInput::onScan, this, hyselam::promptly());
}

void ScanInput::checkClock() {
  const ros::Time now = ros::Time::now();
  const double back = (last_now_ - now).toSec();
  last_now_ = now;
  if (back > kClockSlack) timeWentBack("the clock by " + seconds(back));
}

void ScanInput::timeWentBack(const std::string& what) {
  ++time_jumps_;
  ROS_WARN_STREAM(who_ << " time went back: " << what << "; starting afresh");
  waiting_.clear();
  retry_.stop();
  tf_.clear();
  last_stamp_ = ros::Time();
  on_time_back_();
}

void ScanInput::onScan(const sensor_msgs::LaserScan::ConstPtr& scan) {
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
    timeWentBack("the stamps of the scans by " + seconds(back));
  }
  last_stamp_ = stamp;
  if (waiting_.size() >= static_cast<std::size_t>(params_.queue_size)) {
    drops_.drop("queue full",
                std::to_string(params_.queue_size) + " scans wait for their transforms");
    waiting_.pop_front();
  }
  waiting_.push_back({scan, ros::Time::now(), ros::WallTime::now()});
  serveWaiting();
}

bool ScanInput::waitedLongEnough(const Waiting& w) const {
  // In both times: a paused bag is no reason to give up, nor is a bag played many times too fast.
  return (ros::WallTime::now() - w.wall_since).toSec() >= params_.transform_wait &&
         (ros::Time::now() - w.since).toSec() >= params_.transform_wait;
}

std::string ScanInput::missingTransform(const std_msgs::Header& header) const {
  std::string why;
  if (!tf_.canTransform(params_.odom_frame_id, params_.base_frame_id, header.stamp, &why)) {
    return params_.odom_frame_id + " -> " + params_.base_frame_id + " at " +
           seconds(header.stamp.toSec()) + ": " + why;
  }
  if (!tf_.canTransform(params_.base_frame_id, header.frame_id, ros::Time(0), &why)) {
    return params_.base_frame_id + " -> " + header.frame_id + ": " + why;
  }
  return "";
}

void ScanInput::serveWaiting() {
  while (!waiting_.empty()) {
    const Waiting& first = waiting_.front();
    const std::string why = missingTransform(first.scan->header);
    if (!why.empty()) {
      if (!waitedLongEnough(first)) break;
      drops_.drop("no transform", why);
    } else {
      const sensor_msgs::LaserScan::ConstPtr scan = first.scan;
      try {
        used_ += serve(*scan);
      } catch (const hyselam::InputError& e) {
        drops_.drop("refused", e.what());
      } catch (const tf2::TransformException& e) {  // gone between the question and the answer
        drops_.drop("no transform", e.what());
      }
    }
    waiting_.pop_front();
  }
  if (waiting_.empty())
    retry_.stop();
  else
    retry_.start();
}

bool ScanInput::serve(const sensor_msgs::LaserScan& msg) {
  hyselam::LaserScan scan = hyselam::fromMsg(msg, topic_);
  // Where the laser sits is taken to be rigid: the newest value is as good as the one at the time.
  const geometry_msgs::Transform laser =
      tf_.lookupTransform(params_.base_frame_id, msg.header.frame_id, ros::Time(0)).transform;
  const tf2::Quaternion turn(laser.rotation.x, laser.rotation.y, laser.rotation.z,
                             laser.rotation.w);
  const tf2::Vector3 at(laser.translation.x, laser.translation.y, laser.translation.z);
  hyselam::placeLaser(tf2::Transform(turn.normalized(), at),
                      topic_ + ": frame " + msg.header.frame_id, &scan);
  const hyselam::Pose2 base_in_odom = hyselam::fromMsg(
      tf_.lookupTransform(params_.odom_frame_id, params_.base_frame_id, msg.header.stamp).transform,
      "tf " + params_.odom_frame_id + " -> " + params_.base_frame_id);
  const bool used = on_scan_(scan, base_in_odom, msg.header.stamp);
  noteGeometry(msg);
  return used;
}

void ScanInput::noteGeometry(const sensor_msgs::LaserScan& scan) {
  std::ostringstream text;
  text << scan.ranges.size() << " beams from " << scan.angle_min << " rad by "
       << scan.angle_increment << " rad, " << scan.range_min << " .. " << scan.range_max
       << " m, frame " << scan.header.frame_id;
  if (text.str() == geometry_) return;
  if (geometry_.empty()) {
    ROS_INFO_STREAM(who_ << " laser: " << text.str());
  } else {
    ++geometry_changes_;
    ROS_WARN_STREAM(who_ << " the laser changed: " << text.str() << " (it was: " << geometry_
                         << ")");
  }
  geometry_ = text.str();
}

std::optional<hyselam::Pose2> ScanInput::motionSince(const ros::Time& from) const {
  try {
    const auto at = [&](const ros::Time& time) {
      return hyselam::fromMsg(
          tf_.lookupTransform(params_.odom_frame_id, params_.base_frame_id, time).transform, "tf");
    };
    return hyselam::between(at(from), at(ros::Time(0)));
  } catch (const tf2::TransformException&) {
  } catch (const hyselam::InputError&) {
  }
  return std::nullopt;
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
    ROS_WARN_STREAM(who_ << " no scans on " << subscriber_.getTopic() << " ("
                         << subscriber_.getNumPublishers() << " publishers)");
  }
  if (fresh == 0)
    addRemark(status, Status::WARN, "no scans");
  else if (dropped > 0)
    addRemark(status, Status::WARN, "dropping scans (" + drops_.last() + ")");
  addValue(status, "scans received", received_);
  addValue(status, "scans used", used_);
  addValue(status, "scans waiting", waiting_.size());
  addValue(status, "scan rate [1/s]", elapsed > 0.0 ? static_cast<double>(fresh) / elapsed : 0.0);
  drops_.report(status);
  addValue(status, "time went back", time_jumps_);
  addValue(status, "laser", geometry_);
  addValue(status, "laser changed", geometry_changes_);
}

}  // namespace fsd_localization
