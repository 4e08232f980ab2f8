// Names by people outlive maps that do not show their places, and go to no place of another map.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "hyselam_gr2to/gr2to.hpp"
#include "hyselam_sim/data.hpp"
#include "hyselam_sim/generate_plan.hpp"
#include "hyselam_sim/rasterize.hpp"
#include "hyselam_topo/dialogue/dialogue_state.hpp"
#include "hyselam_topo/dialogue/place_shelf.hpp"
#include "hyselam_topological_map/map_geometry.hpp"
#include "talk.hpp"

namespace hyselam_topo {
namespace {

using Map = AugmentedTopologicalMap;

Map mapOf(const hyselam_sim::FloorPlan& plan, double dx = 0.0, double dy = 0.0) {
  hyselam::OccupancyGrid grid = hyselam_sim::rasterize(plan, 0.05, 0.0);
  grid.geometry.origin.x += dx;
  grid.geometry.origin.y += dy;
  return gr2to(grid).map;
}

const hyselam_sim::FloorPlan& officePlan() {
  static const auto kPlan = hyselam_sim::loadFloorPlan(hyselam_sim::planFile("office"));
  return kPlan;
}

const Map& office() {
  static const Map kMap = mapOf(officePlan());
  return kMap;
}

/// What a robot has seen before it knows where it is.
Map ownMap(double x, double y) {
  Map map = two_rooms::map();
  map.grid->geometry.origin = {x, y, 0.0};
  return map;
}

/// No place of the office is there.
Map elsewhere() {
  return ownMap(500.0, 500.0);
}

const std::vector<Map>& generated() {
  static const auto kMaps = [] {
    std::vector<Map> maps;
    for (std::uint64_t seed = 1; seed <= 16; ++seed) {
      maps.push_back(mapOf(hyselam_sim::generatePlan(seed)));
    }
    return maps;
  }();
  return kMaps;
}

PlaceMan emptyMan() {
  return PlaceMan{PlaceNames(sharedParser().grammars())};
}

std::vector<Id> idsOf(const Map& map) {
  std::vector<Id> ids;
  for (const Place& place : map.places) ids.push_back(place.id);
  return ids;
}

/// With a name for each of its places, and none that takes that of another.
PlaceMan named(const Map& map) {
  PlaceMan man = emptyMan();
  man.setMap(map);
  for (const Id id : idsOf(man.map())) man.confirm(id, {"room Q-" + std::to_string(100 + id)});
  return man;
}

ShelvedMap shelvedOf(const Map& map) {
  const PlaceMan man = named(map);
  return shelvedFrom(man.map(), idsOf(man.map()));
}

/// Name -> where its place is.
std::map<std::string, hyselam::Point2> whereNamesAre(const PlaceMan& man) {
  std::map<std::string, hyselam::Point2> at;
  for (const Place& place : man.map().places) {
    for (const std::string& name : confirmedOf(place.words)) {
      at[name] = {place.centre->x, place.centre->y};
    }
  }
  return at;
}

void expectSameNames(const PlaceMan& man, const PlaceMan& before) {
  const auto now = whereNamesAre(man), then = whereNamesAre(before);
  EXPECT_EQ(now.size(), then.size());
  for (const auto& [name, at] : then) {
    ASSERT_EQ(now.count(name), 1u) << name;
    EXPECT_LT(std::hypot(now.at(name).x - at.x, now.at(name).y - at.y), 0.01) << name;
  }
}

TEST(PlaceShelf, NamesComeBackWithTheirMap) {
  const PlaceMan before = named(office());
  const std::size_t all = before.map().places.size();
  ASSERT_GE(all, 15u);
  // Far from all of it, or over some of its rooms by accident.
  for (const Map& own : {elsewhere(), ownMap(2.0, 3.0), ownMap(15.0, 7.0)}) {
    PlaceMan man = before;
    const auto lost = man.setMap(own);
    EXPECT_EQ(lost.shelved, all);
    EXPECT_TRUE(whereNamesAre(man).empty());
    EXPECT_TRUE(man.isShelved("the room Q-101"));
    EXPECT_FALSE(man.isShelved("the kitchen"));
    EXPECT_EQ(man.setMap(own).shelved, 0u) << "told once";
    const auto found = man.setMap(office());
    EXPECT_EQ(found.seen_again.size(), all);
    EXPECT_TRUE(man.state().shelf.empty());
    expectSameNames(man, before);
  }
}

TEST(PlaceShelf, ComeBackAfterSeveralMapsAndWithoutAFrameInCommon) {
  const PlaceMan before = named(office());
  PlaceMan man = before;
  Map other = elsewhere();
  other.frame_id = "other";
  man.setMap(other);
  man.setMap(elsewhere());
  man.setMap(ownMap(2.0, 3.0));
  man.setMap(office());
  expectSameNames(man, before);
}

TEST(PlaceShelf, AnotherBuildingGetsNone) {
  std::size_t tried = 0;
  for (std::size_t i = 0; i < generated().size(); ++i) {
    const ShelvedMap shelved = shelvedOf(generated()[i]);
    for (std::size_t k = 0; k < generated().size(); ++k) {
      const auto found = foundAgain(shelved, generated()[k]);
      if (i == k) {
        EXPECT_EQ(found.size(), generated()[i].places.size()) << i;
      } else {
        EXPECT_TRUE(found.empty())
            << found.size() << " of " << shelved.places.size() << ", " << i << " in " << k;
        ++tried;
      }
    }
    EXPECT_TRUE(foundAgain(shelved, office()).empty()) << i;
  }
  EXPECT_GE(tried, 200u);
}

TEST(PlaceShelf, TheSameMapElsewhereGetsNone) {
  const ShelvedMap shelved = shelvedOf(office());
  for (const auto& [x, y] : std::vector<std::pair<double, double>>{
           {2.0, 0.0}, {3.0, 0.0}, {-4.0, 0.0}, {5.0, 1.0}, {0.0, 3.0}, {-3.0, -3.0}, {8.0, 0.0}}) {
    EXPECT_TRUE(foundAgain(shelved, mapOf(officePlan(), x, y)).empty()) << x << " " << y;
  }
  PlaceMan man = named(office());
  man.setMap(elsewhere());
  EXPECT_TRUE(man.setMap(mapOf(officePlan(), 3.0, 0.0)).seen_again.empty());
  EXPECT_EQ(wordedPlaces(man.state().shelf), office().places.size());
  EXPECT_EQ(foundAgain(shelved, mapOf(officePlan(), 0.3, -0.2)).size(), office().places.size())
      << "a map may move a little";
}

TEST(PlaceShelf, WhatWasToldSinceWins) {
  PlaceMan man = named(office());
  const auto where = whereNamesAre(man);
  man.setMap(elsewhere());
  // As when SLAM ties late: the building is there, but not yet where it was.
  Map away = office();
  PlaceMan::State state = man.state();
  const Shelf shelf = state.shelf;
  man.restore([&] {
    PlaceMan fresh = emptyMan();
    fresh.setMap(away);
    PlaceMan::State with = fresh.state();
    with.shelf = shelf;
    return with;
  }());
  const auto at = [&](const std::string& name) {
    return placeAt(man.map(), where.at(name), 0.5)->place;
  };
  const Id renamed = at("room Q-101"), moved_to = at("room Q-102");
  man.confirm(renamed, {"atelier"});
  man.confirm(moved_to, {"room Q-103"});
  man.setMap(office());
  EXPECT_EQ(namesOf(*man.map().findPlace(renamed)), std::vector<std::string>{"atelier"});
  EXPECT_EQ(man.find("room Q-103"), std::vector<Id>{moved_to});
  EXPECT_EQ(man.find("room Q-104").size(), 1u);
  EXPECT_TRUE(man.state().shelf.empty());
}

TEST(PlaceShelf, IsForgottenWhenPeopleSaySo) {
  PlaceMan man = named(office());
  man.setMap(elsewhere());
  EXPECT_TRUE(man.forgetShelved("the room Q-101"));
  EXPECT_FALSE(man.forgetShelved("the room Q-101"));
  EXPECT_FALSE(man.isShelved("room Q-101"));
  man.forgetAllNames();
  EXPECT_TRUE(man.state().shelf.empty());
}

TEST(PlaceShelf, KeepsTheNewest) {
  Shelf shelf;
  const ShelvedMap one = shelvedOf(office());
  for (int i = 0; i < 100; ++i) shelve(one, &shelf);
  EXPECT_EQ(wordedPlaces(shelf), 500u);
  EXPECT_EQ(wordedPlaces({shelf.back()}), one.places.size());
}

TEST(PlaceShelf, OutlivesTheProgram) {
  DialogueState state;
  state.language = "en";
  state.places = named(office()).state();
  EXPECT_EQ(toText(state).rfind("hyselam_dialogue 1 ", 0), 0u);
  PlaceMan man = named(office());
  man.setMap(elsewhere());
  state.places = man.state();
  const std::string text = toText(state);
  EXPECT_EQ(text.rfind("hyselam_dialogue 2 ", 0), 0u);
  const DialogueState again = dialogueStateFromText(text, "test");
  EXPECT_EQ(toText(again), text);
  man.restore(again.places);
  man.setMap(office());
  expectSameNames(man, named(office()));
}

TEST(PlaceShelf, TheDialogueSaysSo) {
  Talk talk;
  talk.say("This is John's office.");
  talk.at(6.0);
  talk.say("This is the kitchen.");
  EXPECT_EQ(talk.dialogue.setMap(ownMap(30.0, 30.0)).text(),
            "I have lost sight of 2 places; I keep their names.");
  EXPECT_EQ(talk.dialogue.setMap(ownMap(30.0, 30.0)).text(), "");
  EXPECT_EQ(talk.say("Where is John's office?"),
            "I know John's office, but it is not on this map now.");
  EXPECT_EQ(talk.say("Go to the kitchen."), "I know the kitchen, but it is not on this map now.");
  EXPECT_EQ(talk.dialogue.setMap(two_rooms::map()).text(), "I see 2 places again.");
  EXPECT_EQ(talk.say("Where is John's office?").rfind("John's office is SS", 0), 0u);
  talk.dialogue.useLanguage("pt");
  EXPECT_EQ(talk.dialogue.setMap(ownMap(30.0, 30.0)).text(),
            "Perdi de vista 2 lugares; guardo os seus nomes.");
  EXPECT_EQ(talk.dialogue.setMap(two_rooms::map()).text(), "Volto a ver 2 lugares.");
}

TEST(PlaceShelf, ANameOnItIsForgottenByName) {
  Talk talk;
  talk.say("This is John's office.");
  talk.dialogue.setMap(ownMap(30.0, 30.0));
  talk.say("Forget John's office.");
  EXPECT_EQ(talk.dialogue.setMap(two_rooms::map()).text(), "");
  EXPECT_EQ(talk.say("Where is John's office?"), "I do not know the place John's office.");
}

}  // namespace
}  // namespace hyselam_topo
