#include "hyselam_gr2to/ros/octomap_conversions.hpp"

#include "hyselam_common/errors.hpp"

namespace hyselam_topo {

VoxelMap fromMsg(const octomap_msgs::Octomap& msg, const std::string& source,
                 const OctoMapLimits& limits) {
  if (msg.data.size() > limits.max_bytes) {  // before it is copied
    throw hyselam::InputError(source, "data",
                              "has " + std::to_string(msg.data.size()) + " bytes, more than " +
                                  std::to_string(limits.max_bytes));
  }
  const std::string data(msg.data.begin(), msg.data.end());
  return octoMapFromData(data, msg.binary != 0, msg.id, msg.resolution, source, limits);
}

}  // namespace hyselam_topo
