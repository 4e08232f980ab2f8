// Options of offline tools for topics and frames of bags.
#pragma once

#include <CLI/CLI.hpp>

#include "hyselam_common/ros/bag_io.hpp"

namespace hyselam {

/// Adds --scan-topic, --odom-topic, --odom-frame and --base-frame; `bag` gets them.
inline void addBagOptions(CLI::App& app, BagOptions* bag) {
  app.add_option("--scan-topic", bag->scan_topic,
                 "of a bag: laser scans; by default also the only topic of scans");
  app.add_option("--odom-topic", bag->odometry_topic,
                 "of a bag: nav_msgs/Odometry; by default also the only one, else tf");
  app.add_option("--odom-frame", bag->odom_frame, "of a bag: frame of the odometry in tf");
  app.add_option("--base-frame", bag->base_frame, "of a bag: frame of the robot");
}

}  // namespace hyselam
