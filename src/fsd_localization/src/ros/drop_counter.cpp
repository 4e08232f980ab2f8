#include "fsd_localization/ros/drop_counter.hpp"

#include <ros/console.h>

#include "fsd_localization/ros/diagnostics.hpp"

namespace fsd_localization {

namespace {
constexpr double kTellEvery = 10.0;  // [s] of wall time
}

void DropCounter::drop(const std::string& reason, const std::string& detail) {
  Tally& tally = tallies_[reason];
  ++tally.count;
  ++total_;
  last_ = reason + ": " + detail;
  const ros::WallTime now = ros::WallTime::now();
  if (tally.count > 1 && (now - tally.told).toSec() < kTellEvery) return;
  tally.told = now;
  ROS_WARN_STREAM(who_ << " " << what_ << " dropped, " << last_ << " (" << tally.count
                       << " so far)");
}

std::size_t DropCounter::count(const std::string& reason) const {
  const auto found = tallies_.find(reason);
  return found == tallies_.end() ? 0 : found->second.count;
}

void DropCounter::report(diagnostic_msgs::DiagnosticStatus& status) const {
  addValue(status, what_ + "s dropped", total_);
  for (const auto& [reason, tally] : tallies_) addValue(status, "dropped: " + reason, tally.count);
  if (!last_.empty()) addValue(status, "last dropped", last_);
}

}  // namespace fsd_localization
