// Stop, answers and the robot's questions, one rule a test.
#include <gtest/gtest.h>

#include "talk.hpp"

using hyselam_topo::AskPolicy;
using hyselam_topo::DialogueAction;
using hyselam_topo::HearOptions;
using hyselam_topo::Question;
using hyselam_topo::Reply;

namespace {

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

using Names = std::vector<std::string>;

}  // namespace

// ---- Stop ----

TEST(DialogueStop, EndsMotionAndTheOpenQuestionAndNamesNothing) {
  for (const char* said : {"Stop stop stop", "stop stop", "STOOOP", "hey robot wait no stop please",
                           "Stop asking.", "para para", "stpo"}) {
    Talk talk;
    ASSERT_TRUE(has(talk.askAboutKitchen(), "kitchen")) << said;
    const Reply reply = talk.dialogue.hear(said);
    EXPECT_TRUE(reply.has(DialogueAction::Kind::kStop)) << said;
    EXPECT_TRUE(reply.stopped && reply.ends_other_question) << said;
    EXPECT_EQ(talk.asked(), Question::Kind::kNone) << said;
    EXPECT_FALSE(talk.isConfirmed(1)) << said;
    EXPECT_EQ(reply.sentences.size(), 1u) << said << reply.text();
  }
}

TEST(DialogueStop, IsObeyedBeforeOtherNodesHearOfIt) {
  Talk talk;
  HearOptions options;
  options.forward_unknown = options.objects_spoken_of = options.others_asked_last = true;
  for (const char* said : {"stop", "no stop the pen", "cancel", "never mind", "wait"}) {
    const Reply reply = talk.dialogue.hear(said, options);
    EXPECT_TRUE(reply.has(DialogueAction::Kind::kStop)) << said;
    EXPECT_TRUE(reply.forwarded.empty()) << said;
  }
}

TEST(DialogueStop, GoOnGoesOnWhereAWayWasStoppedAndNothingIsAsked) {
  Talk talk;
  talk.dialogue.name(2, {"kitchen"});
  EXPECT_EQ(talk.dialogue.haltedGoal(), "");
  ASSERT_TRUE(talk.dialogue.hear("Go to the kitchen.").has(DialogueAction::Kind::kGo));
  EXPECT_EQ(talk.dialogue.haltedGoal(), "") << "it is on its way";
  talk.say("Stop.");
  EXPECT_EQ(talk.dialogue.haltedGoal(), "the kitchen");
  for (const char* said : {"go on", "Go on.", "carry on", "Continue."}) {
    const Reply reply = talk.dialogue.hear(said);
    EXPECT_TRUE(reply.has(DialogueAction::Kind::kGo)) << said << ": " << reply.text();
    EXPECT_EQ(talk.dialogue.haltedGoal(), "") << said;
    talk.say("Stop.");
  }
  talk.say("Cancel.");
  EXPECT_EQ(talk.dialogue.haltedGoal(), "");
  EXPECT_FALSE(talk.dialogue.hear("Go on.").has(DialogueAction::Kind::kGo));
}

TEST(DialogueStop, WhatElseWasSaidIsDoneOrTold) {
  Talk talk;
  talk.say("This is the kitchen.");
  Reply reply = talk.dialogue.hear("Stop and turn left.");
  EXPECT_TRUE(reply.has(DialogueAction::Kind::kTurn)) << reply.text();
  EXPECT_EQ(reply.actions.front().kind, DialogueAction::Kind::kStop);
  reply = talk.dialogue.hear("turn left no stop");
  EXPECT_FALSE(reply.has(DialogueAction::Kind::kTurn)) << reply.text();
  EXPECT_TRUE(has(reply.text(), "I have not taken 'turn left")) << reply.text();
  EXPECT_TRUE(has(talk.say("Stop. Where are you?"), "kitchen"));
  EXPECT_TRUE(has(talk.say("stop the flurb is sqwox"), "I have not taken 'the flurb is sqwox'"));
}

