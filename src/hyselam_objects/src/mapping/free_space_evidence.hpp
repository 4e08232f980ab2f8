// Negative evidence: whether a frame shows that the place of an object is free. A hidden object is
// not missed.
#pragma once

#include "hyselam_objects/mapping/object_mapper.hpp"

namespace hyselam_objects {

/// Casts rays of pixels through the inner part of the object's box: its place is free if nearly all
/// of them end behind it. A low object hides little of what is behind it, so it is enough that a
/// ray ends beyond the box by more than the noise.
bool showsFreeSpace(const OrganizedCloud& cloud, const PinholeCamera& camera,
                    const ObjectPose& pose, const MapperParams& params);

}  // namespace hyselam_objects
