// Gr2To finds the places of a grid map and the door between them.
#include "hyselam_gr2to/gr2to.hpp"

#include <cstdio>

#include "hyselam_common/testing/drawn_grid.hpp"

int main() {
  const std::vector<std::string> drawing = {
      "##################",  //
      "#.......#........#",  //
      "#.......#........#",  //
      "#.......#........#",  //
      "#................#",  //
      "#................#",  //
      "#.......#........#",  //
      "#.......#........#",  //
      "##################",  //
  };
  const hyselam::OccupancyGrid grid = hyselam::testing::drawnGrid(drawing, 0.5);
  const hyselam_topo::AugmentedTopologicalMap map = hyselam_topo::gr2to(grid).map;
  for (const hyselam_topo::Place& place : map.places) {
    std::printf("place %u: %s of %.1f m2\n", place.id, toString(place.kind), place.area);
  }
  for (const hyselam_topo::Edge& edge : map.edges) {
    for (const hyselam_topo::Door& door : edge.doors) {
      std::printf("%s of %.1f m between %u and %u\n", door.real ? "door" : "open border",
                  door.width, edge.a, edge.b);
    }
  }
  return 0;
}