TEST(DialogueStop, TextsThatAreTooLongStopAllTheSame) {
  Talk talk;
  EXPECT_TRUE(
      talk.dialogue.hear(std::string(100000, 'x') + " stop").has(DialogueAction::Kind::kStop));
  EXPECT_FALSE(talk.dialogue.obeyUrgent("the bus stop").has_value());
  EXPECT_TRUE(talk.dialogue.obeyUrgent("Stop. Turn left.")->has(DialogueAction::Kind::kStop));
}

TEST(DialogueStop, NoStopsARobotThatIsUnderWay) {
  Talk talk;
  talk.say("This is the kitchen.");
  EXPECT_FALSE(talk.dialogue.hear("No!").has(DialogueAction::Kind::kStop));
  talk.say("Follow me.");
  EXPECT_TRUE(talk.dialogue.hear("No!").has(DialogueAction::Kind::kStop));
  EXPECT_FALSE(talk.dialogue.hear("No!").has(DialogueAction::Kind::kStop));
}

TEST(DialogueStop, ARobotThatStandsWhereItWasSentIsNotUnderWay) {
  Talk talk;
  talk.at(6.0);
  talk.say("This is the kitchen.");
  talk.at(2.0);
  ASSERT_TRUE(talk.dialogue.hear("Go to the kitchen.").has(DialogueAction::Kind::kGo));
  talk.at(2.0);  // not yet on its way: it stands for ten seconds
  talk.at(6.0);
  EXPECT_TRUE(talk.dialogue.hear("No!").has(DialogueAction::Kind::kStop));  // it has just come
  talk.at(2.0);
  ASSERT_TRUE(talk.dialogue.hear("Go to the kitchen.").has(DialogueAction::Kind::kGo));
  talk.at(6.0);
  talk.at(6.0);
  EXPECT_FALSE(talk.dialogue.hear("No!").has(DialogueAction::Kind::kStop));
  talk.say("Turn left.");
  talk.dialogue.setPose(talk.time += 0.1, {6.0, 1.5, 0.0});  // it has not begun to turn
  EXPECT_TRUE(talk.dialogue.hear("No!").has(DialogueAction::Kind::kStop));
}

// ---- One utterance, one answer ----

TEST(DialogueAnswer, TwoNoesAreOne) {
  for (const char* said : {"No, no.", "Nope, that's wrong.", "No. No, it is not."}) {
    Talk talk;
    talk.askAboutKitchen();
    EXPECT_TRUE(has(talk.say(said), "What is the name of this place?")) << said;
    EXPECT_EQ(talk.asked(), Question::Kind::kName) << said;
  }
}

TEST(DialogueAnswer, NotThisButThatIsOneAnswer) {
  Talk talk;
  talk.askAboutKitchen();
  const std::string reply = talk.say("No, it's Bruno's office.");
  EXPECT_TRUE(has(reply, "Bruno's office")) << reply;
  EXPECT_FALSE(has(reply, "?")) << reply;
  EXPECT_EQ(talk.names(1), Names{"Bruno's office"});
}

TEST(DialogueAnswer, DenyingTheAskedNameIsANo) {
  for (const char* said : {"No, this isn't the kitchen. It's the pantry.",
                           "This is not the kitchen. It is the pantry.", "Not the kitchen."}) {
    Talk talk;
    talk.askAboutKitchen();
    const std::string reply = talk.say(said);
    EXPECT_FALSE(has(reply, "not asked") || has(reply, "understand")) << said << ": " << reply;
    EXPECT_EQ(talk.names(1), has(said, "pantry") ? Names{"pantry"} : Names{})
        << said << ": " << reply;
  }
  Talk talk;
  talk.askAboutKitchen();
  talk.say("Não, isto não é kitchen. É a despensa.");
  EXPECT_EQ(talk.names(1), Names{"despensa"});
  // Another name than the one that is asked about is no answer.
  Talk other;
  other.askAboutKitchen();
  EXPECT_FALSE(has(other.say("This is not the library."), "What is the name"));
}

