#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "hyselam_common/errors.hpp"
#include "hyselam_language/grammar/topo_parser.hpp"
#include "hyselam_topo/dialogue/place_man.hpp"
#include "hyselam_topological_map/map_geometry.hpp"
#include "two_rooms.hpp"

using hyselam::InputError;
using hyselam_topo::codeOf;
using hyselam_topo::Id;
using hyselam_topo::NameState;
using hyselam_topo::PlaceMan;
using hyselam_topo::WallKind;

namespace {

using Names = std::vector<std::string>;
using Ids = std::vector<Id>;

PlaceMan twoRooms() {
  PlaceMan man{hyselam_topo::PlaceNames(hyselam_topo::TopoParser().grammars())};
  man.setMap(two_rooms::map());
  return man;
}

NameState stateOf(const PlaceMan& man, Id id) {
  return hyselam_topo::nameStateOf(*man.map().findPlace(id));
}

}  // namespace

TEST(PlaceMan, CodesAreThoseOfFigure79) {
  hyselam_topo::Place place;
  place.id = 4;
  EXPECT_EQ(codeOf(place), "SS04");
  place.kind = hyselam_topo::PlaceKind::kCorridor;
  EXPECT_EQ(codeOf(place), "CC04");
  place.kind = hyselam_topo::PlaceKind::kVirtual;
  place.id = 123;
  EXPECT_EQ(codeOf(place), "VV123");
}

TEST(PlaceMan, NamesAreGuessedConfirmedRejectedForgotten) {
  PlaceMan man = twoRooms();
  EXPECT_EQ(stateOf(man, 1), NameState::kNone);
  man.guess({{1, {"kitchen", "galley"}}, {2, {"room A"}}});
  EXPECT_EQ(stateOf(man, 1), NameState::kUnconfirmed);
  EXPECT_EQ(man.find("the kitchen"), Ids{1});
  EXPECT_EQ(man.find("SS02"), Ids{2});
  EXPECT_TRUE(man.find("room B").empty());

  EXPECT_TRUE(man.confirmGuesses(1));
  EXPECT_FALSE(man.confirmGuesses(1));
  EXPECT_EQ(stateOf(man, 1), NameState::kConfirmed);
  EXPECT_EQ(hyselam_topo::namesOf(*man.map().findPlace(1)), (Names{"kitchen", "galley"}));

  man.reject(2, {"room A"});
  EXPECT_EQ(stateOf(man, 2), NameState::kNone);
  man.guess({{1, {"attic"}}, {2, {"room A", "study"}}});
  EXPECT_EQ(stateOf(man, 1), NameState::kConfirmed) << "guesses leave confirmed names alone";
  EXPECT_EQ(hyselam_topo::namesOf(*man.map().findPlace(2)), Names{"study"});
  man.confirm(2, {"room A"});
  EXPECT_FALSE(man.isRejected(2, "room A")) << "people may change their minds";
  EXPECT_EQ(hyselam_topo::namesOf(*man.map().findPlace(2)), Names{"room A"});

  EXPECT_EQ(man.forgetName("Kitchen"), Ids{1});
  EXPECT_EQ(hyselam_topo::namesOf(*man.map().findPlace(1)), Names{"galley"});
  EXPECT_TRUE(man.forget(1));
  EXPECT_FALSE(man.forget(1));
  man.rename(2, {"room B"});
  EXPECT_EQ(man.find("room B"), Ids{2});
  EXPECT_TRUE(man.find("room A").empty());
  EXPECT_THROW(man.rename(2, {std::string("\xff")}), InputError);
  EXPECT_EQ(man.find("room B"), Ids{2}) << "a name that cannot be used changes nothing";
  EXPECT_THROW(man.confirm(9, {"x"}), InputError);
  EXPECT_THROW(man.confirm(1, {""}), InputError);
}

TEST(PlaceMan, ANameMovesUnlessThePlacesLieSideBySide) {
  PlaceMan man = twoRooms();
  man.confirm(1, {"kitchen"});
  EXPECT_TRUE(man.confirm(2, {"kitchen"}).empty());
  EXPECT_EQ(man.find("kitchen"), (Ids{1, 2}));
  auto apart = two_rooms::map();
  apart.edges.clear();
  PlaceMan other{hyselam_topo::PlaceNames(hyselam_topo::TopoParser().grammars())};
  other.setMap(apart);
  other.confirm(1, {"kitchen"});
  EXPECT_EQ(other.confirm(2, {"kitchen"}), Ids{1});
  EXPECT_EQ(other.find("kitchen"), Ids{2});
}

TEST(PlaceMan, ANameTakesNoneOfAnotherLanguageFromOtherPlaces) {
  PlaceMan man = twoRooms();
  man.confirm(1, {"toilet"});
  EXPECT_EQ(man.find("casa de banho"), Ids{1});
  EXPECT_TRUE(man.confirm(2, {"casa de banho"}).empty());
  EXPECT_EQ(hyselam_topo::namesOf(*man.map().findPlace(1)), Names{"toilet"});
  EXPECT_EQ(man.forgetName("casa de banho"), Ids{2});
  EXPECT_EQ(hyselam_topo::namesOf(*man.map().findPlace(1)), Names{"toilet"});
  EXPECT_EQ(man.forgetName("casa de banho"), Ids{1}) << "the only one of this kind";
}

