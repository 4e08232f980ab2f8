// A topological map for tests.
#pragma once

#include "hyselam_topological_map/topological_map.hpp"

namespace selovis {
namespace testing {

/// Four rooms of 2 m x 2 m in a row: "store", "kitchen", one without a name, "store".
inline hyselam_topo::AugmentedTopologicalMap fourRooms() {
  hyselam_topo::AugmentedTopologicalMap map;
  hyselam_topo::PlaceGrid grid;
  grid.geometry = {40, 10, 0.2, {1.0, -1.0, 0.0}};
  const char* const names[] = {"store", "kitchen", "", "store"};
  for (hyselam_topo::Id id = 1; id <= 4; ++id) {
    hyselam_topo::Place place;
    place.id = id;
    if (*names[id - 1] != '\0') place.words.push_back({names[id - 1], id == 1});
    place.centre = hyselam::Point3{2.0 * id, 0.0, 0.0};
    grid.places.push_back(id);
    map.places.push_back(place);
    if (id > 1) {
      hyselam_topo::Edge edge;
      edge.a = id - 1;
      edge.b = id;
      map.edges.push_back(edge);
    }
  }
  for (int y = 0; y < 10; ++y) {
    for (int x = 0; x < 40; ++x) grid.labels.push_back(static_cast<std::uint16_t>(1 + x / 10));
  }
  map.grid = grid;
  hyselam_topo::normalize(map);
  return map;
}

}  // namespace testing
}  // namespace selovis
