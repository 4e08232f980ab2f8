// Properties of an instance of the object map that several parts need.
#pragma once

#include "hyselam_objects/mapping/object_map.hpp"

namespace hyselam_objects {

constexpr char kUnknownKind[] = "thing";  ///< kind of an object that was not recognized
constexpr char kFurnitureKind[] =
    "furniture";  ///< such furniture; also a property of all furniture
/// A stay is over when the object was not seen there for so long; then it is another visit [s].
constexpr double kMaxAbsence = 60.0;

inline bool isFurniture(const ObjectInstance& object) {
  return object.properties.count(kFurnitureKind) != 0;
}

inline void forgetOldStays(ObjectInstance& object) {
  auto& all = object.history;
  if (all.size() > kMostStays) all.erase(all.begin(), all.end() - kMostStays);
}

}  // namespace hyselam_objects
