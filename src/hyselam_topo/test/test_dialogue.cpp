// The talk of section 7.3.1 and others, in a simulated building.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <map>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/testing/files.hpp"
#include "hyselam_gr2to/gr2to.hpp"
#include "hyselam_sim/floor_plan.hpp"
#include "hyselam_sim/rasterize.hpp"
#include "hyselam_topo/dialogue/dialogue.hpp"
#include "hyselam_topo/dialogue/dialogue_state.hpp"
#include "hyselam_topological_map/map_geometry.hpp"
#include "talk.hpp"

using hyselam::InputError;
using hyselam::Point2;
using hyselam::Pose2;
using hyselam_topo::AskPolicy;
using hyselam_topo::Dialogue;
using hyselam_topo::DialogueAction;
using hyselam_topo::DialogueParams;
using hyselam_topo::Id;
using hyselam_topo::Question;
using hyselam_topo::Reply;

namespace {

bool has(const Reply& reply, const std::string& text) {
  return reply.text().find(text) != std::string::npos;
}

const hyselam_sim::FloorPlan& plan() {
  static const auto kPlan = hyselam_sim::loadFloorPlan(std::string(HYSELAM_PACKAGE_DIR) +
                                                       "/test/data/glass_building.yaml");
  return kPlan;
}

const hyselam::OccupancyGrid& grid() {
  static const auto kGrid = hyselam_sim::rasterize(plan(), 0.05, 0.0);
  return kGrid;
}

/// A robot in the building with a person beside it.
struct Visit {
  Dialogue dialogue;
  double time = 0.0;
  bool aloud = std::getenv("HYSELAM_ALOUD") != nullptr;

  explicit Visit(const DialogueParams& params = {})
      : dialogue(params, sharedParser(), sharedPhrases()) {
    dialogue.setGrid(grid());
  }
  Reply at(double x, double y, double theta) {
    return tell(dialogue.setPose(time += 1.0, {x, y, theta}));
  }
  Reply say(const std::string& text) {
    if (aloud) std::cout << "Human " << text << '\n';
    return tell(dialogue.hear(text));
  }
  /// The topological map from the grid map with the walls told so far.
  Reply segment() {
    return tell(dialogue.setMap(hyselam_topo::gr2to(*dialogue.gridWithWalls()).map));
  }
  Reply tell(Reply reply) const {
    if (aloud && !reply.sentences.empty()) std::cout << "Robot " << reply.text() << '\n';
    return reply;
  }
  /// The place at a place of the plan.
  Id truth(const std::string& name) const {
    const auto found = hyselam_topo::placeAt(dialogue.map(), plan().place(name).at, 0.3);
    return found ? found->place : 0;
  }
  std::vector<std::string> names(Id id) const {
    return hyselam_topo::namesOf(*dialogue.map().findPlace(id));
  }
};

/// What the walls of glass are in truth: the ends of the openings.
std::pair<Point2, Point2> glassOf(const std::string& name) {
  for (const auto& door : plan().doors) {
    if (door.name != name) continue;
    const double half = 0.5 * door.width;
    return {{door.at.x - half, door.at.y}, {door.at.x + half, door.at.y}};
  }
  throw InputError("plan", name, "there is none");
}

void expectAt(const hyselam_topo::WallLine& wall, const std::string& name) {
  const auto [a, b] = glassOf(name);
  const bool turned = wall.a.x > wall.b.x;
  const Point2 wa = turned ? wall.b : wall.a, wb = turned ? wall.a : wall.b;
  EXPECT_LT(std::hypot(wa.x - a.x, wa.y - a.y), 0.2) << name;
  EXPECT_LT(std::hypot(wb.x - b.x, wb.y - b.y), 0.2) << name;
}

void tellOfGlass(Visit* v) {
  v->at(5.6, 1.2, 0.0);
  EXPECT_TRUE(has(v->say("Stop. Robot, on your right there is a glass wall."),
                  "Is this information correct?"));
  v->say("Yes.");
  v->at(8.6, 1.2, 0.0);
  v->say("Robot, at your right there is a glass wall.");
  v->say("Yes.");
  v->at(10.3, 1.2, 0.0);
  v->say("Robot, at your left there is a glass wall.");
  v->say("Yes.");
  v->at(16.7, 1.2, 0.0);
  v->say("Robot, at your right there is a glass wall.");
  v->say("Yes.");
}

/// The glass is told of, the map has its places, and the robot stands at the corridor's beginning.
void beginInCorridor(Visit* v) {
  tellOfGlass(v);
  v->segment();
  v->at(1.0, 1.2, 0.0);
}

const char kDescription[] =
    "Robot, you are in the corridor. On your left you have room i-109, then i-110 and i-111. You "
    "are "
    "in the corridor. On your right you have room i-108. You are in the corridor. Behind you are "
    "the "
    "stairs. You are in the corridor. In front of you is the Hall. Room i-108 is also known as "
    "robosoccer room. Room i-110 is also known as industrial robotics room. Room i-109 is also "
    "known "
    "as mobile robotics room. Finally, room i-108 has 15 by 6 meters.";

/// Walls of glass told, map made, building described from the beginning of the corridor.
void describe(Visit* v) {
  tellOfGlass(v);
  v->segment();
  v->at(1.0, 1.2, 0.0);
  v->say(kDescription);
}

}  // namespace

