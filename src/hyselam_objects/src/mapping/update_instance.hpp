// Update of an instance of the object map with one frame: a detection moves its box (Kalman filter)
// and makes its existence more probable, an empty place less (Bayes' rule).
#pragma once

#include <string>

#include "hyselam_objects/mapping/object_mapper.hpp"

namespace hyselam_objects {

/// `kind`: as which the detection was recognized; "": not recognized.
void addDetection(ObjectInstance& object, const DetectedObject& seen, const std::string& kind,
                  double stamp, const MapperParams& params);

/// The frame shows that its place is free.
void addMissedDetection(ObjectInstance& object, double stamp, const MapperParams& params);

}  // namespace hyselam_objects
