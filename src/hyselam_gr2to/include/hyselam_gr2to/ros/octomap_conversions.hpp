// From the message of an OctoMap to its voxels.
#pragma once

#include <octomap_msgs/Octomap.h>

#include <string>

#include "hyselam_gr2to/octomap/octomap_reader.hpp"

namespace hyselam_topo {

/// @throws hyselam::InputError as octoMapFromData(), and for more bytes than `limits` allow.
VoxelMap fromMsg(const octomap_msgs::Octomap& msg, const std::string& source,
                 const OctoMapLimits& limits = {});

}  // namespace hyselam_topo
