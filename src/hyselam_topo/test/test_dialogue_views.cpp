// Sides are told from where the robot stands then: also after it was driven elsewhere, turned
// round, or where nobody has named the place.
#include <gtest/gtest.h>

#include <algorithm>

#include "hyselam_gr2to/gr2to.hpp"
#include "hyselam_language/building/description_xml.hpp"
#include "hyselam_sim/floor_plan.hpp"
#include "hyselam_sim/rasterize.hpp"
#include "hyselam_topo/dialogue/dialogue.hpp"
#include "hyselam_topo/dialogue/dialogue_state.hpp"
#include "hyselam_topological_map/map_geometry.hpp"
#include "talk.hpp"

using hyselam_topo::AskPolicy;
using hyselam_topo::Dialogue;
using hyselam_topo::DialogueParams;
using hyselam_topo::Id;
using hyselam_topo::Reply;

namespace {

/// A corridor along x from 0 to 20 m with three rooms a side, and doors at 3, 10 and 17 m.
hyselam_sim::FloorPlan corridor() {
  return hyselam_sim::parseFloorPlan(R"(
plan: corridor
origin: [-2.0, -8.0]
size: [24.0, 19.0]
wall_thickness: 0.2
walls:
  - {name: outer, closed: true, points: [[0, -6], [20, -6], [20, 8.4], [0, 8.4]]}
  - {name: north, points: [[0, 2.4], [20, 2.4]]}
  - {name: south, points: [[0, 0], [20, 0]]}
  - {name: n1, points: [[6, 2.4], [6, 8.4]]}
  - {name: n2, points: [[14, 2.4], [14, 8.4]]}
  - {name: s1, points: [[6, 0], [6, -6]]}
  - {name: s2, points: [[14, 0], [14, -6]]}
doors:
  - {name: north 1, at: [3, 2.4], width: 0.9}
  - {name: north 2, at: [10, 2.4], width: 0.9}
  - {name: north 3, at: [17, 2.4], width: 0.9}
  - {name: south 1, at: [3, 0], width: 0.9}
  - {name: south 2, at: [10, 0], width: 0.9}
  - {name: south 3, at: [17, 0], width: 0.9}
places:
  - {name: corridor, at: [1, 1.2], polygon: [[0.1, 0.1], [19.9, 0.1], [19.9, 2.3], [0.1, 2.3]]}
)",
                                     "corridor");
}

struct Tour {
  Dialogue dialogue;
  double time = 0.0;

  Tour() : dialogue(quiet(), sharedParser(), sharedPhrases()) {
    dialogue.setMap(hyselam_topo::gr2to(hyselam_sim::rasterize(corridor(), 0.05, 0.0)).map);
  }
  static DialogueParams quiet() {
    DialogueParams params;
    params.ask = AskPolicy::kNever;
    return params;
  }
  /// Long enough for the robot to be sure of its place.
  void at(double x, double y, double theta) {
    for (int i = 0; i < 4; ++i) dialogue.setPose(time += 1.0, {x, y, theta});
  }
  std::string say(const std::string& text) { return dialogue.hear(text).text(); }
  /// The names of the room behind the door at x on the north or south side.
  std::string room(double x, bool north) const {
    const auto found = hyselam_topo::placeAt(dialogue.map(), {x, north ? 5.0 : -3.0}, 0.3);
    if (!found) return "nowhere";
    std::string all;
    for (const auto& name : namesOf(*dialogue.map().findPlace(found->place))) all += name;
    return all;
  }
};

}  // namespace

TEST(DialogueViews, SidesAreThoseOfTheWayTheRobotLooksThen) {
  Tour t;
  t.at(1.0, 1.2, 0.0);
  t.say("You are in the corridor. The first door on the left is the kitchen.");
  EXPECT_EQ("kitchen", t.room(3, true));
  t.at(19.0, 1.2, hyselam::kPi);
  t.say("The first door on the right is the library.");
  EXPECT_EQ("library", t.room(17, true));
  EXPECT_EQ("kitchen", t.room(3, true)) << "what was told before keeps its view";
  t.say("The first door on the left is the archive.");
  EXPECT_EQ("archive", t.room(17, false));
  EXPECT_EQ("library", t.room(17, true));
}

