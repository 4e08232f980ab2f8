#include "hyselam_common/ros/drop_counter.hpp"

#include <ros/console.h>

#include "hyselam_common/ros/diagnostics.hpp"

namespace hyselam {

namespace {
constexpr double kLogEvery = 10.0;  // [s] of wall time
}

void DropCounter::drop(const std::string& reason, const std::string& detail) {
  Tally& tally = tallies_[reason];
  ++tally.count;
  ++total_;
  last_ = reason + ": " + detail;
  const ros::WallTime now = ros::WallTime::now();
  if (tally.count > 1 && (now - tally.logged).toSec() < kLogEvery) return;
  tally.logged = now;
  ROS_WARN_STREAM(log_name_ << " " << message_kind_ << " dropped, " << last_ << " (" << tally.count
                            << " so far)");
}

std::size_t DropCounter::count(const std::string& reason) const {
  const auto found = tallies_.find(reason);
  return found == tallies_.end() ? 0 : found->second.count;
}

void DropCounter::report(diagnostic_msgs::DiagnosticStatus& status) const {
  addValue(status, message_kind_ + "s dropped", total_);
  for (const auto& [reason, tally] : tallies_) addValue(status, "dropped: " + reason, tally.count);
  if (!last_.empty()) addValue(status, "last dropped", last_);
}

}  // namespace hyselam
