// One status on /diagnostics, in wall time: a bag that stops, or a clock that jumps, shall show.
#pragma once

#include <diagnostic_msgs/DiagnosticStatus.h>
#include <ros/ros.h>

#include <functional>
#include <sstream>
#include <string>

namespace hyselam {

class Diagnostics {
 public:
  /// `fill` is called before each message, on the queue of `nh`, with level OK and no text.
  Diagnostics(ros::NodeHandle nh, const std::string& name, double period,
              std::function<void(diagnostic_msgs::DiagnosticStatus&)> fill);

 private:
  void publish();

  std::string name_;
  std::function<void(diagnostic_msgs::DiagnosticStatus&)> fill_;
  ros::Publisher publisher_;
  ros::WallTimer timer_;
};

/// Raises the level (never lowers it) and appends to the message.
void addRemark(diagnostic_msgs::DiagnosticStatus& status, std::int8_t level,
               const std::string& text);

template <typename T>
void addValue(diagnostic_msgs::DiagnosticStatus& status, const std::string& key, const T& value) {
  std::ostringstream text;
  text << std::boolalpha << value;
  status.values.emplace_back();
  status.values.back().key = key;
  status.values.back().value = text.str();
}

}  // namespace hyselam