TEST(Dialogue, TheConversationOfSection731) {
  Visit v;
  EXPECT_TRUE(v.say("Robot, follow me.").has(DialogueAction::Kind::kFollow));
  tellOfGlass(&v);
  const auto& walls = v.dialogue.places().walls();
  ASSERT_EQ(walls.size(), 4u);
  expectAt(walls[0].line, "glass right 1");
  expectAt(walls[1].line, "glass right 2");
  expectAt(walls[2].line, "glass left 1");
  expectAt(walls[3].line, "glass right 3");

  v.segment();
  v.at(1.0, 1.2, 0.0);
  const Id corridor = v.truth("corridor");
  ASSERT_NE(corridor, 0u);
  const std::string code = hyselam_topo::codeOf(*v.dialogue.map().findPlace(corridor));
  EXPECT_EQ(v.say("Robot, where are you?").text(), "I am at " + code + ".");
  const Reply told = v.say(kDescription);
  EXPECT_EQ(told.sentences.at(0).rfind("Noted: This is the corridor. ", 0), 0u) << told.text();
  EXPECT_EQ(told.sentences.at(1), "I have found 7 of 7 on my map, 1 for sure.");
  EXPECT_TRUE(told.has(DialogueAction::Kind::kMap));
  EXPECT_EQ(v.say("Robot, where are you?").text(), "I am at " + code + ", the corridor.");
  for (const std::string name : {"i-108", "i-109", "i-110", "i-111", "stairs", "hall"}) {
    const Id place = v.truth(name);
    ASSERT_NE(place, 0u) << name;
    ASSERT_FALSE(v.names(place).empty()) << name;
    EXPECT_TRUE(v.dialogue.places().sameName(v.names(place)[0], name)) << name << v.names(place)[0];
    EXPECT_EQ(hyselam_topo::nameStateOf(*v.dialogue.map().findPlace(place)),
              hyselam_topo::NameState::kUnconfirmed);
  }

  const Reply entered = v.at(3.0, 6.0, 0.0);
  EXPECT_TRUE(has(entered, "Can you please confirm the name")) << entered.text();
  const Reply where = v.say("Robot, Stop. Robot, where are you?");
  EXPECT_TRUE(has(where,
                  "Can you please confirm the name room i-109 and mobile robotics room, as "
                  "the name of this place?"))
      << where.text();
  EXPECT_TRUE(has(v.say("Yes."), "Thank you."));
  EXPECT_EQ(hyselam_topo::nameStateOf(*v.dialogue.map().findPlace(v.truth("i-109"))),
            hyselam_topo::NameState::kConfirmed);

  const Reply go = v.say("Robot, go to I-110 and then go to the corridor.");
  const auto action = std::find_if(go.actions.begin(), go.actions.end(), [](const auto& a) {
    return a.kind == DialogueAction::Kind::kGo;
  });
  ASSERT_NE(action, go.actions.end()) << go.text();
  ASSERT_EQ(action->legs.size(), 2u);
  const auto& legs = action->legs;
  EXPECT_EQ(legs[0].places, (std::vector<Id>{v.truth("i-109"), corridor, v.truth("i-110")}));
  EXPECT_EQ(legs[1].places, (std::vector<Id>{v.truth("i-110"), corridor}));
  ASSERT_EQ(legs[0].waypoints.size(), 3u);
  EXPECT_NEAR(legs[0].waypoints[0].x, 3.5, 0.3);
  EXPECT_NEAR(legs[0].waypoints[0].y, 2.5, 0.3);
  EXPECT_NEAR(legs[0].waypoints[1].x, 7.0, 0.3);
  EXPECT_NEAR(legs[0].waypoints[1].y, 2.5, 0.3);
  for (const auto& leg : legs) {
    for (const Pose2& pose : leg.path) {
      EXPECT_LT(grid().valueOr(grid().geometry.cellAt({pose.x, pose.y})), 50);
    }
  }
}

