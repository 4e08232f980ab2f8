// How servers name themselves in the log and load their parameters.
#pragma once

#include <ros/console.h>

#include <string>

#include "hyselam_common/ros/params.hpp"

namespace hyselam {

/// The prefix of a server's log messages: "[/namespace/name]".
inline std::string logName(const ros::NodeHandle& private_nh) {
  return "[" + private_nh.getNamespace() + "]";
}

/// Loads the parameters, warns of unknown and renamed ones and logs the resolved table
/// at DEBUG: at INFO a hundred lines would hide what matters.
template <typename Params>
Params loadAndLogParams(const ros::NodeHandle& private_nh, Params (*load)(ParamLoader&)) {
  ParamLoader loader(private_nh);
  const Params params = load(loader);
  loader.logWarnings();
  ROS_DEBUG_STREAM("parameters of " << loader.table());
  ROS_INFO_STREAM(logName(private_nh) << " parameters read; at level DEBUG they are listed");
  return params;
}

}  // namespace hyselam
