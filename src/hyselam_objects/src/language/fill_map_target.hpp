#pragma once

#include "hyselam_objects/fill_map.hpp"

namespace hyselam_objects {

/// Where something is said to be.
struct FillMap::Target {
  Id place = 0;
  std::optional<RelationWord> word;
  Id landmark = 0;
};

}  // namespace hyselam_objects
