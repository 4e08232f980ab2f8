// Which places of the robot's map does a person mean? The corridor (place 1) has a room on each
// side; the person says what is on the left.
#include "hyselam_topo/topomerg/topomerg.hpp"

#include <cstdio>

#include "hyselam_language/building/description_builder.hpp"

int main() {
  hyselam_topo::AugmentedTopologicalMap map;
  const auto addPlace = [&map](hyselam_topo::Id id, double y, double area) {
    hyselam_topo::Place place;
    place.id = id;
    place.centre = {0.0, y, 0.0};
    place.area = area;
    map.places.push_back(place);
  };
  addPlace(1, 0.0, 30.0);
  addPlace(2, 5.0, 20.0);   // left of a robot that looks along x
  addPlace(3, -5.0, 20.0);  // right of it
  for (const hyselam_topo::Id room : {2, 3}) {
    hyselam_topo::Edge edge;
    edge.a = 1;
    edge.b = room;
    map.edges.push_back(edge);
  }
  map.next_place_id = 4;

  const hyselam_topo::TopoParser parser;
  hyselam_topo::DescriptionBuilder description(parser);
  description.add(parser.parse("You are in the corridor. On your left you have the kitchen."));
  const hyselam_topo::MatchObserver robot{1, 0.0};  // in place 1, heading 0 rad
  const hyselam_topo::MatchProblem problem =
      hyselam_topo::compileMatch(description.building(), map, robot);
  const hyselam_topo::PlaceAssignment match = hyselam_topo::solveExact(problem, {});
  for (std::size_t v = 0; v < problem.vertexCount(); ++v) {
    const int name = match.best().assignment[v];
    std::printf("place %d: %s\n", static_cast<int>(problem.vertices[v]),
                name < 0
                    ? "-"
                    : description.building().places[static_cast<std::size_t>(name)].name.c_str());
  }
  std::printf("fitness %.2f, the best: %s\n", match.best().fitness, match.optimal ? "yes" : "no");
  return 0;
}