TEST(DialogueAnswer, YesWithAnotherNameIsAskedAbout) {
  Talk talk;
  talk.askAboutKitchen();
  const std::string reply = talk.say("Right, that's Peter's office.");
  EXPECT_TRUE(has(reply, "Shall I call this place 'Peter's office'?")) << reply;
  EXPECT_FALSE(talk.isConfirmed(1));
  talk.say("Yes.");
  EXPECT_EQ(talk.names(1), Names{"Peter's office"});
}

TEST(DialogueAnswer, YesWithTheSameNameConfirmsOnce) {
  Talk talk;
  talk.askAboutKitchen();
  EXPECT_EQ(talk.say("Yes, it's the kitchen."), "Thank you. SS01 is the kitchen.");
}

TEST(DialogueAnswer, WhatIsNoNameOfAPlaceIsAskedAbout) {
  for (const char* said : {"zorb", "flurble"}) {
    Talk talk(AskPolicy::kAlways);
    talk.dialogue.askHere();
    ASSERT_EQ(talk.asked(), Question::Kind::kName) << said;
    const std::string reply = talk.say(said);
    EXPECT_TRUE(has(reply, "Shall I call this place '")) << said << ": " << reply;
    EXPECT_TRUE(talk.names(1).empty()) << said;
    EXPECT_TRUE(has(talk.say("No."), "other words")) << said;
    EXPECT_TRUE(talk.names(1).empty()) << said;
  }
  Talk peter;
  peter.dialogue.askHere();
  peter.say("Peter.");
  EXPECT_TRUE(peter.names(1).empty());
  EXPECT_EQ(peter.dialogue.reply().language, "en");
  Talk talk;
  EXPECT_TRUE(has(talk.say("This is Atlantis."), "Shall I call this place 'Atlantis'?"));
  talk.say("Yes.");
  EXPECT_EQ(talk.names(1), Names{"Atlantis"});
  talk.at(6.0);
  talk.say("This is \"Utopia\".");
  EXPECT_EQ(talk.names(2), Names{"Utopia"}) << "put between quotation marks";
}

TEST(DialogueAnswer, AllWaysOfYesAndNoAreKnown) {
  for (const char* said : {"uh-huh", "mm-hm", "Sure thing", "You bet.", "that's it", "yup", "isso",
                           "pois", "é isso", "claro", "com certeza", "isso mesmo", "roger"}) {
    Talk talk;
    talk.askAboutKitchen();
    talk.say(said);
    EXPECT_TRUE(talk.isConfirmed(1)) << said;
    EXPECT_EQ(talk.names(1), Names{"kitchen"}) << said;
  }
  for (const char* said : {"nah", "not really", "negative", "nope", "pois não", "nem por isso",
                           "não é", "de modo nenhum", "uh-uh", "I don't think so"}) {
    Talk talk;
    talk.askAboutKitchen();
    talk.say(said);
    EXPECT_TRUE(talk.names(1).empty()) << said;
    EXPECT_EQ(talk.asked(), Question::Kind::kName) << said;
  }
  for (const char* said : {"I don't know", "no idea", "não sei", "sei lá", "dunno"}) {
    Talk talk;
    talk.askAboutKitchen();
    talk.say(said);
    EXPECT_FALSE(talk.isConfirmed(1)) << said;
    EXPECT_EQ(talk.asked(), Question::Kind::kNone) << said;
  }
}

TEST(DialogueAnswer, YesAndNoAtOnceAreAskedAgain) {
  Talk talk;
  const std::string question = talk.askAboutKitchen();
  EXPECT_EQ(talk.say("Yes. No."), question);
  EXPECT_EQ(talk.asked(), Question::Kind::kConfirmName);
}