TEST(Dialogue, RejectedGlassWallAsksForItsLength) {
  Visit v;
  v.at(7.2, 1.2, 0.0);  // the door of i-110 is nearer than the glass
  const Reply first = v.say("On your left there is a glass wall.");
  EXPECT_TRUE(has(first, "0.9")) << first.text();
  EXPECT_EQ(v.dialogue.question().kind, Question::Kind::kWall);
  EXPECT_TRUE(has(v.say("No."), "What is the size of this glass wall?"));
  EXPECT_TRUE(has(v.say("It is 3.6 meters."), "3.60 meters long"));
  v.say("Yes, that is right.");
  ASSERT_EQ(v.dialogue.places().walls().size(), 1u);
  expectAt(v.dialogue.places().walls()[0].line, "glass left 1");
  EXPECT_TRUE(has(v.say("Forget the last wall."), "forgotten"));
  EXPECT_TRUE(v.dialogue.places().walls().empty());
  EXPECT_TRUE(has(v.say("Forget the last wall."), "no such wall"));
}

TEST(Dialogue, RejectedNameAsksForTheRightOne) {
  Visit v;
  describe(&v);
  v.at(9.0, 6.0, 0.0);
  ASSERT_EQ(v.dialogue.question().kind, Question::Kind::kConfirmName);
  v.say("No.");
  EXPECT_NE(v.dialogue.question().kind, Question::Kind::kNone);
  const Reply named = v.say("This is the music room.");
  EXPECT_TRUE(has(named, "music room")) << named.text();
  EXPECT_EQ(v.names(v.truth("i-110")), std::vector<std::string>{"music room"});
}

TEST(Dialogue, AnswersQuestions) {
  Visit v;
  EXPECT_EQ(v.say("Where are you?").text(), "I do not know where I am.");
  EXPECT_TRUE(has(v.say("Go to the kitchen."), "I do not know the place kitchen."));
  EXPECT_EQ(v.say("Yes.").text(), "All right.");
  describe(&v);
  EXPECT_TRUE(has(v.say("What is next to the stairs?"), "corridor"));
  EXPECT_TRUE(has(v.say("Where is I-111?"), "meters from here"));
  EXPECT_TRUE(has(v.say("Is this I-111?"), "Perhaps i-111 is"));
  EXPECT_TRUE(has(v.say("Are we in the stairs?"), "meters from here"));
  EXPECT_TRUE(has(v.say("How do I get to the hall?"), "corridor"));
  EXPECT_TRUE(has(v.say("What is on your left?"), "i-109"));
  EXPECT_TRUE(has(v.say("How big is room i-108?"), "9"));
  EXPECT_TRUE(has(v.say("Which places do you know?"), "Hall"));
  EXPECT_TRUE(has(v.say("Flurb the gnarl of sqwox."), "I did not understand"));
}

TEST(Dialogue, AsksToConfirmAGuessThatItIsAskedFor) {
  Visit v;
  describe(&v);
  v.at(9.0, 6.0, 0.0);
  for (const char* said :
       {"Cancel.", "Never mind.", "Stop.", "Halt!", "Help.", "Hello.", "Skip."}) {
    v.dialogue.hear(said);
    const auto names = v.names(v.truth("i-110"));
    EXPECT_EQ(std::count(names.begin(), names.end(), "i-110"), 1) << said << " is no name";
  }
  EXPECT_EQ(v.say("Okay.").text(), "All right.") << "stop ends a question";
  const std::string name = v.names(v.truth("i-110")).front();
  const Reply reply = v.say("Is this " + name + "?");
  EXPECT_TRUE(has(reply, "I am there. Can you please confirm the name " + name)) << reply.text();
  v.say("Yes.");
  EXPECT_TRUE(has(v.say("Is this " + name + "?"), "Yes. " + name));
  EXPECT_EQ(v.dialogue.question().kind, Question::Kind::kNone);
  v.at(1.0, 1.2, 0.0);
  EXPECT_TRUE(has(v.say("Is this " + name + "?"), "No. " + name));
}

