// Parameters that may change while the server runs, where the platform has dynamic_reconfigure.
#pragma once

#include <ros/ros.h>

#include <memory>

#include "hyselam_topo/ros/gr2to_server.hpp"

namespace hyselam_topo {

/// What is returned offers them as long as it lives, and must not outlive `server`; null where
/// dynamic_reconfigure is missing.
std::shared_ptr<void> makeDynamicParameters(const ros::NodeHandle& private_nh, Gr2ToServer* server);

}  // namespace hyselam_topo