TEST(PlaceMan, NamesAndWallsSurviveANewSegmentation) {
  PlaceMan man = twoRooms();
  man.confirm(1, {"kitchen"});
  man.reject(2, {"attic"});
  const Id corner = man.addVirtualPlace({7.0, 2.0}, 0.6, {"reading corner"});
  man.addWall({{{4.05, 0.1}, {4.05, 0.9}}, WallKind::kGlass});
  man.addWall({{{1.0, 0.1}, {1.0, 2.9}}, WallKind::kVirtual});
  EXPECT_EQ(hyselam_topo::placeAt(man.map(), {7.0, 2.0})->place, corner);
  EXPECT_EQ(hyselam_topo::placeAt(man.map(), {7.0, 0.5})->place, 2u);
  EXPECT_NO_THROW(hyselam_topo::checkMap(man.map(), "map"));
  const auto before = man.map();

  auto again = two_rooms::map();
  again.stamp = 5.0;
  std::swap(again.places[0].id, again.places[1].id);  // as after a restart of the segmentation
  std::swap(again.places[0], again.places[1]);
  again.grid->places = {2, 1};
  again.edges[0].doors[0].normal.x *= -1.0;
  const auto report = man.setMap(again);
  EXPECT_TRUE(report.created.empty());
  EXPECT_TRUE(report.lost.empty());
  EXPECT_EQ(man.find("kitchen"), Ids{1});
  EXPECT_EQ(man.find("reading corner"), Ids{corner});
  EXPECT_TRUE(man.isRejected(2, "attic"));
  EXPECT_EQ(hyselam_topo::placeAt(man.map(), {7.0, 2.0})->place, corner);
  for (const Id id : {1u, 2u}) {
    EXPECT_EQ(man.map().findPlace(id)->walls.size(), before.findPlace(id)->walls.size()) << id;
  }
  EXPECT_NO_THROW(hyselam_topo::checkMap(man.map(), "map"));

  EXPECT_TRUE(man.removeVirtualPlace(corner));
  EXPECT_FALSE(man.removeVirtualPlace(1));
  EXPECT_EQ(hyselam_topo::placeAt(man.map(), {7.0, 2.0})->place, 2u);
  EXPECT_TRUE(man.removeWall(0));
  EXPECT_FALSE(man.removeWall(1));
  EXPECT_EQ(man.walls().size(), 1u);
}

TEST(PlaceMan, AVirtualWallAcrossADoorShutsItAndLeavesThePlacesAsTheyAre) {
  PlaceMan man = twoRooms();
  const hyselam::OccupancyGrid grid(man.map().grid->geometry, hyselam::OccupancyGrid::kFree);
  const hyselam_topo::DescribedWall shut{{{4.05, 0.95}, {4.05, 2.05}}, WallKind::kVirtual};
  man.addWall(shut);
  EXPECT_EQ(man.shutDoors(), Ids{1});
  EXPECT_EQ(man.withWalls(grid).cells, grid.cells);
  EXPECT_FALSE(man.removeWall({shut.line, WallKind::kGlass}));
  EXPECT_TRUE(man.removeWall(shut));
  EXPECT_FALSE(man.removeWall(shut));
  EXPECT_TRUE(man.shutDoors().empty());
  // Of glass, elsewhere, across the way, or as long as the room: these shut no door.
  for (const hyselam_topo::DescribedWall& other :
       {hyselam_topo::DescribedWall{shut.line, WallKind::kGlass},
        hyselam_topo::DescribedWall{{{3.0, 0.95}, {3.0, 2.05}}, WallKind::kVirtual},
        hyselam_topo::DescribedWall{{{3.5, 1.5}, {4.6, 1.5}}, WallKind::kVirtual},
        hyselam_topo::DescribedWall{{{4.05, 0.0}, {4.05, 3.0}}, WallKind::kVirtual}}) {
    man.addWall(other);
    EXPECT_TRUE(man.shutDoors().empty());
    EXPECT_NE(man.withWalls(grid).cells, grid.cells);
    EXPECT_TRUE(man.removeWall(other));
  }
}

TEST(PlaceMan, WallsAreDrawnIntoACopy) {
  PlaceMan man = twoRooms();
  man.addWall({{{1.0, 0.1}, {1.0, 2.9}}, WallKind::kVirtual});
  const hyselam::OccupancyGrid grid(man.map().grid->geometry, hyselam::OccupancyGrid::kFree);
  const auto copy = man.withWalls(grid);
  EXPECT_EQ(copy.at(grid.geometry.cellAt({1.0, 1.5})), hyselam::OccupancyGrid::kOccupied);
  EXPECT_EQ(grid.at(grid.geometry.cellAt({1.0, 1.5})), hyselam::OccupancyGrid::kFree);
}

TEST(PlaceMan, RefusesInvalidInput) {
  PlaceMan man = twoRooms();
  EXPECT_THROW(man.addVirtualPlace({50.0, 0.0}, 1.0, {}), InputError);
  EXPECT_THROW(man.addVirtualPlace({1.0, 1.0}, 0.0, {}), InputError);
  EXPECT_THROW(man.addVirtualPlace({1.0, 1.0}, std::nan(""), {}), InputError);
  const std::size_t places = man.map().places.size();
  EXPECT_THROW(man.addVirtualPlace({1.0, 1.0}, 0.5, {"\xff"}), InputError);
  EXPECT_EQ(man.map().places.size(), places);
  const double infinite = std::numeric_limits<double>::infinity();
  EXPECT_THROW(man.addWall({{{0.0, 0.0}, {infinite, 0.0}}, WallKind::kGlass}), InputError);
  EXPECT_THROW(man.addWall({{{1.0, 0.0}, {1.0, 0.0}}, WallKind::kGlass}), InputError);
  EXPECT_THROW(man.addWall({{{1.0, 0.0}, {2.0, 0.0}}, WallKind::kSolid}), InputError);
  PlaceMan::State state = man.state();
  state.map.places[0].id = 2;
  EXPECT_THROW(man.restore(state), InputError);
}
