// What carries an object: no object floats, and what continues above the objects is no object.
#pragma once

#include <vector>

#include "horizontal_surfaces.hpp"

namespace hyselam_objects {

/// Whether it reaches the largest height of objects on a surface: then it is something taller, a
/// wall, a window. `surfaces`: the highest first.
bool exceedsObjectHeight(const DetectedObject& object,
                         const std::vector<HorizontalSurface>& surfaces,
                         const DetectParams& params);

/// Whether neither a surface nor another object carries it: its lower part is hidden, or it hangs
/// at a wall.
bool isFloating(const DetectedObject& object, const std::vector<DetectedObject>& others,
                const std::vector<HorizontalSurface>& surfaces,
                const Eigen::Vector3f& camera_position, const DetectParams& params);

}  // namespace hyselam_objects