TEST(DialogueViews, OfThePlaceWhereItWasPut) {
  Tour t;
  t.at(1.0, 1.2, 0.0);
  t.say("You are in the corridor.");
  t.at(3.0, 5.0, 1.57);
  t.say("This is the kitchen.");
  t.at(1.0, 1.2, 0.0);
  const std::string noted = t.say("The second door on the left is the library.");
  EXPECT_NE(std::string::npos, noted.find("on the left of the corridor")) << noted;
  EXPECT_EQ("library", t.room(10, true));
  EXPECT_EQ("kitchen", t.room(3, true));
}

TEST(DialogueViews, WhereItIsLedInThoughtItStays) {
  Tour t;
  t.at(1.0, 1.2, 0.0);
  t.say(
      "You are in the corridor. The first door on the left is the kitchen. You are in the "
      "kitchen.");
  const std::string noted = t.say("In front of you is the pantry.");
  EXPECT_NE(std::string::npos, noted.find("kitchen")) << noted;
}

TEST(DialogueViews, OfAPlaceThatNobodyHasNamed) {
  Tour t;
  t.at(1.0, 1.2, 0.0);
  const Id here = t.dialogue.robot().place;
  ASSERT_NE(0u, here);
  const std::string code = codeOf(*t.dialogue.map().findPlace(here));
  const std::string noted = t.say("The first door on the left is the kitchen.");
  EXPECT_NE(std::string::npos, noted.find(code)) << noted;
  EXPECT_NE(std::string::npos, noted.find("1 of 1")) << noted << ": the code is no name to find";
  EXPECT_EQ("kitchen", t.room(3, true));
  const auto names = t.dialogue.knownNames();
  EXPECT_EQ(0, std::count(names.begin(), names.end(), code));
  // Once it is named, all that was told of it is of that name.
  t.say("This is the corridor.");
  EXPECT_EQ(2u, t.dialogue.description().places.size());
  EXPECT_EQ("kitchen", t.room(3, true));
  t.say("The second door on the left is the library.");
  EXPECT_EQ("library", t.room(10, true));
}

TEST(DialogueViews, WhatIsNotTakenDownTellsOfNoPlace) {
  Tour t;
  t.at(1.0, 1.2, 0.0);
  const std::string asked = t.say("The first door on the left is my office.");
  EXPECT_EQ(std::string::npos, asked.find("0 of 0")) << asked;
}

TEST(DialogueViews, ANameThatWasToldOfTakesItIn) {
  Tour t;
  t.at(1.0, 1.2, 0.0);
  t.say("The kitchen is next to the north corridor.");
  t.say("The first door on the left is the kitchen.");
  ASSERT_EQ(3u, t.dialogue.description().places.size());
  t.say("This is the north corridor.");
  ASSERT_EQ(2u, t.dialogue.description().places.size());
  ASSERT_EQ(1u, t.dialogue.description().connections.size());
  EXPECT_EQ(1, *t.dialogue.description().connections.front().rank);
  EXPECT_EQ("kitchen", t.room(3, true));
}

TEST(DialogueViews, TheCorridorIsTheOneThatTheRobotStandsInAlsoWithoutAName) {
  Tour t;
  t.at(1.0, 1.2, 0.0);
  t.say("The lab is on the left. At the end of the corridor there is the archive.");
  // The corridor, the lab and the archive.
  EXPECT_EQ(3u, t.dialogue.description().places.size());
  EXPECT_EQ(std::string::npos, t.say("Where is the archive?").find("corridor may be"));
  t.say("You are in the corridor.");
  ASSERT_EQ(3u, t.dialogue.description().places.size());
  const auto& places = t.dialogue.description().places;
  EXPECT_TRUE(std::any_of(places.begin(), places.end(),
                          [](const auto& place) { return place.name == "corridor"; }));
}

TEST(DialogueViews, InARoomTheCorridorIsAnotherPlace) {
  Tour t;
  t.at(3.0, 5.0, 1.57);
  t.say("The lab is at the end of the corridor.");
  EXPECT_EQ(2u, t.dialogue.description().places.size());
}

TEST(DialogueViews, ARenamedPlaceTakesWhatWasToldOfItAlong) {
  Tour t;
  t.at(1.0, 1.2, 0.0);
  t.say("This is the lobby. The first door on the left is the kitchen.");
  t.say("Rename this place to north corridor.");
  const auto& places = t.dialogue.description().places;
  ASSERT_EQ(2u, places.size());
  EXPECT_TRUE(std::none_of(places.begin(), places.end(),
                           [](const auto& place) { return place.name == "lobby"; }));
}

