#include "hyselam_topological_map/place_code.hpp"

#include <cstdio>

namespace hyselam_topo {

std::string codeOf(const Place& place) {
  const char* kind = place.kind == PlaceKind::kCorridor  ? "CC"
                     : place.kind == PlaceKind::kVirtual ? "VV"
                                                         : "SS";
  char text[24];
  std::snprintf(text, sizeof text, "%s%02u", kind, static_cast<unsigned>(place.id));
  return text;
}

}  // namespace hyselam_topo
