// The tops of furniture in a frame: level surfaces above the floor.
#pragma once

#include <vector>

#include "hull.hpp"
#include "mapped_frame.hpp"

namespace hyselam_objects {

struct LevelSurface {
  double height = 0.0;  ///< above the floor [m]
  std::vector<std::size_t> pixels;
  Hull hull;  ///< in the plane of the map
};

/// Large enough ones that are not the tops of things on others, the highest first. What things on
/// them cut in two is one.
std::vector<LevelSurface> findLevelSurfaces(const MappedFrame& frame, const DetectParams& params);

}  // namespace hyselam_objects
