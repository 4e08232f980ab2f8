// Whether a frame shows that the place of a thing is free: what is hidden is not missed.
#pragma once

#include "hyselam_objects/object_mapper.hpp"

namespace hyselam_objects {

/// Follows rays of pixels through the middle part of the thing's box: its place is free if nearly
/// all of them end behind it. A low thing hides little of what is behind it, so how far behind is
/// not asked, only that it is beyond the box by more than the noise.
bool looksThrough(const OrganisedCloud& cloud, const PinholeCamera& camera, const ObjectPose& pose,
                  const MapperParams& params);

}  // namespace hyselam_objects