TEST(Dialogue, ForgetsTheWholeDescription) {
  Visit v;
  describe(&v);
  EXPECT_TRUE(has(v.say("Forget all names."), "Shall I forget"));
  v.say("Yes.");
  EXPECT_TRUE(has(v.say("Where is the hall?"), "I do not know the place hall."));
  v.at(1.0, 1.2, 0.0);
  v.say("You are in the corridor. On your left you have the lab.");
  for (const auto& place : v.dialogue.map().places) {
    for (const auto& name : v.names(place.id)) {
      EXPECT_TRUE(name == "corridor" || name == "lab") << name;
    }
  }
}

TEST(Dialogue, AsksByItselfAsItsParametersSay) {
  DialogueParams params;
  params.ask = AskPolicy::kAlways;
  Visit always(params);
  always.segment();
  EXPECT_TRUE(has(always.at(-2.0, 1.0, 0.0), "What is the name of this place?"));
  EXPECT_TRUE(always.at(-2.1, 1.0, 0.0).sentences.empty()) << "once per stay";
  always.at(24.0, 1.0, 0.0);
  EXPECT_EQ(always.dialogue.question().place, always.truth("hall"))
      << "leaving takes the question back, entering asks the next one";
  EXPECT_TRUE(has(always.say("The lobby."), "Thank you."));
  EXPECT_EQ(always.names(always.truth("hall")), std::vector<std::string>{"lobby"});
  always.at(-2.0, 1.0, 0.0);
  EXPECT_TRUE(has(always.say("I do not know."), "All right."));
  EXPECT_EQ(always.dialogue.question().kind, Question::Kind::kNone);

  params.ask = AskPolicy::kNever;
  Visit never(params);
  describe(&never);
  EXPECT_TRUE(never.at(3.0, 6.0, 0.0).sentences.empty());
}

TEST(Dialogue, AsksForThePlaceThatANewMapFindsItIn) {
  DialogueParams params;
  params.ask = AskPolicy::kAlways;
  Visit visit(params);
  const Point2 here = plan().places.front().at;
  visit.at(here.x, here.y, 0.0);  // there is no map yet
  visit.segment();
  EXPECT_FALSE(visit.at(here.x, here.y, 0.0).sentences.empty());
  EXPECT_EQ(visit.dialogue.robot().place, visit.dialogue.question().place);
  EXPECT_TRUE(visit.at(here.x, here.y, 0.0).sentences.empty());  // once
}

TEST(Dialogue, AsksForTheNameThatSeparatesEqualAssignments) {
  DialogueParams params;
  params.ask_from_afar = true;
  Visit v(params);
  beginInCorridor(&v);
  // Three rooms of one size on no side that was told: who could know?
  Reply told = v.say(
      "You are in the corridor. The corridor is connected to room A. The corridor is connected to "
      "room "
      "B. The corridor is connected to room C.");
  EXPECT_TRUE(has(told, "answers fit equally well")) << told.text();
  ASSERT_NE(v.dialogue.question().kind, Question::Kind::kNone) << told.text();
  // Where each of them may be is told to programs, too: its place on the map first.
  const auto& unsure = v.dialogue.unsure().places;
  ASSERT_EQ(unsure.count("room B"), 1U) << told.text();
  EXPECT_GE(unsure.at("room B").size(), 3U);
  EXPECT_EQ(v.names(unsure.at("room B").front()), std::vector<std::string>{"room B"});
  const std::size_t before = v.dialogue.match()->equal;
  const Id asked = v.dialogue.question().place;
  EXPECT_TRUE(has(told, hyselam_topo::codeOf(*v.dialogue.map().findPlace(asked))));
  v.say("Room B.");
  EXPECT_EQ(v.names(asked), std::vector<std::string>{"room B"});
  EXPECT_LT(v.dialogue.match()->equal, before);
}

