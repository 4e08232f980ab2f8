// Data association: the instance of the map of each detection of a frame, by position and
// appearance, all pairs at once.
#pragma once

#include "hyselam_objects/mapping/object_mapper.hpp"

namespace hyselam_objects {

struct SeparateDetections {
  std::vector<DetectedObject> detections;
  std::vector<Id> merged;  ///< instances that a detection left out shows together
};

/// The detections without those that show several known objects as one, and without tops of objects
/// on known furniture.
SeparateDetections separateDetections(const ObjectMap& map, const std::vector<DetectedObject>& all,
                                      double stamp, const MapperParams& params);

/// For each detection the index of its instance, -1: none.
std::vector<int> associateDetections(const ObjectMap& map,
                                     const std::vector<DetectedObject>& detections, double stamp,
                                     const MapperParams& params);

}  // namespace hyselam_objects
