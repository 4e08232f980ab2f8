// Which instance of the map each detection of a frame is: the nearest in place and looks, all pairs
// at once.
#pragma once

#include "hyselam_objects/object_mapper.hpp"

namespace hyselam_objects {

/// The detections without those that are several known things in one, whose ids are added to
/// `within`, and without tops of things on known furniture.
std::vector<DetectedObject> singleThings(const ObjectMap& map,
                                         const std::vector<DetectedObject>& all, double stamp,
                                         const MapperParams& params, std::vector<Id>* within);

/// For each detection the index of its instance, -1: none.
std::vector<int> associate(const ObjectMap& map, const std::vector<DetectedObject>& detections,
                           double stamp, const MapperParams& params);

}  // namespace hyselam_objects
