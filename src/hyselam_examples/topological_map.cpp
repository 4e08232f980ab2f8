// A topological map made by hand: two named places and a door, as XML and back.
#include "hyselam_topological_map/topological_map.hpp"

#include <cstdio>

#include "hyselam_topological_map/topological_map_xml.hpp"

int main() {
  hyselam_topo::AugmentedTopologicalMap map;
  map.places.resize(2);
  map.places[0].id = 1;
  map.places[0].words = {{"kitchen", true}};
  map.places[1].id = 2;
  map.places[1].kind = hyselam_topo::PlaceKind::kCorridor;
  map.edges.resize(1);
  map.edges[0].a = 1;
  map.edges[0].b = 2;
  map.edges[0].doors.resize(1);
  map.edges[0].doors[0].id = 1;
  map.edges[0].doors[0].width = 0.9;
  normalize(map);

  const auto read = hyselam_topo::fromXml(hyselam_topo::toXml(map));
  for (const hyselam_topo::Place& place : read.places) std::puts(nameOf(place).c_str());
  std::printf("%.1f m wide, the same map: %s\n", read.findEdge(2, 1)->doors[0].width,
              read == map ? "yes" : "no");
  return 0;
}
