// The camera of an organized cloud, estimated from its points: u - cx = f x / z.
#pragma once

#include "hyselam_objects/mapping/object_mapper.hpp"

namespace hyselam_objects {

/// With the principal point in the center of the image; the pose is left at its default.
/// @throws hyselam::InputError for clouds with few valid points, or whose points are not in the
/// order
///         of a camera's image.
PinholeCamera cameraFromCloud(const OrganizedCloud& cloud);

}  // namespace hyselam_objects
