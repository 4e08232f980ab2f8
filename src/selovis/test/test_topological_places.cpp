// The places of the topological map: transitions, expected places, names, pose priors.
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <tuple>

#include "four_rooms.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/testing/files.hpp"
#include "hyselam_topological_map/topological_map_xml.hpp"
#include "selovis/places/topological_places.hpp"

namespace selovis {
namespace {

using hyselam::testing::messageOf;
using hyselam::testing::TemporaryDirectory;
using hyselam::testing::writeFile;
using testing::fourRooms;

TEST(TopologicalPlaces, PlacesOfOneNameAreOneVertex) {
  const PlaceTransitions g = transitionsOf(fourRooms());
  EXPECT_EQ(g.places, (std::vector<std::string>{"store", "kitchen", "room 3"}));
  EXPECT_TRUE(g.connected(0, 1));
  EXPECT_TRUE(g.connected(1, 2));
  EXPECT_TRUE(g.connected(2, 0));
}

TEST(TopologicalPlaces, TransitionsAreReadFromXmlJsonAndCsv) {
  TemporaryDirectory folder;
  hyselam_topo::saveXml(folder / "topo.xml", fourRooms());
  EXPECT_EQ(readTopology(folder / "topo.xml").places, transitionsOf(fourRooms()).places);
  EXPECT_EQ(readTopology(folder / "topo.xml").pairs, transitionsOf(fourRooms()).pairs);
  writeFile(folder / "g.csv", "store,kitchen\n");
  EXPECT_EQ(readTopology(folder / "g.csv").places.size(), 2u);
  writeFile(folder / "bad.xml", "<topological_map><place></topological_map>");
  EXPECT_NE(
      messageOf<hyselam::InputError>([&] { readTopology(folder / "bad.xml"); }).find("bad.xml"),
      std::string::npos);
}

TEST(TopologicalPlaces, PlacesNearAPointBeginWithItsOwn) {
  const auto map = fourRooms();
  EXPECT_EQ(placesNear(map, {2.0, 0.0}, 0.5), std::vector<std::string>{"store"});
  EXPECT_EQ(placesNear(map, {3.3, 0.0}, 0.5), (std::vector<std::string>{"kitchen", "store"}));
  EXPECT_EQ(placesNear(map, {6.9, 0.0}, 0.3), (std::vector<std::string>{"room 3", "store"}));
  EXPECT_TRUE(placesNear(map, {100.0, 0.0}, 0.5).empty());
  EXPECT_TRUE(placesNear(map, {std::nan(""), 0.0}, 0.5).empty());
  EXPECT_TRUE(placesNear({}, {0.0, 0.0}, 0.5).empty());
}

/// fourRooms() with virtual places: in the kitchen "desk", on it "drawer", beside it
/// "sink"; in the first store "sofa"; in room 3 "corner". Two columns of cells belong to each.
hyselam_topo::AugmentedTopologicalMap furnished() {
  auto map = fourRooms();
  for (const auto& [id, around, name, x] :
       {std::tuple(5, 2, "desk", 12), std::tuple(6, 5, "drawer", 14), std::tuple(7, 2, "sink", 16),
        std::tuple(8, 1, "sofa", 5), std::tuple(9, 3, "corner", 25)}) {
    hyselam_topo::Place place;
    place.id = static_cast<hyselam_topo::Id>(id);
    place.kind = hyselam_topo::PlaceKind::kVirtual;
    place.words.push_back({name, true});
    map.places.push_back(place);
    map.grid->places.push_back(place.id);
    for (int y = 0; y < 10; ++y) {
      map.grid->labels[static_cast<std::size_t>(40 * y + x)] = static_cast<std::uint16_t>(id);
      map.grid->labels[static_cast<std::size_t>(40 * y + x + 1)] = static_cast<std::uint16_t>(id);
    }
    hyselam_topo::Edge edge;
    edge.a = static_cast<hyselam_topo::Id>(around);
    edge.b = place.id;
    map.edges.push_back(edge);
  }
  return map;
}

TEST(TopologicalPlaces, RoomAndItsVirtualPlacesAreExpectedAtAPose) {
  using Names = std::set<std::string>;
  const auto map = furnished();
  PlaceTransitions learned;
  learned.places = {"store", "kitchen", "desk", "drawer", "sink", "sofa", "attic"};
  const auto named = [&](const std::vector<int>& places) {
    Names names;
    for (const int i : places) names.insert(learned.places[static_cast<std::size_t>(i)]);
    return names;
  };
  const auto at = [&](double x, double radius = 0.05) {
    const ExpectedPlaces e = expectedPlaces(map, learned, {x, 0.0}, radius);
    EXPECT_EQ(named(e.unmapped), e.agreeing.empty() ? Names() : Names{"attic"});
    return std::pair(e.own, named(e.agreeing));
  };
  const Names kitchen{"kitchen", "desk", "drawer", "sink"};
  EXPECT_EQ(at(4.7), std::pair(std::string("kitchen"), kitchen));
  EXPECT_EQ(at(3.7), std::pair(std::string("desk"), kitchen));
  EXPECT_EQ(at(4.1), std::pair(std::string("drawer"), kitchen)) << "inside the desk";
  EXPECT_EQ(at(1.5), std::pair(std::string("store"), Names({"store", "sofa"})));
  EXPECT_EQ(at(8.5), std::pair(std::string("store"), Names({"store"}))) << "the other one";
  // Within the radius virtual places agree as well as rooms.
  Names both = kitchen;
  both.insert({"store", "sofa"});
  EXPECT_EQ(at(3.1, 0.5).second, both);
  // Never learned, or off the map: nothing is expected.
  EXPECT_EQ(at(6.5), std::pair(std::string("room 3"), Names()));
  EXPECT_EQ(at(6.1), std::pair(std::string("corner"), Names()));
  EXPECT_EQ(at(50.0), std::pair(std::string(), Names()));
  // A virtual place that was added after learning, in a room that was learned.
  learned.places = {"store", "kitchen", "attic"};
  EXPECT_EQ(at(4.1), std::pair(std::string("drawer"), Names({"kitchen"})));
}

TEST(TopologicalPlaces, RenamedPlacesAreFoundBetweenTwoMaps) {
  const auto before = fourRooms();
  const auto renamings = [&](hyselam_topo::AugmentedTopologicalMap after) {
    std::vector<std::pair<std::string, std::string>> found;
    for (const auto& r : renamedPlaces(before, after)) found.emplace_back(r.from, r.to);
    return found;
  };
  using Found = std::vector<std::pair<std::string, std::string>>;
  EXPECT_EQ(renamings(before), Found());
  auto after = before;
  after.places[2].words.push_back({"library", false});
  after.places[2].centre->x += 0.3;
  EXPECT_EQ(renamings(after), (Found{{"room 3", "library"}}));
  after.places[3].words = {{"lab", true}};  // the first one is a store still
  EXPECT_EQ(renamings(after), (Found{{"room 3", "library"}}));
  // The same number in another building.
  after.places[2].centre->x += 0.3;
  EXPECT_EQ(renamings(after), Found());
  after.places[2].centre.reset();
  EXPECT_EQ(renamings(after), Found());
  after.places.resize(2);
  EXPECT_EQ(renamings(after), Found());

  PlaceTransitions learned;
  learned.places = {"store", "room 3", "room 4", "lab"};
  EXPECT_EQ(renamePlaces({{"room 3", "library"}, {"room 4", "lab"}, {"attic", "roof"}}, learned),
            1u);
  EXPECT_EQ(learned.places, (std::vector<std::string>{"store", "library", "room 4", "lab"}));
}

TEST(TopologicalPlaces, PosePriorIsTheDistributionOfThePlacesCells) {
  const auto prior = posePriorOf(fourRooms(), "kitchen");
  ASSERT_TRUE(prior);
  EXPECT_NEAR(prior->mean.x, 4.0, 1e-9);
  EXPECT_NEAR(prior->mean.y, 0.0, 1e-9);
  EXPECT_NEAR(prior->stddev.x, 2.0 / std::sqrt(12.0), 0.01);
  EXPECT_NEAR(posePriorOf(fourRooms(), "store")->mean.x, 5.0, 1e-9) << "both of that name";
  EXPECT_FALSE(posePriorOf(fourRooms(), "cellar"));
}

}  // namespace
}  // namespace selovis
