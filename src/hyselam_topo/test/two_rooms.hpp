// The smallest map with a door, drawn by hand.
#pragma once

#include "hyselam_topological_map/map_geometry.hpp"
#include "hyselam_topological_map/topological_map.hpp"

namespace two_rooms {

/// Place 1: x 0 .. 4, place 2: x 4.1 .. 8.1, both y 0 .. 3; between them a wall of 0.1 m with a
/// door at y 1.05 .. 1.95. Cells of 0.05 m.
inline hyselam_topo::AugmentedTopologicalMap map() {
  hyselam_topo::AugmentedTopologicalMap map;
  hyselam_topo::PlaceGrid grid;
  grid.geometry.resolution = 0.05;
  grid.geometry.width = 164;
  grid.geometry.height = 62;
  grid.geometry.origin = {-0.05, -0.05, 0.0};
  grid.labels.assign(grid.geometry.cellCount(), 0);
  grid.places = {1, 2};
  for (int y = 1; y <= 60; ++y) {
    for (int x = 1; x <= 162; ++x) {
      const bool in_door = y >= 22 && y < 40;
      if (x <= 80 || (x == 81 && in_door)) grid.labels[grid.geometry.index({x, y})] = 1;
      if (x > 82 || (x == 82 && in_door)) grid.labels[grid.geometry.index({x, y})] = 2;
    }
  }
  for (const hyselam_topo::Id id : {1u, 2u}) {
    hyselam_topo::Place place;
    place.id = id;
    place.area = 12.0;
    place.centre = hyselam_topo::Point3{id == 1 ? 2.0 : 6.1, 1.5, 0.0};
    map.places.push_back(place);
  }
  hyselam_topo::Edge edge;
  edge.a = 1;
  edge.b = 2;
  edge.doors.push_back(hyselam_topo::doorBetween({4.05, 1.95}, {4.05, 1.05}));
  edge.doors.back().id = 1;
  map.edges.push_back(edge);
  map.grid = grid;
  hyselam_topo::normalize(map);
  return map;
}

}  // namespace two_rooms
