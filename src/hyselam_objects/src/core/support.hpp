// What carries a thing: nothing stands in the air, and what goes on above things is no thing.
#pragma once

#include <vector>

#include "level_surfaces.hpp"

namespace hyselam_objects {

/// Whether it goes on to the greatest height of things on a surface: then it is something taller, a
/// wall, a window. `surfaces`: the highest first.
bool isTaller(const DetectedObject& object, const std::vector<LevelSurface>& surfaces,
              const DetectParams& params);

/// Whether it seems to stand in the air: its lower part is hidden, or it hangs at a wall. Surfaces
/// carry it, and other things do. `eye`: where the camera is.
bool isFloating(const DetectedObject& object, const std::vector<DetectedObject>& others,
                const std::vector<LevelSurface>& surfaces, const Eigen::Vector3f& eye,
                const DetectParams& params);

}  // namespace hyselam_objects