TEST(DialogueAnswer, WhereNothingIsAskedItIsMetShortly) {
  Talk talk;
  for (const char* said : {"Yes.", "ok", "uh-huh", "I don't know."}) {
    EXPECT_EQ(talk.say(said), "All right.") << said;
  }
  EXPECT_EQ(talk.say("Yes, that's John's office."), "Thank you. SS01 is John's office.");
}

// ---- The life of a question ----

TEST(DialogueQuestion, IsOverAfterTheNextUtteranceAboutSomethingElse) {
  Talk talk;
  talk.askAboutKitchen();
  talk.say("Which places do you know?");
  EXPECT_EQ(talk.asked(), Question::Kind::kNone);
  EXPECT_EQ(talk.say("Yes."), "All right.");
  EXPECT_FALSE(talk.isConfirmed(1));
}

TEST(DialogueQuestion, StaysOverThanksAndHelp) {
  Talk talk;
  talk.askAboutKitchen();
  talk.say("Thank you.");
  talk.say("Yes.");
  EXPECT_TRUE(talk.isConfirmed(1));
}

TEST(DialogueQuestion, IsShownAgainWhenItWasNotHeard) {
  for (const char* said : {"What?", "Pardon?", "Como?", "O quê?", "what did you say", "huh?"}) {
    Talk talk;
    const std::string question = talk.askAboutKitchen();
    EXPECT_EQ(talk.say(said), question) << said;
    EXPECT_EQ(talk.asked(), Question::Kind::kConfirmName) << said;
  }
}

TEST(DialogueQuestion, WhatWasSaidLastIsSaidAgain) {
  Talk talk;
  const std::string said = talk.say("Where are you?");
  EXPECT_EQ(talk.say("Pardon?"), said);
}

TEST(DialogueQuestion, IsPutAgainOnceAfterWhatIsNotUnderstood) {
  Talk talk;
  const std::string question = talk.askAboutKitchen();
  EXPECT_TRUE(has(talk.say("Flurb the gnarl of sqwox."), question));
  EXPECT_FALSE(has(talk.say("Flurb the gnarl of sqwox."), question));
  EXPECT_EQ(talk.asked(), Question::Kind::kNone);
}

TEST(DialogueQuestion, ForgettingEverythingIsAskedFirst) {
  Talk talk;
  talk.say("This is the kitchen.");
  EXPECT_TRUE(has(talk.say("Forget all names."), "Shall I forget"));
  EXPECT_EQ(talk.names(1), Names{"kitchen"});
  talk.say("No.");
  EXPECT_EQ(talk.names(1), Names{"kitchen"});
  talk.say("Forget all names.");
  talk.say("Yes.");
  EXPECT_TRUE(talk.names(1).empty());
}

// ---- Languages ----

TEST(DialogueGo, ThereAndBackAreTwoWays) {
  for (const char* said :
       {"Go to the library and then come back here.", "Vai à library e depois volta para cá."}) {
    Talk talk;
    talk.say("This is the kitchen.");
    talk.dialogue.name(2, {"library"});
    const Reply reply = talk.dialogue.hear(said);
    ASSERT_TRUE(reply.has(DialogueAction::Kind::kGo)) << said << reply.text();
    ASSERT_EQ(reply.actions.front().legs.size(), 2u) << said;
    EXPECT_EQ(reply.actions.front().legs.back().places.back(), 1u) << said;
    EXPECT_TRUE(has(reply.text(), "kitchen")) << reply.text();
  }
}

TEST(DialogueKnowledge, WhatIsOppositeIsNotWhatIsBeside) {
  Talk talk;
  talk.say("This is the kitchen.");
  EXPECT_TRUE(has(talk.say("What is opposite the kitchen?"), "what is opposite the kitchen"));
}

