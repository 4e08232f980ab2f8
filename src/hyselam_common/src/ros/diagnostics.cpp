#include "hyselam_common/ros/diagnostics.hpp"

#include <diagnostic_msgs/DiagnosticArray.h>

#include <algorithm>

#include "hyselam_common/version.hpp"

namespace hyselam {

Diagnostics::Diagnostics(ros::NodeHandle nh, const std::string& name, double period,
                         std::function<void(diagnostic_msgs::DiagnosticStatus&)> fill)
    : name_(name), fill_(std::move(fill)) {
  publisher_ = nh.advertise<diagnostic_msgs::DiagnosticArray>("/diagnostics", 10);
  timer_ = nh.createWallTimer(ros::WallDuration(period),
                              [this](const ros::WallTimerEvent&) { publish(); });
}

void Diagnostics::publish() {
  diagnostic_msgs::DiagnosticArray array;
  array.header.stamp = ros::Time::now();
  array.status.emplace_back();
  diagnostic_msgs::DiagnosticStatus& status = array.status.back();
  status.name = name_;
  status.hardware_id =
      std::string("HySeLAM ") + version();  // of what runs, which may not be what is installed
  status.level = diagnostic_msgs::DiagnosticStatus::OK;
  fill_(status);
  publisher_.publish(array);
}

void addRemark(diagnostic_msgs::DiagnosticStatus& status, std::int8_t level,
               const std::string& text) {
  status.level = std::max<std::int8_t>(static_cast<std::int8_t>(status.level), level);
  status.message += (status.message.empty() ? "" : "; ") + text;
}

}  // namespace hyselam
