// The tops of furniture in a frame: horizontal surfaces above the floor.
#pragma once

#include <vector>

#include "convex_hull.hpp"
#include "mapped_frame.hpp"

namespace hyselam_objects {

struct HorizontalSurface {
  double height = 0.0;  ///< above the floor [m]
  std::vector<std::size_t> pixels;
  ConvexHull hull;  ///< in the plane of the map
};

/// Those large enough that are not the tops of objects on others, the highest first. Parts of one
/// top that objects on it separate in the image are merged.
std::vector<HorizontalSurface> findHorizontalSurfaces(const MappedFrame& frame,
                                                      const DetectParams& params);

}  // namespace hyselam_objects
