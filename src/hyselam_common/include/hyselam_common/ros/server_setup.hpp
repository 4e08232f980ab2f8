// What all servers do with their parameters at the start.
#pragma once

#include <ros/console.h>

#include <string>

#include "hyselam_common/ros/params.hpp"

namespace hyselam {

/// How a server calls itself in the log.
inline std::string logName(const ros::NodeHandle& private_nh) {
  return "[" + private_nh.getNamespace() + "]";
}

/// Loads, warns of unknown names and logs the resolved table.
template <typename Params>
Params loadAndTell(const ros::NodeHandle& private_nh, Params (*load)(ParamLoader&)) {
  ParamLoader loader(private_nh);
  const Params params = load(loader);
  loader.logWarnings();
  ROS_INFO_STREAM("parameters of " << loader.table());
  return params;
}

}  // namespace hyselam
