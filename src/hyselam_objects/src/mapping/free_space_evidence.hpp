// Negative evidence: whether a frame shows that the place of an object is free, or something else
// there. A hidden object is not missed.
#pragma once

#include "hyselam_objects/mapping/object_mapper.hpp"

namespace hyselam_objects {

/// What a frame tells of the place of an object that is not detected in it.
enum class PlaceEvidence {
  kNone,        ///< it is hidden, too far away or not in the frame
  kFree,        ///< nearly all rays through it end behind it
  kOverlooked,  ///< nearly all rays end on something in it, which was not taken for this object
};

/// Casts rays of pixels through the inner part of the object's box: its place is free if nearly all
/// of them end behind it. A low object hides little of what is behind it, so it is enough that a
/// ray ends beyond the box by more than the noise.
PlaceEvidence evidenceOf(const OrganizedCloud& cloud, const PinholeCamera& camera,
                         const ObjectPose& pose, const MapperParams& params);

}  // namespace hyselam_objects
