// One talk about places and objects, with a robot that stands, drives and stops.
#include <gtest/gtest.h>

#include "example.hpp"
#include "hyselam_common/errors.hpp"

using namespace hyselam_conversation;  // NOLINT: a test, not a header

namespace {

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

ConversationParams driving() {
  ConversationParams params;
  params.arrive_at_once = false;
  return params;
}

TEST(Conversation, DescriptionsNamePlaces) {
  ExampleTalk example;
  const Exchange exchange =
      example.talk.say("You are in the corridor. On your left you have John's office.");
  EXPECT_EQ(exchange.layer, Layer::kPlaces);
  EXPECT_EQ(exchange.language, "en");
  EXPECT_TRUE(exchange.refusals.empty());
  EXPECT_EQ(exchange.understood.size(), 2u);
  ASSERT_FALSE(exchange.names.empty());
  const NameChange& corridor = exchange.names.front();
  EXPECT_EQ(corridor.code, "CC11");
  EXPECT_EQ(corridor.before, "");
  EXPECT_EQ(corridor.after, "corridor");
  EXPECT_TRUE(corridor.confirmed);
}

/// What is asked of a sentence that was understood in part names what it does without; a "yes"
/// takes down what was asked.
TEST(Conversation, WhatAQuestionDoesWithoutIsNamed) {
  ExampleTalk example;
  example.talk.say("You are in the corridor.");
  const Exchange asked =
      example.talk.say("The fuse room is on the right, immediately after the fire door.");
  EXPECT_TRUE(contains(asked.replyText(), "immediately after the fire door")) << asked.replyText();
  EXPECT_NE(asked.question, "");
  EXPECT_TRUE(asked.understood.empty());
  const Exchange taken = example.talk.say("Yes.");
  EXPECT_TRUE(contains(taken.replyText(), "Noted: The fuse room is on the right"))
      << taken.replyText();
  const Exchange thing =
      example.talk.say("Somebody has left a laptop on the table nearest to the door.");
  EXPECT_TRUE(contains(thing.replyText(), "to the door")) << thing.replyText();
}

/// "That is X" behind a sentence about another place does not name the place of the robot.
TEST(Conversation, WhatPointsBackNamesNoPlaceOfTheRobots) {
  for (const char* said :
       {"entre a cozinha e a casa de banho há uma portinha, isso é só a despensa",
        "See the door at the end with the frosted glass? That's the registry.",
        "That little room tucked in between the gift shop and the library is where we hang our "
        "coats; we simply call it the cloakroom."}) {
    ExampleTalk example;
    const Exchange exchange = example.talk.say(said);
    EXPECT_TRUE(exchange.names.empty()) << said << ": " << exchange.replyText();
  }
  ExampleTalk example;
  example.talk.standAt("SS04");
  const Exchange here =
      example.talk.say("Right, see this wee room we're in? That's the medical room.");
  ASSERT_EQ(here.names.size(), 1u) << here.replyText();
  EXPECT_EQ(here.names.front().after, "medical room");
}

/// "My cabin" of somebody unknown is taken for the cabin, and that is told.
TEST(Conversation, WhoseItIsIsNotLostSilently) {
  for (const auto& [said, mine] :
       {std::pair("Behind the kitchen is my cabin.", "I have left out 'my'"),
        std::pair("A minha cabine fica atrás da cozinha.", "Deixei de fora 'minha'")}) {
    ExampleTalk example;
    const std::string reply = example.talk.say(said).replyText();
    EXPECT_TRUE(contains(reply, mine)) << reply;
  }
  ExampleTalk example;
  EXPECT_FALSE(
      contains(example.talk.say("Behind the kitchen is our garden.").replyText(), "'our'"));
}

/// Gender tells of which noun a colour is.
TEST(Conversation, TheColourBelongsToTheNounThatItFits) {
  ExampleTalk example;
  example.talk.say("Estás no corredor.");
  const std::string reply =
      example.talk.say("A caixa de massinha está na prateleira do armário amarelo.").replyText();
  EXPECT_TRUE(contains(reply, "armário amarelo")) << reply;
  const std::string shelf =
      example.talk.say("A caneta está na prateleira amarela do armário.").replyText();
  EXPECT_FALSE(contains(shelf, "armário amarelo")) << shelf;
}

TEST(Conversation, WhatIsLeftOutIsToldOnce) {
  for (const char* said :
       {"The wrench is in the bottom drawer of the red toolbox, not the black one.",
        "The lab, as everybody knows, is on the left. The bar, as everybody knows, is on the "
        "right."}) {
    ExampleTalk example;
    const std::string reply = example.talk.say(said).replyText();
    const std::string words =
        contains(said, "black") ? "'not the black one'" : "'as everybody knows'";
    const std::size_t first = reply.find(words);
    ASSERT_NE(first, std::string::npos) << reply;
    EXPECT_EQ(reply.find(words, first + 1), std::string::npos) << reply;
  }
}

/// "No, wait, ..." corrects what was said right before, also of a thing; alone it stops the robot.
TEST(Conversation, NoWaitCorrectsWhatWasSaid) {
  for (const char* said : {"No, wait, it's on the table.", "No, hang on, it's on the table.",
                           "No, it's on the table.", "No wait, it's on the table."}) {
    for (const bool together : {false, true}) {
      ExampleTalk example;
      example.talk.confirmNames("CC11", {"kitchen"});
      const std::string before = "The cup is in the drawer.";
      if (!together) example.talk.say(before);
      const Exchange told = example.talk.say(together ? before + " " + said : said);
      EXPECT_FALSE(told.stopped) << told.text;
      EXPECT_TRUE(contains(told.replyText(), "the cup is on the table in the kitchen (before:"))
          << told.text << " -> " << told.replyText();
      EXPECT_FALSE(contains(told.replyText(), "left out")) << told.replyText();
    }
  }
  for (const char* said : {"No, wait.", "no wait stop", "The cup is in the drawer. No, stop!"}) {
    ExampleTalk example;
    EXPECT_TRUE(example.talk.say(said).stopped) << said;
  }
  ExampleTalk example(driving());
  example.talk.confirmNames("SS12", {"kitchen"});
  ASSERT_TRUE(example.talk.say("Go to the kitchen.").goal);
  EXPECT_TRUE(example.talk.say("No, wait, it's on the table.").stopped) << "in doubt, under way";
}

/// Whose "my office" is, is asked, and known from then on.
TEST(Conversation, MyOfficeIsTheSpeakers) {
  ExampleTalk example;
  example.talk.confirmNames("SS12", {"Tom's office"});
  EXPECT_TRUE(contains(example.talk.say("Where is my office?").replyText(), "your name"));
  const Exchange told = example.talk.say("I am Tom.");
  EXPECT_TRUE(contains(told.replyText(), "Tom's office is SS12")) << told.replyText();
  const Exchange again = example.talk.say("Where is my office?");
  EXPECT_EQ(again.question, "");
  EXPECT_TRUE(contains(again.replyText(), "Tom's office is SS12")) << again.replyText();
}

TEST(Conversation, ObjectsAreForTheOtherLayer) {
  ExampleTalk example;
  example.talk.confirmNames("CC11", {"corridor"});
  const Exchange told = example.talk.say("There is a red mug on the table.");
  EXPECT_EQ(told.layer, Layer::kObjects);
  EXPECT_EQ(told.forwarded.size(), 1u);
  EXPECT_TRUE(contains(told.replyText(), "mug")) << told.replyText();
  ASSERT_EQ(example.talk.objects().objects.size(), 2u);
  EXPECT_EQ(example.talk.objects().places.front().name, "corridor");
  const Exchange asked = example.talk.say("Where is the mug?");
  EXPECT_EQ(asked.layer, Layer::kObjects);
  EXPECT_TRUE(contains(asked.replyText(), "corridor")) << asked.replyText();
}

TEST(Conversation, TalkOfAThingGoesOnInTheLayerOfObjects) {
  ExampleTalk example;
  example.talk.confirmNames("CC11", {"corridor"});
  const auto say = [&](const std::string& text) { return example.talk.say(text).replyText(); };
  say("The coat is on the chair.");
  EXPECT_TRUE(contains(say("No, on the hook."), "on the hook"));
  EXPECT_TRUE(contains(say("Where's the coat now?"), "on the hook"));
  EXPECT_TRUE(contains(say("It's gone."), "no longer on the hook"));
  EXPECT_TRUE(
      contains(say("Somebody moved the trolley, it's in the lab now."), "trolley is in the lab"));
  EXPECT_TRUE(contains(say("Where does Anna sit?"), "Anna"));
}

TEST(Conversation, BothLayersAnswerOneText) {
  ExampleTalk example;
  const Exchange exchange =
      example.talk.say("You are in the corridor. There is a red mug on the table.");
  EXPECT_EQ(exchange.layer, Layer::kBoth);
  EXPECT_FALSE(example.talk.objects().objects.empty());
  EXPECT_FALSE(example.talk.dialogue().description().places.empty());
}

TEST(Conversation, RefusalsComeFromTheLayerOfTheSentence) {
  ExampleTalk example;
  const Exchange things = example.talk.say("There are a few spoons in the drawer, probably.");
  ASSERT_EQ(things.refusals.size(), 1u);
  EXPECT_TRUE(things.refusals.front().by_other);
  EXPECT_EQ(things.layer, Layer::kObjects);
  const Exchange places = example.talk.say("The kitchen might be left of the library.");
  ASSERT_EQ(places.refusals.size(), 1u);
  EXPECT_FALSE(places.refusals.front().by_other);
  EXPECT_EQ(places.layer, Layer::kPlaces);
  EXPECT_TRUE(example.talk.objects().objects.empty());
  EXPECT_TRUE(example.talk.dialogue().description().places.empty());
}

TEST(Conversation, AnswersGoToWhoAskedLast) {
  ExampleTalk example;
  example.talk.confirmNames("SS01", {"kitchen"});
  example.talk.confirmNames("SS05", {"library"});
  example.talk.say("The mug is in the kitchen.");
  const Exchange asked = example.talk.say("There is a pitcher in the kitchen.");
  EXPECT_EQ(asked.question, "");
  const Exchange moved = example.talk.say("The pitcher is in the library.");
  EXPECT_NE(moved.question, "") << moved.replyText();
  EXPECT_EQ(moved.question, example.talk.question());
  const Exchange yes = example.talk.say("Yes.");
  EXPECT_EQ(yes.layer, Layer::kObjects);
  EXPECT_EQ(yes.question, "");
  EXPECT_TRUE(contains(yes.replyText(), "library")) << yes.replyText();
}

TEST(Conversation, StopEndsTheQuestionOfTheLayerOfObjects) {
  ExampleTalk example;
  example.talk.confirmNames("SS01", {"kitchen"});
  example.talk.confirmNames("SS05", {"library"});
  example.talk.say("The pen is in the kitchen.");
  ASSERT_NE(example.talk.say("The pen is in the library.").question, "");
  EXPECT_EQ(example.talk.say("Stop!").question, "");
  example.talk.say("Yes.");
  EXPECT_TRUE(contains(example.talk.say("Where is the pen?").replyText(), "kitchen"));
}

TEST(Conversation, EnteringAPlaceWithAGuessedNameAsks) {
  ExampleTalk example;
  example.talk.guessNames("SS05", {"library"});
  const Exchange entered = example.talk.standAt("SS05");
  EXPECT_TRUE(contains(entered.question, "library")) << entered.replyText();
  EXPECT_EQ(entered.place, 5u);
  const Exchange yes = example.talk.say("yes");
  ASSERT_EQ(yes.names.size(), 1u);
  EXPECT_TRUE(yes.names.front().confirmed);
  EXPECT_EQ(yes.question, "");
}

TEST(Conversation, AsksForANameWhenTold) {
  ExampleTalk example;
  example.talk.standAt("SS04");
  EXPECT_EQ(example.talk.question(), "");
  const Exchange asked = example.talk.askHere();
  EXPECT_NE(asked.question, "");
  const Exchange answer = example.talk.say("The library.");
  ASSERT_EQ(answer.names.size(), 1u);
  EXPECT_EQ(answer.names.front().code, "SS04");
}

TEST(Conversation, IsThereWhenItHasSaidThatItGoes) {
  ExampleTalk example;
  example.talk.confirmNames("SS01", {"kitchen"});
  const Exchange exchange = example.talk.say("Go to the kitchen.");
  EXPECT_EQ(exchange.goal, 1u);
  EXPECT_EQ(exchange.motion, Motion::kStanding);
  EXPECT_EQ(exchange.place, 1u);
}

TEST(Conversation, DrivesUntilItArrivesOrIsStopped) {
  ExampleTalk example(driving());
  example.talk.confirmNames("SS01", {"kitchen"});
  example.talk.confirmNames("SS05", {"library"});
  EXPECT_EQ(example.talk.say("Go to the library.").motion, Motion::kDriving);
  EXPECT_EQ(example.talk.say("Where is the kitchen?").motion, Motion::kDriving);
  const Exchange stop = example.talk.say("Stop!");
  EXPECT_TRUE(stop.stopped);
  EXPECT_EQ(stop.motion, Motion::kStanding);
  EXPECT_EQ(example.talk.arrive().place, 11u) << "it stays where it was stopped";
  example.talk.say("Go to the library.");
  const Exchange there = example.talk.arrive();
  EXPECT_EQ(there.place, 5u);
  EXPECT_EQ(there.motion, Motion::kStanding);
}

TEST(Conversation, AsksOnTheWayThroughAPlace) {
  ExampleTalk example(driving());
  example.talk.guessNames("SS05", {"library"});
  example.talk.driveTo("SS05");
  EXPECT_TRUE(contains(example.talk.arrive().question, "library"));
}

TEST(Conversation, DrivesToAThing) {
  ExampleTalk example;
  example.talk.confirmNames("SS01", {"kitchen"});
  example.talk.say("The pen is in the kitchen.");
  const Exchange exchange = example.talk.say("Fetch the pen.");
  EXPECT_EQ(exchange.goal, 1u) << exchange.replyText();
  EXPECT_EQ(exchange.layer, Layer::kObjects);
}

TEST(Conversation, FollowsAndTurns) {
  ExampleTalk example;
  EXPECT_EQ(example.talk.say("Follow me.").motion, Motion::kFollowing);
  const double before = example.talk.dialogue().robot().pose.theta;
  EXPECT_EQ(example.talk.say("Turn left.").motion, Motion::kStanding);
  EXPECT_NEAR(example.talk.dialogue().robot().pose.theta - before, 0.5 * hyselam::kPi, 1e-9);
}

TEST(Conversation, WallsOfGlassAreSearchedInTheMap) {
  ExampleTalk example;
  example.talk.stand({30.0, 8.0, 0.0});
  const Exchange exchange = example.talk.say("On your left there is a glass wall.");
  EXPECT_TRUE(contains(exchange.question, "glass wall")) << exchange.replyText();
}

TEST(Conversation, SpeaksTheLanguageOfThePerson) {
  ExampleTalk example;
  const Exchange exchange = example.talk.say("Estás no corredor.");
  EXPECT_EQ(exchange.language, "pt");
  EXPECT_EQ(example.talk.say("You are in the corridor.").language, "en");
}

TEST(Conversation, GoesOnFromAState) {
  ExampleTalk before;
  before.talk.confirmNames("SS01", {"kitchen"});
  Conversation after({}, {}, exampleLanguages());
  after.restore(before.talk.dialogue().state());
  after.stand({1.0, 8.0, 0.0});
  EXPECT_EQ(after.say("Go to the kitchen.").goal, 1u);
}

TEST(Conversation, NothingOfTheTalkBeforeOutlivesAState) {
  const hyselam_topo::DialogueState state = ExampleTalk().talk.dialogue().state();
  ExampleTalk example(driving());
  example.talk.say("The pen is in the kitchen.");
  ASSERT_NE(example.talk.say("The pen is in the library.").question, "");
  example.talk.driveTo("SS12");
  example.talk.restore(state);
  EXPECT_EQ(example.talk.motion(), Motion::kStanding);
  EXPECT_EQ(example.talk.question(), "");
  EXPECT_FALSE(contains(example.talk.say("Yes.").replyText(), "Noted"));
  EXPECT_TRUE(contains(example.talk.say("Where is the pen?").replyText(), "kitchen"));
  example.talk.restore(state);
  EXPECT_FALSE(contains(example.talk.say("It is green.").replyText(), "Noted"));
}

TEST(Conversation, RefusesPlacesThatAreNotThere) {
  ExampleTalk example;
  EXPECT_THROW(example.talk.standAt("the moon"), hyselam::InputError);
  EXPECT_THROW(example.talk.driveTo("the moon"), hyselam::InputError);
  EXPECT_THROW(example.talk.confirmNames("the moon", {"x"}), hyselam::InputError);
  EXPECT_THROW(example.talk.guessNames("SS99", {"x"}), hyselam::InputError);
}

TEST(Conversation, TakesAnyText) {
  ExampleTalk example;
  const std::string all_bytes = [] {
    std::string text;
    for (int c = 0; c < 256; ++c) text += static_cast<char>(c);
    return text;
  }();
  for (const std::string& text : {std::string(), all_bytes, std::string(100000, 'x'),
                                  std::string("???"), std::string("' or 1=1; --")}) {
    const Exchange exchange = example.talk.say(text);
    EXPECT_TRUE(exchange.names.empty());
  }
  EXPECT_TRUE(example.talk.objects().objects.empty());
}

TEST(Conversation, WithoutAMapItSaysSo) {
  Conversation talk({}, {}, exampleLanguages());
  EXPECT_NE(talk.say("Where are you?").replyText(), "");
  EXPECT_EQ(talk.say("You are in the corridor.").names.size(), 0u);
  EXPECT_THROW(talk.standAt("kitchen"), hyselam::InputError);
}

TEST(Conversation, EqualTalksAreEqual) {
  const auto told = [] {
    ExampleTalk example;
    std::string all;
    for (const char* text : {"You are in the corridor. On your left there is the kitchen.",
                             "There is a cup.", "Go to the kitchen.", "yes", "what?"}) {
      all += example.talk.say(text).replyText() + "\n";
    }
    return all;
  };
  EXPECT_EQ(told(), told());
}

}  // namespace
