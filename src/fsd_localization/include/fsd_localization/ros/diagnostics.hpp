// The diagnostics of hyselam_common under the names of this package.
#pragma once

#include "hyselam_common/ros/diagnostics.hpp"

namespace fsd_localization {

using hyselam::addRemark;
using hyselam::addValue;
using hyselam::Diagnostics;

}  // namespace fsd_localization
