// The setup of servers of hyselam_common under the names of this package.
#pragma once

#include "hyselam_common/ros/server_setup.hpp"

namespace fsd_localization {

using hyselam::loadAndTell;
using hyselam::logName;

}  // namespace fsd_localization