TEST(DialogueLanguage, OthersAreToldWhatItSpeaks) {
  for (const char* said :
       {"La cuisine est à gauche.", "Die Küche ist links.", "La cocina está a la izquierda.",
        "Dónde está el baño?", "La cucina è a sinistra.", "Où est le bureau de Marie ?",
        "El despacho está junto al pasillo."}) {
    Talk talk;
    EXPECT_EQ(talk.say(said), "I speak English and Portuguese.") << said;
  }
  for (const char* said : {"Flurb the gnarl of sqwox.", "A cozinha floba à esquerda.", "xyzzy",
                           "a sala está fechada", "O zorbo da casa"}) {
    Talk talk;
    EXPECT_FALSE(has(talk.say(said), "Portuguese")) << said;
  }
}

// ---- Knowledge ----

TEST(DialogueKnowledge, RelationsAreAnsweredFromWhatWasTold) {
  Talk talk;
  talk.say("This is the kitchen.");
  talk.say("The pantry is next to the kitchen.");
  talk.say("The lab is between the pantry and the archive.");
  EXPECT_EQ(talk.say("Is the pantry next to the kitchen?"), "Yes.");
  EXPECT_EQ(talk.say("Is the archive next to the kitchen?"), "I do not know.");
  EXPECT_TRUE(has(talk.say("Which room is between the pantry and the archive?"), "lab"));
  const std::string told = talk.say("What have I told you?");
  EXPECT_TRUE(has(told, "The pantry is next to the kitchen.")) << told;
  EXPECT_TRUE(has(talk.say("What do you know about the pantry?"), "next to the kitchen"));
}

TEST(DialogueKnowledge, WhatWasToldOfASideIsThere) {
  Talk talk;
  talk.say("You are in the kitchen. The cellar is on your left.");
  const std::string left = talk.say("What is on your left?");
  EXPECT_TRUE(has(left, "cellar")) << left;
  const std::string right = talk.say("What is on your right?");
  EXPECT_FALSE(has(right, "cellar")) << right;
}

TEST(DialogueProposal, AfterANoTheNextReadingIsAsked) {
  Talk talk;
  talk.say("This is the kitchen.");
  hyselam_topo::ForwardedSentence heard;
  heard.text = "pantry, like, by the kitchen";
  heard.refusal = "I did not understand.";
  heard.suggests_meaning = true;
  heard.suggestion = "The pantry is on your left.";
  heard.alternatives = {"The pantry is next to the kitchen.", "The pantry is gone."};
  heard.rest = "I did not understand 'like'.";
  const std::string first = talk.dialogue.refuse(heard).text();
  EXPECT_TRUE(has(first, heard.rest) && has(first, heard.suggestion)) << first;
  const std::string second = talk.say("No.");
  EXPECT_TRUE(has(second, heard.alternatives[0])) << second;
  EXPECT_FALSE(has(second, heard.suggestion)) << second;
  talk.say("Yes.");
  EXPECT_EQ(talk.asked(), Question::Kind::kNone);
  EXPECT_EQ(talk.say("Is the pantry next to the kitchen?"), "Yes.");
  heard.alternatives.resize(1);
  talk.dialogue.refuse(heard);
  talk.say("No.");
  const std::string last = talk.say("No.");
  EXPECT_EQ(talk.asked(), Question::Kind::kNone) << last;
  EXPECT_FALSE(has(last, "Did you mean")) << last;
}

TEST(DialogueKnowledge, TheSpeakerIsKnown) {
  Talk talk;
  EXPECT_TRUE(has(talk.say("What is my name?"), "I do not know your name"));
  talk.say("This is the kitchen.");
  const std::string asked = talk.say("My office is next to the kitchen.");
  EXPECT_TRUE(has(asked, "?")) << asked;
  EXPECT_EQ(talk.asked(), Question::Kind::kSpeaker) << asked;
  const std::string reply = talk.say("I'm Lisa.");
  EXPECT_TRUE(has(reply, "Lisa's office is next to the kitchen")) << reply;
  EXPECT_EQ(talk.say("Who am I?"), "You are Lisa.");
}