TEST(Dialogue, ASentenceThatLetsMoreAnswersFitMovesNoName) {
  Visit v;
  beginInCorridor(&v);
  v.say("You are in the corridor. The corridor is connected to room M.");
  const auto where = [&v] {
    std::map<std::string, std::vector<Id>> places;
    for (const auto& place : v.dialogue.map().places) {
      for (const std::string& name : v.names(place.id)) places[name].push_back(place.id);
    }
    return places;
  };
  auto known = where();
  // Rooms that come before it in the alphabet, and after it.
  for (const char* name : {"room C", "room X", "room A", "the kitchen", "the archive"}) {
    const Reply told = v.say("The corridor is connected to " + std::string(name) + ".");
    EXPECT_FALSE(has(told, "moves")) << told.text();
    auto now = where();
    for (const auto& [before, places] : known) EXPECT_EQ(now[before], places) << before;
    known = std::move(now);
  }
  EXPECT_EQ(known.size(), 7U);
}

TEST(Dialogue, ANoAboutAnotherPlaceIsFollowedByAQuestionAboutThatPlace) {
  DialogueParams params;
  params.ask_from_afar = true;
  Visit v(params);
  beginInCorridor(&v);
  std::string told = "You are in the corridor.";
  for (const char* name : {"A", "B", "C", "D", "E", "F"}) {
    told += std::string(" The corridor is connected to room ") + name + ".";
  }
  const Reply asks = v.say(told);
  ASSERT_EQ(v.dialogue.question().kind, Question::Kind::kConfirmName) << asks.text();
  const Id asked = v.dialogue.question().place;
  ASSERT_NE(asked, v.dialogue.robot().place);
  const Reply next = v.say("No.");
  ASSERT_EQ(v.dialogue.question().place, asked) << next.text();
  EXPECT_TRUE(has(next, hyselam_topo::codeOf(*v.dialogue.map().findPlace(asked)))) << next.text();
  EXPECT_FALSE(has(next, "this place")) << next.text();
}

TEST(Dialogue, CorrectionsReplaceStatements) {
  Visit v;
  beginInCorridor(&v);
  v.say(
      "You are in the corridor. On your left you have the kitchen. The kitchen is 15 by 6 meters.");
  v.say("No, the kitchen is on your right.");
  EXPECT_EQ(v.dialogue.places().find("kitchen"), std::vector<Id>{v.truth("i-108")});
  EXPECT_TRUE(has(v.say("Forget the name kitchen."), "I have forgotten"));
  EXPECT_TRUE(v.dialogue.places().find("kitchen").empty());
  v.at(11.0, -3.0, 0.0);
  v.say("This is the gym.");
  v.say("Rename the gym to arena.");
  EXPECT_EQ(v.names(v.truth("i-108")), std::vector<std::string>{"arena"});
}

TEST(Dialogue, VirtualPlacesAreAddedAndNamed) {
  Visit v;
  describe(&v);
  v.at(12.0, -3.0, 0.0);
  v.say("Yes.");
  const Id room = v.dialogue.robot().place;
  EXPECT_TRUE(has(v.say("You are in a virtual place, with 1 meter of radius."), "VV"));
  const Id here = v.dialogue.robot().place;
  EXPECT_NE(here, room);
  EXPECT_EQ(v.dialogue.question().kind, Question::Kind::kName);
  EXPECT_TRUE(has(v.say("The charging station."), "Thank you."));
  EXPECT_EQ(v.dialogue.places().find("charging station"), std::vector<Id>{here});
  v.at(1.0, 1.2, 0.0);
  EXPECT_TRUE(v.say("Go to the charging station.").has(DialogueAction::Kind::kGo));
}

