// The camera that an organised cloud comes from, as its points tell: u - cx = f x / z.
#pragma once

#include "hyselam_objects/object_mapper.hpp"

namespace hyselam_objects {

/// With the middle of the picture on the axis; the pose is left as it is. Throws
/// hyselam::InputError for clouds with hardly a point, or not in the order of a camera's picture.
PinholeCamera cameraOf(const OrganisedCloud& cloud);

}  // namespace hyselam_objects