TEST(DialogueKnowledge, TheLastStatementIsTakenBack) {
  Talk talk;
  talk.say("This is the kitchen.");
  talk.say("The pantry is next to the kitchen.");
  const std::string reply = talk.say("Undo that.");
  EXPECT_TRUE(has(reply, "pantry")) << reply;
  EXPECT_EQ(talk.say("Is the pantry next to the kitchen?"), "I do not know.");
}

TEST(DialogueKnowledge, WhatItCannotDoIsRefusedInWords) {
  Talk talk;
  EXPECT_TRUE(has(talk.say("Take this to the kitchen."), "I cannot carry anything"));
  EXPECT_TRUE(has(talk.say("Follow the corridor."), "I cannot follow"));
  EXPECT_TRUE(has(talk.say("Come here."), "Follow me"));
}

TEST(DialogueName, ItIsNamesThePlaceWhereTheRobotIs) {
  for (const char* said : {"It's the toilet.", "It is the toilet.", "That's the toilet.",
                           "We're now in the toilet.", "You are in the toilet."}) {
    Talk talk;
    EXPECT_EQ(talk.say(said), "Thank you. SS01 is the toilet.") << said;
    EXPECT_EQ(talk.names(1), Names{"toilet"}) << said;
    ASSERT_TRUE(talk.dialogue.description().robot_place) << said;
  }
}

// ---- Statements ----

TEST(DialogueStatement, IsReadBack) {
  Talk talk;
  talk.say("This is the kitchen.");
  const std::string reply = talk.say("The pantry is next to the kitchen.");
  EXPECT_TRUE(has(reply, "Noted: The pantry is next to the kitchen.")) << reply;
  EXPECT_TRUE(has(talk.say("The pantry is next to the kitchen."), "I knew that already."));
}

TEST(DialogueStatement, OwnersHaveTheKindThatWasSaidAndPlacesHaveNoOffice) {
  Talk talk;
  const std::string lab = talk.say("This lab belongs to Professor Lindqvist.");
  EXPECT_TRUE(has(lab, "Professor Lindqvist's lab")) << lab;
  talk.say("You are in the corridor.");
  const std::string chapel = talk.say("The chapel's ower there past the hall.");
  EXPECT_TRUE(has(chapel, "What of 'chapel's'?")) << chapel;
}

TEST(DialogueStatement, SidesAreToldFromThePlaceThatWasNamed) {
  Talk talk;
  talk.say("This is the kitchen.");
  const std::string reply = talk.say("In front of you is the pantry.");
  EXPECT_TRUE(has(reply, "Noted: ")) << reply;
  EXPECT_TRUE(talk.dialogue.description().robot_place.has_value());
}

TEST(DialogueStatement, PlacesThatSoundLikeNoneAreAskedAbout) {
  Talk talk;
  EXPECT_TRUE(has(talk.say("You are in Narnia."), "Shall I call this place 'Narnia'?"));
  EXPECT_TRUE(talk.names(1).empty());
  EXPECT_TRUE(talk.dialogue.description().places.empty());
}

// What is said beside "stop" follows the same rules as what is said without it.

TEST(DialogueStop, WordsLeftOutOfStatementsBesideItAreTold) {
  const std::string said = "The kitchen, which by the way has terrible coffee, is next to the lab.";
  const std::string told = "I have left out";
  Talk without, with;
  EXPECT_TRUE(has(without.say(said), told));
  const std::string reply = with.say("Stop! " + said);
  EXPECT_TRUE(has(reply, told)) << reply;
  EXPECT_TRUE(has(reply, "Noted: ")) << reply;
}

