// What an answer or "undo that" refers to may be gone, or fit several places, in the meantime.
#include <gtest/gtest.h>

#include "hyselam_common/errors.hpp"
#include "talk.hpp"

using hyselam_topo::AugmentedTopologicalMap;
using hyselam_topo::DialogueState;
using hyselam_topo::Id;
using hyselam_topo::MovedName;
using hyselam_topo::Question;
using hyselam_topo::Reply;

namespace {

using Names = std::vector<std::string>;

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// The two rooms of another building, with ids from `first` on.
AugmentedTopologicalMap otherBuilding(Id first) {
  AugmentedTopologicalMap map = two_rooms::map();
  for (auto& place : map.places) place.id += first - 1;
  for (auto& edge : map.edges) {
    edge.a += first - 1;
    edge.b += first - 1;
  }
  for (Id& place : map.grid->places) place += first - 1;
  map.frame_id = "other";
  map.next_place_id = 100;
  return map;
}

/// Two toilets are told of, and the robot has gone on to room 2.
struct TalkOfToilets : Talk {
  TalkOfToilets() {
    say("In the corridor you have two toilets.");
    say("There are two toilets.");
    say("You are in the hall. There are two toilets, one on each side.");
    at(6.0);
  }
  /// Where the robot is, in the description.
  std::string robotPlace() const {
    const auto& building = dialogue.description();
    return building.robot_place ? building.findPlace(*building.robot_place)->name : "";
  }
};

/// The robot asks whether names have moved: the corridor was told to be as large as room 2, and is
/// corrected to be as large as room 1.
struct TalkOfMoves : Talk {
  std::string asked_in_words;

  TalkOfMoves() {
    AugmentedTopologicalMap map = two_rooms::map();
    map.findPlace(2)->area = 24.0;
    dialogue.setMap(map);
    say("The corridor is 4 by 6 metres. The lab is next to the corridor.");
    asked_in_words = say("No, the corridor is 4 by 3 metres.");
  }
};

}  // namespace

// ---- Names that fit several places that were told of ----

TEST(DialogueStale, ANameOfSeveralToldPlacesIsTakenForTheRoomAlone) {
  TalkOfToilets talk;
  const std::string before = talk.robotPlace();
  ASSERT_EQ(talk.dialogue.askHere().text(), "What is the name of this place?");
  const std::string reply = talk.say("The toilet.");
  EXPECT_TRUE(has(reply, "SS02 is the toilet")) << reply;
  EXPECT_EQ(talk.names(2), Names{"toilet"});
  EXPECT_EQ(talk.robotPlace(), before);
  EXPECT_EQ(talk.asked(), Question::Kind::kNone);
}

TEST(DialogueStale, AGuessThatFitsSeveralToldPlacesIsConfirmed) {
  TalkOfToilets talk;
  talk.guess(2, "toilet");
  talk.at(6.0);
  ASSERT_TRUE(has(talk.dialogue.askHere().text(), "toilet"));
  talk.say("Yes.");
  EXPECT_EQ(talk.names(2), Names{"toilet"});
  EXPECT_TRUE(talk.isConfirmed(2));
}

TEST(DialogueStale, AYesIsOfThePlaceThatWasAskedAboutAlsoWhereTheRobotHasLeftIt) {
  Talk talk;
  talk.guess(2, "toilet");
  talk.at(6.0);
  ASSERT_TRUE(has(talk.dialogue.askHere().text(), "as the name of this place?"));
  talk.at(1.0);
  EXPECT_EQ(talk.asked(), Question::Kind::kConfirmName);
  EXPECT_EQ(talk.dialogue.openQuestion(), "Is SS02 the toilet?");
  talk.say("Yes.");
  EXPECT_TRUE(talk.isConfirmed(2));
  EXPECT_TRUE(talk.names(1).empty());
  EXPECT_EQ(talk.asked(), Question::Kind::kNone);
}

TEST(DialogueStale, AQuestionThatWasLeftMakesRoomForOneAboutWhereTheRobotIs) {
  Talk talk;
  talk.guess(2, "toilet");
  talk.guess(1, "kitchen");
  talk.at(6.0);
  ASSERT_TRUE(has(talk.dialogue.askHere().text(), "toilet"));
  talk.at(1.0);
  ASSERT_TRUE(has(talk.dialogue.askHere().text(), "kitchen"));
  talk.say("No.");
  EXPECT_EQ(talk.names(2), Names{"toilet"});
  EXPECT_FALSE(talk.isConfirmed(2));
  EXPECT_TRUE(talk.names(1).empty());
}

