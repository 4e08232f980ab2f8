// What a statement about objects means in the object map, before the map is changed.
#pragma once

#include "hyselam_objects/language/fill_map.hpp"

namespace hyselam_objects {

/// Where an object is stated to be.
struct FillMap::Target {
  Id place = 0;
  std::optional<RelationWord> word;
  Id landmark = 0;  ///< the object that it is related to
  Id room = 0;      ///< or the place: "in front of room 3"
};

/// The objects that one phrase of a statement means.
struct FillMap::PhraseMeaning {
  const ObjectPhrase* phrase = nullptr;
  std::vector<Id> known;
  int missing = 0;      ///< number of objects to add
  bool related = true;  ///< the relation of the statement holds for them
};

struct FillMap::StatementMeaning {
  Target target;  ///< its landmark is set when the map is changed
  bool place_stated = false;
  std::string room_name;            ///< of "in front of room 3"
  bool place_is_new = false;        ///< the place stated is not in the map yet
  bool robot_place_is_new = false;  ///< no place is stated, and that of the robot is not in the map
  std::vector<Id> landmarks;        ///< at most one
  bool landmark_is_listed = false;  ///< "a table and a cup on the table"
  std::vector<PhraseMeaning> phrases;
  std::vector<Id> surplus;  ///< corrected to fewer: objects to remove

  /// The target with the landmark, if that is known.
  Target knownTarget() const {
    Target known = target;
    known.landmark = landmarks.empty() ? 0 : landmarks.front();
    return known;
  }
};

}  // namespace hyselam_objects