TEST(DialogueStop, WhatHangsOnAnUnknownNameBesideItWaitsForTheAnswer) {
  Talk talk;
  const std::string reply = talk.say("Stop! We're in the Blue Whale. On the left is the kitchen.");
  EXPECT_EQ(talk.asked(), Question::Kind::kNewName) << reply;
  EXPECT_TRUE(talk.dialogue.description().places.empty()) << reply;
  talk.say("Yes.");
  EXPECT_EQ(talk.dialogue.description().places.size(), 2u);
  Talk later;
  const std::string both = later.say("We're in the Blue Whale. Stop! On the left is the kitchen.");
  EXPECT_EQ(later.asked(), Question::Kind::kNewName) << both;
  EXPECT_TRUE(has(both, "not taken")) << both;
  EXPECT_TRUE(later.dialogue.description().places.empty()) << both;
}

TEST(DialogueStop, StatementsBesideItAreWhatItMeansNext) {
  Talk talk;
  talk.say("This is the kitchen.");
  talk.say("Stop! The lab is next to the kitchen.");
  talk.say("It is also called the workshop.");
  EXPECT_EQ(talk.names(1), Names{"kitchen"});
}

// ---- A name taken back ----

TEST(DialogueNames, WhatIsTakenBackInSeveralWordsIsTakenBackOnce) {
  Talk talk;
  talk.say("The kitchen is next to the library.");
  talk.say("The canteen is next to the lab.");
  const std::string reply = talk.say("Oh no, that was wrong. Forget what I just said.");
  EXPECT_TRUE(has(reply, "The canteen is next to the lab")) << reply;
  EXPECT_FALSE(has(reply, "kitchen")) << reply;
  EXPECT_TRUE(has(talk.say("Undo that."), "The kitchen is next to the library"));
  talk.say("The kitchen is next to the library.");
  talk.say("The canteen is next to the lab.");
  const std::string twice = talk.say("Undo that. Undo that.");
  EXPECT_TRUE(has(twice, "canteen") && has(twice, "kitchen")) << twice;
}

TEST(DialogueNames, UndoRightAfterTakesTheNameBack) {
  Talk talk;
  talk.say("This is the kitchen.");
  ASSERT_TRUE(talk.isConfirmed(1));
  EXPECT_TRUE(has(talk.say("Undo that."), "forgotten"));
  EXPECT_TRUE(talk.names(1).empty());
  EXPECT_TRUE(has(talk.say("Undo that."), "nothing was told"));
  talk.say("This is the kitchen.");
  EXPECT_TRUE(has(talk.say("This is the library."), "also known"));
  talk.say("Take that back.");
  EXPECT_EQ(talk.names(1), Names{"kitchen"}) << "only the open question is over";
  EXPECT_EQ(talk.asked(), Question::Kind::kNone);
  talk.say("Where are you?");
  talk.say("Undo that.");
  EXPECT_TRUE(talk.names(1).empty()) << "a question changes nothing that is known";
}

TEST(DialogueAnswers, WhatAnswersTheOpenQuestionIsUnderstood) {
  Talk talk;
  EXPECT_FALSE(talk.dialogue.notUnderstood("The snug").empty());
  talk.dialogue.askHere();
  ASSERT_EQ(talk.asked(), hyselam_topo::Question::Kind::kName);
  EXPECT_TRUE(talk.dialogue.notUnderstood("The snug").empty());
  EXPECT_FALSE(talk.dialogue.notUnderstood("The snug sees the the").empty());
  EXPECT_EQ(talk.asked(), hyselam_topo::Question::Kind::kName) << "nothing is done";
}

TEST(DialogueAnswers, AreGivenInManyWords) {
  for (const char* said :
       {"yeah that's the one", "It most certainly is.", "Course it is.", "that's correct"}) {
    Talk talk;
    talk.askAboutKitchen();
    talk.say(said);
    EXPECT_TRUE(talk.isConfirmed(1)) << said;
  }
  for (const char* said : {"Nope, try again.", "not quite", "Not any more.", "Haven't a clue.",
                           "Couldn't tell you.", "If you say so.", "Maybe."}) {
    Talk talk;
    talk.askAboutKitchen();
    talk.say(said);
    EXPECT_FALSE(talk.isConfirmed(1)) << said;
  }
}