TEST(DialogueStale, ANameIsNotTakenForAPlaceThatTheRobotHasLeft) {
  Talk talk;
  talk.at(6.0);
  ASSERT_EQ(talk.dialogue.askHere().text(), "What is the name of this place?");
  talk.at(1.0);
  EXPECT_EQ(talk.asked(), Question::Kind::kNone);
}

TEST(DialogueStale, AClickedNameThatFitsSeveralToldPlacesIsTaken) {
  TalkOfToilets talk;
  EXPECT_NO_THROW(talk.dialogue.name(2, {"toilet"}));
  EXPECT_EQ(talk.names(2), Names{"toilet"});
}

TEST(DialogueStale, AfterNoToAnotherNameTheRobotStaysWhereItWasTold) {
  TalkOfToilets talk;
  talk.dialogue.name(2, {"toilet"});
  ASSERT_TRUE(has(talk.say("You are in the library."), "also known"));
  const std::string reply = talk.say("No.");
  EXPECT_TRUE(has(reply, "toilet")) << reply;
  EXPECT_EQ(talk.names(2), Names{"toilet"});
}

TEST(DialogueStale, ANameThatIsRefusedLeavesNothingToUndo) {
  Talk talk;
  EXPECT_THROW(talk.dialogue.name(1, {"kit\x01chen"}), hyselam::InputError);
  EXPECT_TRUE(talk.names(1).empty());
  const std::string reply = talk.say("Undo that.");
  EXPECT_TRUE(has(reply, "nothing was told")) << reply;
}

// ---- A talk that is gone ----

TEST(DialogueStale, NothingOfTheTalkBeforeOutlivesAnotherState) {
  Talk other;
  other.say("The lab is next to the library.");
  const DialogueState state = other.dialogue.state();
  Talk talk;
  talk.say("You are in Narnia.");
  talk.say("Yes.");
  ASSERT_TRUE(talk.isConfirmed(1));
  talk.dialogue.restore(state);
  talk.at(2.0);
  EXPECT_TRUE(has(talk.say("Undo that."), "nothing was told"));
  EXPECT_EQ(talk.dialogue.description().places.size(), 2u);
  EXPECT_TRUE(has(talk.say("You are in Narnia."), "Shall I call")) << "nobody here has agreed";
  EXPECT_FALSE(talk.isConfirmed(1));
}

TEST(DialogueStale, WhatWasSaidAndDoneBeforeAnotherStateIsOver) {
  const DialogueState state = Talk().dialogue.state();
  Talk talk;
  ASSERT_TRUE(has(talk.say("Go to SS02."), "SS02"));
  talk.dialogue.restore(state);
  talk.at(2.0);
  EXPECT_FALSE(has(talk.say("What?"), "SS02")) << "nothing was said yet";
  EXPECT_FALSE(talk.dialogue.hear("No.").has(hyselam_topo::DialogueAction::Kind::kStop));
  talk.say("The lab is next to the library.");
  talk.dialogue.restore(state);
  talk.at(2.0);
  EXPECT_EQ(talk.say("It is also called the toilet."), "Thank you. SS01 is the toilet.")
      << "'it' is where the robot is";
}

// ---- Places that are gone ----

TEST(DialogueStale, ANameOfALostPlaceCannotBeTakenBack) {
  for (const Id first : {Id{11}, Id{1}}) {  // also where another place has its id
    Talk talk;
    talk.say("This is the kitchen.");
    talk.dialogue.setMap(otherBuilding(first));
    const std::string reply = talk.say("Undo that.");
    EXPECT_FALSE(has(reply, "forgotten")) << reply;
    EXPECT_TRUE(talk.names(first).empty());
  }
}

TEST(DialogueStale, NothingOlderIsTakenBackInsteadOfWhatIsGone) {
  for (const Id first : {Id{11}, Id{1}}) {
    Talk talk;
    talk.say("The lab is next to the library.");
    talk.say("This is the kitchen.");
    talk.dialogue.setMap(otherBuilding(first));
    for (int i = 0; i < 2; ++i) {
      EXPECT_TRUE(has(talk.say("Undo that."), "no longer on my map"));
      EXPECT_EQ(talk.say("Is the lab next to the library?"), "Yes.");
    }
    talk.say("The pantry is next to the lab.");
    EXPECT_TRUE(has(talk.say("Undo that."), "I have taken back: 'The pantry"));
    EXPECT_TRUE(has(talk.say("Undo that."), "no longer on my map"));
  }
}

