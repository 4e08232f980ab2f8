// What one frame more tells of an instance: a view of it moves its box (Kalman filter) and makes it
// more likely to be there, an empty place less (Bayes' rule).
#pragma once

#include <string>

#include "hyselam_objects/object_mapper.hpp"

namespace hyselam_objects {

/// `kind`: what the view was recognised as; "": nothing known.
void addView(ObjectInstance* object, const DetectedObject& seen, const std::string& kind,
             double stamp, const MapperParams& params);

/// It was not seen where it should have been.
void addMiss(ObjectInstance* object, double stamp, const MapperParams& params);

}  // namespace hyselam_objects
