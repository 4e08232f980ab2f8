// "PLACE=NAME" of a command line: the id of a place of the map and a name.
#pragma once

#include <string>
#include <utility>

#include "hyselam_common/errors.hpp"
#include "hyselam_topological_map/topological_map.hpp"

namespace hyselam_topo {

/// Throws hyselam::InputError with the option and the text for anything else.
inline std::pair<Id, std::string> placeAndName(const std::string& option, const std::string& text) {
  const std::size_t sign = text.find('=');
  if (sign == std::string::npos || sign == 0)
    throw hyselam::InputError(option, text, "is not PLACE=NAME");
  Id place = 0;
  for (const char c : text.substr(0, sign)) {
    if (c < '0' || c > '9' || place > 100000000)
      throw hyselam::InputError(option, text, "does not begin with the id of a place");
    place = place * 10 + static_cast<Id>(c - '0');
  }
  return {place, text.substr(sign + 1)};
}

}  // namespace hyselam_topo
