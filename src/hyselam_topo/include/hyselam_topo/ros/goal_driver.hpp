// Waypoints, one after another, to the action move_base.
#pragma once

#include <ros/ros.h>

#include <memory>
#include <string>
#include <vector>

#include "hyselam_common/pose2.hpp"

namespace hyselam_topo {

/// Callbacks run on the queue of `nh`. Without move_base_msgs at build time it does nothing.
class GoalDriver {
 public:
  explicit GoalDriver(const ros::NodeHandle& nh);
  ~GoalDriver();

  /// Whether this was built with move_base_msgs and a server is there.
  bool available() const;
  /// Drives from goal to goal; earlier goals are canceled. Does nothing without a server.
  void drive(std::vector<hyselam::Pose2> goals, const std::string& frame_id);
  /// Cancels the current goals.
  void stop();

  /// "", "driving", "arrived", "ABORTED at 2 of 5", ...
  const std::string& status() const;

 private:
  class Client;
  std::unique_ptr<Client> client_;
};

}  // namespace hyselam_topo
