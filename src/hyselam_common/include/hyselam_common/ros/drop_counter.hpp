// Messages that were not used: why and how often, logged now and then, and shown in the
// diagnostics.
#pragma once

#include <diagnostic_msgs/DiagnosticStatus.h>
#include <ros/time.h>

#include <map>
#include <string>
#include <utility>

namespace hyselam {

/// Not thread safe: for the callbacks of one queue.
class DropCounter {
 public:
  /// @param log_name begins the warnings ("[/localization]").
  /// @param message_kind what is dropped.
  explicit DropCounter(std::string log_name, std::string message_kind = "scan")
      : log_name_(std::move(log_name)), message_kind_(std::move(message_kind)) {}

  /// Counts one; warns at the first one of a reason, then at most once in ten seconds of wall time.
  /// @param reason a fixed word or two ("no transform"), @param detail what is special this time.
  void drop(const std::string& reason, const std::string& detail);

  std::size_t total() const { return total_; }
  std::size_t count(const std::string& reason) const;
  /// Reason and detail of the last one; empty at first.
  const std::string& last() const { return last_; }
  /// One value per reason: "dropped: no transform" = 12.
  void report(diagnostic_msgs::DiagnosticStatus& status) const;

 private:
  struct Tally {
    std::size_t count = 0;
    ros::WallTime logged;
  };
  std::string log_name_, message_kind_;
  std::map<std::string, Tally> tallies_;
  std::size_t total_ = 0;
  std::string last_;
};

}  // namespace hyselam