TEST(DialogueViews, APlaceThatIsDeniedIsNotNamedSo) {
  Tour t;
  t.at(3.0, 5.0, 1.57);
  t.say("Esta é a cozinha.");
  ASSERT_EQ("cozinha", t.room(3, true));
  const std::string reply = t.say("Isto aqui não é a cozinha.");
  EXPECT_EQ("", t.room(3, true)) << reply;
  EXPECT_EQ(std::string::npos, reply.find("?")) << reply;
}

TEST(DialogueViews, AreKeptInFiles) {
  Tour t;
  t.at(1.0, 1.2, 0.0);
  t.say("You are in the corridor. The first door on the left is the kitchen.");
  const auto& told = t.dialogue.description();
  ASSERT_TRUE(told.connections.front().seen_from);
  EXPECT_EQ(told, hyselam_topo::descriptionFromXml(toXml(told, "told"), "told"));
  const auto state = hyselam_topo::dialogueStateFromText(toText(t.dialogue.state()), "state");
  EXPECT_EQ(t.dialogue.robot().place, state.told_at);
  EXPECT_EQ(told, state.description);
}

TEST(DialogueViews, SeenFromElsewhereAnotherSideIsNoContradiction) {
  Tour t;
  t.at(1.0, 1.2, 0.0);
  t.say("You are in the corridor. The kitchen is on your left.");
  EXPECT_NE(std::string::npos, t.say("The kitchen is on your right.").find("left"));
  t.at(19.0, 1.2, hyselam::kPi);
  const std::string noted = t.say("The last door on the right is the kitchen.");
  EXPECT_NE(std::string::npos, noted.find("Noted")) << noted;
  EXPECT_EQ("kitchen", t.room(3, true));
}

TEST(DialogueGo, AgreementInManyWordsSendsItOnItsWayConditionsDoNot) {
  for (const char* yes : {"Yes, off you trot then", "Sim, vai lá então", "Deve sim, vai indo"}) {
    Tour t;
    t.at(1.0, 1.2, 0.0);
    t.say("You are in the corridor. The kitchen is on the left.");
    ASSERT_NE(std::string::npos, t.say("Go to the kitchen.").find("?"));
    const Reply reply = t.dialogue.hear(yes);
    EXPECT_TRUE(reply.has(hyselam_topo::DialogueAction::Kind::kGo)) << yes << ": " << reply.text();
  }
  for (const char* half : {"Sure, if the door is open", "Yes, when I say go", "Yes, in ten minutes",
                           "Sim, mas só amanhã", "Sim, mas agora não pode ser", "no yes, sqwox"}) {
    Tour t;
    t.at(1.0, 1.2, 0.0);
    t.say("You are in the corridor. The kitchen is on the left.");
    t.say("Go to the kitchen.");
    const Reply reply = t.dialogue.hear(half);
    EXPECT_FALSE(reply.has(hyselam_topo::DialogueAction::Kind::kGo)) << half << reply.text();
  }
}

TEST(DialogueViews, ASideToldBeforeIsNoneOfAnotherView) {
  Tour t;
  t.at(1.0, 1.2, 0.0);
  t.say("You are in the corridor. The first door on the left is the kitchen.");
  t.at(19.0, 1.2, hyselam::kPi);
  t.say("The kitchen is the last door.");
  EXPECT_EQ("kitchen", t.room(3, true)) << "which side the last door is on was not told";
}

TEST(DialogueViews, WhatWasToldOfTheUnnamedPlaceGoesToItsName) {
  Tour t;
  t.at(1.0, 1.2, 0.0);
  t.say("The kitchen leads into the corridor.");
  t.say("The first door on the left is the kitchen.");
  t.say("This is the corridor.");
  ASSERT_EQ(1u, t.dialogue.description().connections.size());
  EXPECT_EQ(hyselam_topo::Side::kLeft, t.dialogue.description().connections.front().side);
  EXPECT_EQ("kitchen", t.room(3, true));
}

TEST(DialogueViews, DenialsAreOfTheirView) {
  Tour t;
  t.at(1.0, 1.2, 0.0);
  t.say("You are in the corridor. The kitchen is on your left.");
  t.at(19.0, 1.2, hyselam::kPi);
  t.say("The kitchen is not on your left.");
  ASSERT_EQ(1u, t.dialogue.description().connections.size());
  EXPECT_EQ(hyselam_topo::Side::kLeft, t.dialogue.description().connections.front().side);
}
