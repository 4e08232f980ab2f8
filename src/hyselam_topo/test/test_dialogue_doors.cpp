// Doors that are treated as shut: told where they are in the way, and opened by what people say.
#include <gtest/gtest.h>

#include <tuple>
#include <utility>

#include "talk.hpp"

namespace {

using Kind = hyselam_topo::DialogueAction::Kind;
using hyselam_topo::Question;
using hyselam_topo::Reply;

bool has(const Reply& reply, const std::string& part) {
  return reply.text().find(part) != std::string::npos;
}

/// The door between both rooms is treated as shut; the robot stands in the kitchen.
struct ShutDoor : Talk {
  ShutDoor() {
    dialogue.name(1, {"kitchen"});
    dialogue.name(2, {"library"});
    hyselam_topo::DescribedWall wall;
    wall.line = {{4.05, 0.95}, {4.05, 2.05}};
    wall.kind = hyselam_topo::WallKind::kVirtual;
    dialogue.addWall(wall);
  }
  bool isOpen() const { return dialogue.places().shutDoors().empty(); }
};

}  // namespace

TEST(DialogueDoors, AShutDoorInTheWayIsOfferedToBeOpened) {
  for (const auto& [go, shut, asks, yes] :
       {std::tuple("Go to the library.", "I treat the door between the kitchen and the library",
                   "Is it open again?", "Yes."),
        std::tuple("Vai à library.", "Trato como fechada a porta entre", "Já está aberta?",
                   "Sim.")}) {
    ShutDoor talk;
    const Reply none = talk.dialogue.hear(go);
    EXPECT_FALSE(none.has(Kind::kGo));
    EXPECT_TRUE(has(none, shut)) << none.text();
    EXPECT_TRUE(has(none, asks)) << none.text();
    const Reply open = talk.dialogue.hear(yes);
    EXPECT_TRUE(open.has(Kind::kGo)) << open.text();
    EXPECT_TRUE(open.has(Kind::kWalls));
    EXPECT_TRUE(talk.isOpen());
  }
}

TEST(DialogueDoors, ADoorThatIsNotOpenStaysShut) {
  ShutDoor talk;
  talk.say("Go to the library.");
  const Reply reply = talk.dialogue.hear("No.");
  EXPECT_FALSE(reply.has(Kind::kGo));
  EXPECT_FALSE(talk.isOpen());
}

TEST(DialogueDoors, WhereThereIsNoWayADoorIsOpenedWithoutADrive) {
  ShutDoor talk;
  EXPECT_TRUE(has(talk.dialogue.hear("Where is the library?"), "Is it open again?"));
  const Reply reply = talk.dialogue.hear("Yes.");
  EXPECT_FALSE(reply.has(Kind::kGo));
  EXPECT_TRUE(talk.isOpen());
}

TEST(DialogueDoors, ADoorIsOpenedByWhatPeopleSay) {
  for (const char* said :
       {"The door to the library is open again.", "The door of the library is open now.",
        "The door is open again.", "The door between the kitchen and the library is open.",
        "Open the door to the library.", "Treat the door to the library as open.",
        "The door to the library is no longer locked.", "A porta da library já está aberta.",
        "A porta para a library está aberta outra vez.", "Abre a porta da library.",
        "A porta já está aberta.", "A porta da library já não está fechada."}) {
    ShutDoor talk;
    const Reply reply = talk.dialogue.hear(said);
    EXPECT_TRUE(talk.isOpen()) << said << ": " << reply.text();
    EXPECT_TRUE(has(reply, "as open again") || has(reply, "porta como aberta")) << reply.text();
    talk.say("Undo that.");
    EXPECT_FALSE(talk.isOpen()) << said;
  }
}

TEST(DialogueDoors, ADoorThatIsNotShutIsNotOpened) {
  Talk talk;
  talk.dialogue.name(2, {"library"});
  EXPECT_TRUE(has(talk.dialogue.hear("The door to the library is open again."), "no such door"));
}

TEST(DialogueDoors, ADoorIsShutAndOpenedByWhatPeopleSay) {
  for (const auto& [shut, open] :
       {std::pair("The door between the kitchen and the library is closed.",
                  "The library door is open again."),
        std::pair("The library door is locked.", "The door to the library is open."),
        std::pair("The door to the kitchen is shut.", "The kitchen door is open again."),
        std::pair("A porta entre a kitchen e a library está fechada.",
                  "A porta da library está aberta outra vez.")}) {
    ShutDoor talk;
    talk.say("The door is open again.");
    ASSERT_TRUE(talk.isOpen());
    const Reply reply = talk.dialogue.hear(shut);
    EXPECT_FALSE(talk.isOpen()) << shut << ": " << reply.text();
    EXPECT_TRUE(reply.has(Kind::kWalls)) << reply.text();
    EXPECT_FALSE(talk.dialogue.hear("Go to the library.").has(Kind::kGo));
    talk.say("No.");
    talk.say(open);
    EXPECT_TRUE(talk.isOpen()) << open;
    talk.say(shut);
    EXPECT_FALSE(talk.isOpen());
    talk.say("Undo that.");
    EXPECT_TRUE(talk.isOpen()) << "undo of: " << shut;
  }
}

TEST(DialogueDoors, ADoorThatIsNotThereIsNotShut) {
  Talk talk;
  talk.dialogue.name(1, {"kitchen"});
  EXPECT_TRUE(has(talk.dialogue.hear("The door to the attic is closed."), "attic"));
  EXPECT_TRUE(talk.dialogue.places().shutDoors().empty());
}