TEST(DialogueStale, WhatWasSaidOfOtherPlacesIsTakenBackAfterAPlaceIsLost) {
  Talk talk;
  talk.say("This is the kitchen.");
  talk.say("The lab is next to the library.");
  talk.dialogue.setMap(otherBuilding(11));
  EXPECT_TRUE(has(talk.say("Undo that."), "I have taken back: 'The lab"));
  EXPECT_TRUE(has(talk.say("Undo that."), "no longer on my map"));
}

TEST(DialogueStale, WhatIsTooLongAgoIsToldSo) {
  Talk talk;
  talk.say("The lab is next to the library.");
  for (int i = 0; i < 20; ++i) talk.dialogue.name(1, {i % 2 == 0 ? "kitchen" : "canteen"});
  std::string reply;
  for (int i = 0; i < 16; ++i) reply = talk.say("Undo that.");
  EXPECT_TRUE(has(reply, "too long ago")) << reply;
  EXPECT_EQ(talk.say("Is the lab next to the library?"), "Yes.");
}

TEST(DialogueStale, AQuestionIsOverWithItsPlace) {
  for (const Id first : {Id{11}, Id{1}}) {
    Talk talk;
    talk.askAboutKitchen();
    ASSERT_EQ(talk.asked(), Question::Kind::kConfirmName);
    talk.dialogue.setMap(otherBuilding(first));
    EXPECT_EQ(talk.asked(), Question::Kind::kNone);
    talk.say("Yes.");
    EXPECT_TRUE(talk.names(first).empty());
  }
}

TEST(DialogueStale, AQuestionForAnotherNameIsOverWithTheNames) {
  {
    Talk talk;
    talk.say("This is the kitchen.");
    talk.say("You are in the library.");
    ASSERT_EQ(talk.asked(), Question::Kind::kAlsoName);
    talk.dialogue.forget(1);
    EXPECT_EQ(talk.asked(), Question::Kind::kNone);
    talk.say("No.");
    EXPECT_TRUE(talk.names(1).empty());
  }
  DialogueState rooms_apart = Talk().dialogue.state();
  rooms_apart.places.map.edges.clear();
  Talk talk;
  talk.dialogue.restore(rooms_apart);
  talk.at(2.0);
  talk.say("This is the kitchen.");
  talk.say("You are in the library.");
  ASSERT_EQ(talk.asked(), Question::Kind::kAlsoName);
  talk.dialogue.name(2, {"kitchen"});  // it was the other room's
  ASSERT_FALSE(talk.isConfirmed(1));
  EXPECT_EQ(talk.asked(), Question::Kind::kNone);
  talk.say("No.");
  EXPECT_FALSE(talk.isConfirmed(1));
}

TEST(DialogueStale, MovedNamesAreAskedForInWords) {
  const TalkOfMoves talk;
  ASSERT_EQ(talk.asked(), Question::Kind::kMoved) << talk.asked_in_words;
  EXPECT_TRUE(
      has(talk.asked_in_words,
          "That moves the corridor from SS02 to SS01 and the lab from SS01 to SS02; right?"))
      << talk.asked_in_words;
}

TEST(DialogueStale, MovedNamesAreDenied) {
  TalkOfMoves talk;
  ASSERT_EQ(talk.asked(), Question::Kind::kMoved) << talk.asked_in_words;
  talk.say("No.");
  EXPECT_TRUE(talk.dialogue.places().isRejected(1, "corridor"));
  EXPECT_TRUE(talk.dialogue.places().isRejected(2, "lab"));
}

TEST(DialogueStale, MovedNamesAreNotDeniedOfLostPlaces) {
  for (const Id first : {Id{11}, Id{1}}) {
    TalkOfMoves talk;
    ASSERT_EQ(talk.asked(), Question::Kind::kMoved) << talk.asked_in_words;
    talk.dialogue.setMap(otherBuilding(first));
    EXPECT_EQ(talk.asked(), Question::Kind::kNone);
    talk.say("No.");
    EXPECT_FALSE(talk.dialogue.places().isRejected(first, "corridor"));
  }
}