TEST(Dialogue, AShutDoorIsToldWhereItIsInTheWayAndOpenedAgain) {
  Visit v;
  describe(&v);
  v.at(12.0, -3.0, 0.0);
  v.say("Yes.");
  const Id room = v.dialogue.robot().place;
  v.at(1.0, 1.2, 0.0);
  const std::string go = "Go to " + hyselam_topo::codeOf(*v.dialogue.map().findPlace(room)) + ".";
  ASSERT_TRUE(v.say(go).has(DialogueAction::Kind::kGo));
  std::vector<hyselam_topo::DescribedWall> shut;
  for (const hyselam_topo::Edge& edge : v.dialogue.map().edges) {
    if (edge.a != room && edge.b != room) continue;
    for (const hyselam_topo::Door& door : edge.doors) {
      const double half = 0.5 * door.width + 0.1;
      const hyselam::Point2 along{-half * door.normal.y, half * door.normal.x};
      shut.push_back({{{door.position.x - along.x, door.position.y - along.y},
                       {door.position.x + along.x, door.position.y + along.y}},
                      hyselam_topo::WallKind::kVirtual});
    }
  }
  ASSERT_FALSE(shut.empty());
  // A robot that drives may be about to go through it: it stops, once.
  for (const auto& wall : shut) {
    const Reply told = v.dialogue.addWall(wall);
    const bool first = &wall == &shut.front();
    EXPECT_TRUE(has(told, "I treat the door as shut.")) << told.text();
    EXPECT_EQ(told.has(DialogueAction::Kind::kStop), first);
    EXPECT_EQ(has(told, "I have stopped."), first) << told.text();
  }
  const Reply none = v.say(go);
  EXPECT_FALSE(none.has(DialogueAction::Kind::kGo));
  EXPECT_TRUE(has(none, "I find no way")) << none.text();
  EXPECT_TRUE(has(none, "I treat the door between")) << none.text();
  EXPECT_EQ(v.say("Undo that.").text(), "I treat the door as open again.");
  v.dialogue.addWall(shut.back());
  EXPECT_TRUE(v.dialogue.useLanguage("pt"));
  EXPECT_FALSE(v.dialogue.useLanguage("fr"));
  for (const auto& wall : shut) {
    EXPECT_EQ(v.dialogue.removeWall(wall).text(), "Volto a tratar a porta como aberta.");
    EXPECT_TRUE(v.dialogue.removeWall(wall).actions.empty());
  }
  EXPECT_TRUE(v.say(go).has(DialogueAction::Kind::kGo));
}

TEST(Dialogue, ContinuesAfterARestart) {
  hyselam::testing::TemporaryDirectory directory;
  const std::string path = directory / "state";
  Visit v;
  describe(&v);
  v.at(3.0, 6.0, 0.0);
  v.say("Yes.");
  hyselam_topo::saveDialogueState(path, v.dialogue.state());
  Visit again;
  again.dialogue.restore(hyselam_topo::loadDialogueState(path));
  EXPECT_EQ(hyselam_topo::toText(again.dialogue.state()), hyselam_topo::toText(v.dialogue.state()));
  EXPECT_TRUE(again.dialogue.map() == v.dialogue.map());
  again.segment();
  again.at(3.0, 6.0, 0.0);
  EXPECT_TRUE(has(again.say("Where are you?"), "room i-109"));
  EXPECT_TRUE(has(again.say("What is next to I-109?"), "corridor"));

  // Damaged, cut, from somewhere else.
  const std::string good = hyselam::testing::fileBytes(path);
  const auto messageOf = [&](const std::string& text) {
    return hyselam::testing::messageOf<InputError>(
        [&] { hyselam_topo::dialogueStateFromText(text, "f"); });
  };
  std::string bad = good;
  bad[good.size() / 2] ^= 1;
  EXPECT_EQ(messageOf(bad), "f: it is damaged: the checksum is wrong");
  EXPECT_EQ(messageOf(good.substr(0, good.size() - 9)), "f: it is not complete");
  EXPECT_EQ(messageOf("<xml/>"), "f: line 1: this is no state of a dialogue");
  EXPECT_EQ(messageOf(""), "f: line 1: this is no state of a dialogue");
  EXPECT_EQ(
      messageOf("hyselam_dialogue 3 0 0\n"),
      "f: line 1: has version 3, this program reads 1 to 2; it was written by a newer HySeLAM");
}

TEST(Dialogue, AnswersInTheLanguageOfThePerson) {
  Visit v;
  describe(&v);
  v.at(3.0, 6.0, 0.0);
  const Reply where = v.say("Onde estás?");
  EXPECT_EQ(where.language, "pt");
  EXPECT_TRUE(has(where, "Estou em")) << where.text();
  EXPECT_TRUE(has(v.say("Sim."), "Obrigado."));
  EXPECT_TRUE(has(v.say("Where are you?"), "I am at"));
}

