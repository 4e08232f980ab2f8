// What several parts ask of an instance of the map: of which sort it is, and when a stay of it is
// over.
#pragma once

#include "hyselam_objects/object_map.hpp"

namespace hyselam_objects {

constexpr char kUnknown[] = "thing";        ///< kind of what is not in the dictionary
constexpr char kFurniture[] = "furniture";  ///< kind of such furniture; property of all furniture
/// A stay is left when nothing was seen there for so long: then it is another visit [s].
constexpr double kAbsence = 60.0;

inline bool isFurniture(const ObjectInstance& object) {
  return object.properties.count(kFurniture) != 0;
}

}  // namespace hyselam_objects
