// Rooms that only their objects tell apart.
#include <gtest/gtest.h>

#include "hyselam_common/errors.hpp"
#include "hyselam_objects/language/fill_map.hpp"
#include "hyselam_objects/language/place_evidence.hpp"
#include "hyselam_topo/topomerg/topomerg.hpp"

using namespace hyselam_objects;  // NOLINT: a test, not a header
using hyselam_topo::MatchProblem;

namespace {

/// A corridor (1) with four equal rooms (2 .. 5) along it.
hyselam_topo::AugmentedTopologicalMap corridorWithRooms() {
  hyselam_topo::AugmentedTopologicalMap map;
  for (hyselam_topo::Id id = 1; id <= 5; ++id) {
    hyselam_topo::Place place;
    place.id = id;
    place.kind = id == 1 ? hyselam_topo::PlaceKind::kCorridor : hyselam_topo::PlaceKind::kRoom;
    place.area = id == 1 ? 40.0 : 20.0;
    place.centre = hyselam::Point3{id == 1 ? 10.0 : 4.0 * id, id == 1 ? 0.0 : 4.0, 0.0};
    map.places.push_back(place);
    if (id == 1) continue;
    hyselam_topo::Edge edge;
    edge.a = 1;
    edge.b = id;
    map.edges.push_back(edge);
  }
  normalize(map);
  return map;
}

hyselam_topo::DescribedBuilding description() {
  hyselam_topo::DescribedBuilding building;
  hyselam_topo::Id id = 1;
  for (const char* name : {"corridor", "kitchen", "office", "library", "workshop"}) {
    hyselam_topo::DescribedPlace place;
    place.id = id++;
    place.name = name;
    building.places.push_back(place);
    if (place.id == 1) continue;
    hyselam_topo::DescribedConnection connection;
    connection.from = 1;
    connection.to = place.id;
    building.connections.push_back(connection);
  }
  return building;
}

/// Seen in the rooms 2 .. 5: the workshop's, the kitchen's, the library's, the office's things.
ObjectMap seenObjects() {
  ObjectMap map;
  const std::vector<std::vector<std::string>> kinds{{"drill", "table"},
                                                    {"fridge", "table", "cup", "oven"},
                                                    {"bookshelf", "table"},
                                                    {"PC", "table", "chair"}};
  for (std::size_t room = 0; room < kinds.size(); ++room) {
    const Id place = map.addPlace("room " + std::to_string(room), static_cast<Id>(room + 2));
    for (const std::string& kind : kinds[room]) {
      const Id id = map.addObject(kind);
      map.find(id)->pose = ObjectPose{{0, 0, 0.5}, {0.5, 0.5, 0.5}, 0.0, {}};
      map.find(id)->existence = 0.95;
      ObjectRelation at;
      at.object = id;
      at.place = place;
      map.relate(at);
    }
  }
  return map;
}

}  // namespace

TEST(PlaceEvidence, ObjectsDistinguishRoomsOfEqualShape) {
  const ObjectParser parser = ObjectParser::shipped("en");
  ObjectMap told;
  FillMap fill(parser, told);
  fill.process(
      "In the kitchen there is a fridge and an oven. In the office there is a PC. In the library "
      "there is a bookshelf. In the workshop there is a drill.");
  const auto map = corridorWithRooms();
  const auto building = description();
  hyselam_topo::SolverParams params;

  const hyselam_topo::PlaceAssignment blind = solveExact(compileMatch(building, map), params);
  EXPECT_GE(blind.equal, 24u) << "the rooms are ambiguous without objects";

  const auto evidence = placeEvidence(told, seenObjects(), building);
  EXPECT_EQ(evidence.size(), 16u);
  const MatchProblem problem = compileMatch(building, map, {}, {}, evidence);
  const hyselam_topo::PlaceAssignment match = solveExact(problem, params);
  ASSERT_TRUE(match.found());
  EXPECT_EQ(match.equal, 1u);
  // vertex (room of the map) -> name
  const std::vector<hyselam_topo::Id> wanted{1, 5, 2, 4, 3};
  for (std::size_t v = 0; v < wanted.size(); ++v) {
    const int name = match.best().assignment[v];
    ASSERT_GE(name, 0);
    EXPECT_EQ(problem.names[static_cast<std::size_t>(name)], wanted[v]) << "vertex " << v;
  }
}

TEST(PlaceEvidence, IsEmptyWithoutAMatchingPlace) {
  const auto building = description();
  EXPECT_TRUE(placeEvidence({}, seenObjects(), building).empty());
  ObjectMap told;
  const ObjectParser parser = ObjectParser::shipped("en");
  FillMap fill(parser, told);
  fill.process("In the attic there is a fridge.");
  EXPECT_TRUE(placeEvidence(told, seenObjects(), building).empty());
  EvidenceParams params;
  params.p_chance = 0.0;
  EXPECT_THROW(placeEvidence(told, seenObjects(), building, params), hyselam::ParameterError);
}