TEST(Dialogue, AnswersAnyText) {
  Visit v;
  describe(&v);
  for (const std::string& text :
       {std::string(), std::string("\xff\xfe"), std::string(100000, 'a'), std::string("yes no yes"),
        std::string("go to"), std::string("forget all names"), std::string("Rename it to x."),
        std::string("You are in a virtual place."), std::string("The radius is 500 meters."),
        std::string("There is a glass wall behind you."), std::string("cancel")}) {
    EXPECT_NO_THROW(v.say(text)) << text.substr(0, 30);
  }
  DialogueParams params;
  params.language = "tlh";
  EXPECT_THROW(Dialogue{params}, hyselam::ParameterError);
}

TEST(Phrases, RefuseFilesWithMistakes) {
  const auto messageOf = [](const std::string& yaml) {
    return hyselam::testing::messageOf<InputError>(
        [&] { hyselam_topo::Phrases::fromYaml("f", yaml); });
  };
  const std::string good =
      hyselam::testing::fileBytes(std::string(HYSELAM_PACKAGE_DIR) + "/dialogue/en.yaml");
  const auto with = [&](const std::string& a, const std::string& b) {
    std::string text = good;
    text.replace(text.find(a), a.size(), b);
    return text;
  };
  EXPECT_EQ(messageOf(good), "");
  EXPECT_NE(messageOf("[").find("f: line"), std::string::npos);
  EXPECT_EQ(messageOf("x"), "f: it is no YAML map");
  EXPECT_EQ(messageOf(with("hyselam_phrases", "other")),
            "f: key 'format': it is not hyselam_phrases");
  EXPECT_EQ(messageOf(with("  hello:", "  hullo:")), "f: key 'phrases/hullo': I know no such key");
  EXPECT_EQ(messageOf(with("  hello: \"Hello.\"\n", "")), "f: key 'phrases/hello': it is missing");
  EXPECT_EQ(messageOf(with("I am at {code}.", "I am at {place}.")),
            "f: key 'phrases/at_code': nothing is known for '{place}'");
  EXPECT_EQ(messageOf(with("I am at {code}.", "I am at {code.")),
            "f: key 'phrases/at_code': a brace is not closed");
}

TEST(Dialogue, AsksBeforeAPlaceWithANameGetsAnother) {
  Visit v;
  v.segment();
  v.at(1.0, 1.2, 0.0);
  v.say("You are in the corridor.");
  const Id here = v.truth("corridor");
  ASSERT_EQ(v.names(here), (std::vector<std::string>{"corridor"}));
  const Reply asked = v.say("You are in room 1.");
  EXPECT_TRUE(has(asked, "Is it also known as room 1?")) << asked.text();
  EXPECT_EQ(v.names(here), (std::vector<std::string>{"corridor"}));
  v.say("No.");
  EXPECT_EQ(v.names(here), (std::vector<std::string>{"corridor"}));
  v.say("You are in room 1.");
  v.say("Yes.");
  EXPECT_EQ(v.names(here), (std::vector<std::string>{"corridor", "room 1"}));
  v.say("You are in room 2.");
  v.say("Rename this place to room 2.");
  EXPECT_EQ(v.names(here), (std::vector<std::string>{"room 2"}));
}

TEST(Dialogue, RefusesInTheLanguageOfTheSentence) {
  Visit v;
  v.segment();
  v.at(1.0, 1.2, 0.0);
  EXPECT_TRUE(has(v.say("Onde estás?"), "Estou em"));
  const Reply english = v.say("The door of the kitchen is on your left.");
  EXPECT_TRUE(has(english, "I did not understand")) << english.text();
  EXPECT_TRUE(has(english, "is a part of a place")) << english.text();
  const Reply portuguese = v.say("A porta da cozinha fica à sua esquerda.");
  EXPECT_TRUE(has(portuguese, "é uma parte de um lugar")) << portuguese.text();
  // What fits no language better stays in that of the talk.
  EXPECT_EQ(v.say("Xyzzy.").language, "pt");
}
