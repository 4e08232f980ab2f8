// Parameters that may change while the server runs, under amcl's names, where the platform has
// dynamic_reconfigure.
#pragma once

#include <ros/ros.h>

#include <memory>

#include "fsd_localization/ros/localization_server.hpp"

namespace fsd_localization {

/// What is returned offers them as long as it lives, and must not outlive `server`; null where
/// dynamic_reconfigure is missing.
std::shared_ptr<void> makeDynamicParameters(const ros::NodeHandle& private_nh,
                                            LocalizationServer* server);

}  // namespace fsd_localization
