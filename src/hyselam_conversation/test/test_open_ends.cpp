// What an answer leaves open, and what ordinary people said then.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "example.hpp"
#include "hyselam_common/atomic_file.hpp"

using namespace hyselam_conversation;  // NOLINT: a test, not a header
using hyselam_topo::Question;

namespace {

using Names = std::vector<std::string>;

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

ConversationParams quick(bool arrive_at_once = true) {
  ConversationParams params;
  params.dialogue.match.time_limit = 0.1;
  params.arrive_at_once = arrive_at_once;
  return params;
}

struct Talk : ExampleTalk {
  explicit Talk(bool arrive_at_once = true) : ExampleTalk(quick(arrive_at_once)) {}
  std::string say(const std::string& text) { return talk.say(text).replyText(); }
  Names names(hyselam_topo::Id id) const { return namesOf(*talk.dialogue().map().findPlace(id)); }
  bool isConfirmed(hyselam_topo::Id id) const {
    return nameStateOf(*talk.dialogue().map().findPlace(id)) == hyselam_topo::NameState::kConfirmed;
  }
  Question::Kind asked() const { return talk.dialogue().question().kind; }
};

}  // namespace

TEST(OpenEnds, AnotherNameOfAPlaceIsOneOnTheMapToo) {
  for (const auto& [name, sentence, other, where, go] :
       {std::tuple("library", "The library is also called Atlantis.", "Atlantis",
                   "Where is Atlantis?", "Go to Atlantis."),
        std::tuple("secretaria", "A secretaria também se chama recepção.", "recepção",
                   "Onde fica a recepção?", "Vai à recepção."),
        std::tuple("library", "The library is also known as leitura.", "leitura",
                   "Onde fica a leitura?", "Go to the leitura.")}) {
    Talk t;
    t.talk.confirmNames("SS03", {name});
    t.say(sentence);
    EXPECT_EQ(t.names(3), (Names{name, other})) << sentence;
    EXPECT_TRUE(contains(t.say(where), "SS03")) << where;
    EXPECT_EQ(t.talk.say(go).goal, 3u) << go;
    t.say("Undo that.");
    EXPECT_EQ(t.names(3), Names{name}) << sentence;
  }
}

TEST(OpenEnds, ANameThatIsCorrectedIsCorrectedOnTheMapToo) {
  Talk t;
  t.say("On your left is the compuer room.");
  t.say("It's SS07.");
  ASSERT_EQ(t.names(7), Names{"compuer room"});
  t.say("Sorry, I meant computer room, not compuer room.");
  EXPECT_EQ(t.names(7), Names{"computer room"});
}

TEST(OpenEnds, ANameOfAnotherPlaceIsNoOtherNameWithoutAQuestion) {
  Talk t;
  t.talk.confirmNames("SS03", {"library"});
  t.talk.confirmNames("SS10", {"canteen"});
  const std::string reply = t.say("The library is also called canteen.");
  EXPECT_TRUE(contains(reply, "the library is SS03, and the canteen is SS10")) << reply;
  EXPECT_EQ(t.names(3), Names{"library"});
  EXPECT_EQ(t.names(10), Names{"canteen"});
}

TEST(OpenEnds, WhatIsCalledOtherwiseNowHasItsOldNameNoMore) {
  for (const auto& [sentence, said] :
       {std::pair("The library is now called archive.", "I do not call it library any more"),
        std::pair("A library agora chama-se archive.", "Já não lhe chamo library"),
        std::pair("A library chama-se agora archive.", "Já não lhe chamo library"),
        std::pair("A library agora se chama archive.", "Já não lhe chamo library"),
        std::pair("Rename the library to archive.", "I do not call it library any more")}) {
    Talk t;
    t.talk.confirmNames("SS03", {"library"});
    EXPECT_TRUE(contains(t.say(sentence), said)) << sentence;
    EXPECT_EQ(t.names(3), Names{"archive"}) << sentence;
    EXPECT_TRUE(contains(t.say("Where is the archive?"), "SS03")) << sentence;
    EXPECT_FALSE(contains(t.say("Where is the library?"), "SS03")) << sentence;
  }
}

TEST(OpenEnds, ANameThatWasOnlyToldIsRenamedWhereItIs) {
  Talk t;
  t.say("There is a library.");
  t.say("The library is now called archive.");
  const Names known = t.talk.dialogue().knownNames();
  EXPECT_EQ(known, Names{"archive"});
  for (const auto& place : t.talk.dialogue().map().places) {
    EXPECT_FALSE(t.isConfirmed(place.id)) << "a guess is confirmed by nobody";
  }
}

TEST(OpenEnds, ANewNameOfWhatNobodyToldOfIsToldWithTheOldOne) {
  for (const char* said :
       {"The library is now called archive.", "A library agora chama-se archive."}) {
    Talk t;
    t.say(said);
    EXPECT_EQ(t.talk.dialogue().knownNames(), (Names{"archive", "library"})) << said;
  }
}

TEST(OpenEnds, ThePlaceOfAnUnsureNameIsTold) {
  for (const char* answer :
       {"It's SS07.", "It is SS07.", "In SS07.", "SS07.", "It's number 7", "Place 7.", "in place 7",
        "It is the second one on the left, place 7.", "I think it is place 7.", "É o SS07.",
        "No SS07.", "No lugar 7.", "em SS07.", "É a primeira, SS07.", "É a primeira, o lugar 7.",
        "Acho que é o lugar 7.", "Fica no lugar 7."}) {
    Talk t;
    ASSERT_TRUE(contains(t.say("There is a kitchen."), "not sure where")) << answer;
    const std::string reply = t.say(answer);
    EXPECT_EQ(t.names(7), Names{"kitchen"}) << answer << ": " << reply;
    EXPECT_TRUE(t.isConfirmed(7)) << answer << ": " << reply;
  }
}

TEST(OpenEnds, WhereANameRatherIsIsToldOnce) {
  for (const auto& [here, sentence, told, other] :
       {std::tuple("You are in the corridor.", "The third door on the right is the gents.",
                   "I think the gents is SS03.", "The first door on the right is the kitchen."),
        std::tuple("Estás no corredor.", "A terceira porta à direita é a cozinha.",
                   "Acho que a cozinha é SS03.", "A primeira porta à direita é a biblioteca.")}) {
    Talk t;
    t.say(here);
    EXPECT_TRUE(contains(t.say(sentence), told)) << sentence;
    const std::string reply = t.say(other);
    EXPECT_TRUE(contains(reply, "SS01.")) << reply;
    EXPECT_FALSE(contains(reply, "SS03")) << reply;
  }
}

TEST(OpenEnds, WhereANameRatherIsIsToldWhenItIsSaidNext) {
  Talk t;
  t.say("You are in the corridor.");
  t.say("The third door on the right is the gents.");
  EXPECT_FALSE(contains(t.say("The gents is opposite the kitchen."), "gents is SS03"));
  // What came to a likely place while nothing was said of it is told with the next description.
  t.talk.setMap(exampleMap());
  EXPECT_FALSE(contains(t.say("The first door on the right is the library."), "gents is SS03"));
}

TEST(OpenEnds, WhereAPlaceIsIsAnsweredWhileAWayIsHalted) {
  Talk t(false);
  t.talk.confirmNames("SS10", {"reception"});
  t.say("Go to the reception.");
  t.say("Stop.");
  ASSERT_TRUE(contains(t.say("There is a kitchen."), "not sure where"));
  t.say("It's SS07.");
  EXPECT_EQ(t.names(7), Names{"kitchen"});
}

TEST(OpenEnds, WhatWasToldOfBothNamesOfAPlaceIsOfThatPlace) {
  Talk t;
  t.say("You are in the corridor.");
  t.say("The waiting room is opposite the front desk.");
  t.say("The front desk is 4 by 6 meters.");
  t.talk.standAt("SS01");
  t.say("This is the front desk room.");
  ASSERT_TRUE(contains(t.say("This is the front desk."), "Is it also known as front desk?"));
  t.say("Yes.");
  EXPECT_EQ(t.names(1), (Names{"front desk room", "front desk"}));
  for (const hyselam_topo::Place& place : t.talk.dialogue().map().places) {
    const Names names = namesOf(place);
    const bool is_here = std::find(names.begin(), names.end(), "front desk") != names.end();
    EXPECT_EQ(is_here, place.id == 1) << place.id;
  }
  EXPECT_EQ(t.names(12), Names{"waiting room"});
  const auto& described = t.talk.dialogue().description().places;
  const auto desk = std::find_if(described.begin(), described.end(),
                                 [](const auto& place) { return place.name == "front desk room"; });
  ASSERT_NE(desk, described.end());
  EXPECT_EQ(desk->length, 4.0);
  t.say("Undo that.");
  EXPECT_EQ(t.names(1), Names{"front desk room"});
}

TEST(OpenEnds, WhichOfTwoUnsureNamesIsMeantIsAsked) {
  Talk t;
  t.say("There is a kitchen and a library.");
  EXPECT_TRUE(contains(t.say("It's SS07."), "Is SS07 the kitchen?"));
  t.say("Yes.");
  EXPECT_EQ(t.names(7), Names{"kitchen"});
}

TEST(OpenEnds, AYesToAGuessIsAskedAboutAndSettlesIt) {
  for (const auto& [told, yes] : {std::pair("There is a canteen.", "Yes, that is right."),
                                  std::pair("Há uma cantina.", "Sim, é isso.")}) {
    Talk t;
    t.say(told);
    t.say(yes);
    ASSERT_EQ(t.asked(), Question::Kind::kConfirmName) << told;
    const hyselam_topo::Id place = t.talk.dialogue().question().place;
    t.say(yes);
    EXPECT_TRUE(t.isConfirmed(place)) << told;
  }
}

TEST(OpenEnds, AnAnswerToNothingIsNone) {
  Talk t;
  t.say("There is a kitchen.");
  t.say("Where are you?");
  t.say("SS07.");
  EXPECT_FALSE(t.isConfirmed(7)) << "something else was spoken of";
  Talk other;
  other.say("There is a kitchen.");
  other.say("The archive is on your left.");
  EXPECT_EQ(other.names(7) == Names{"archive"} && other.isConfirmed(7), false);
}

TEST(OpenEnds, ARobotThatIsToldToBeElsewhereAsksWhetherItIsLost) {
  for (const auto& [told, asks, yes] :
       {std::tuple("You are in the canteen.", "Am I in SS04?", "Yes."),
        std::tuple("Estás na canteen.", "Estou em SS04?", "Sim.")}) {
    for (const char* here : {"", "library"}) {
      Talk t;
      t.talk.confirmNames("SS04", {"canteen"});
      t.talk.standAt("SS12");
      if (*here != '\0') t.talk.confirmNames("SS12", {here});
      const std::string reply = t.say(told);
      EXPECT_TRUE(contains(reply, asks)) << reply;
      const Exchange there = t.talk.say(yes);
      EXPECT_EQ(there.place, 4u) << there.replyText();
      EXPECT_EQ(t.names(4), Names{"canteen"});
      EXPECT_EQ(t.names(12), *here == '\0' ? Names{} : Names{here});
    }
  }
}

TEST(OpenEnds, ARobotThatIsNotLostTakesTheNameForThatOfItsPlace) {
  Talk t;
  t.talk.confirmNames("SS04", {"canteen"});
  t.talk.confirmNames("SS12", {"library"});
  t.talk.standAt("SS12");
  t.say("You are in the canteen.");
  EXPECT_TRUE(contains(t.say("No."), "also known as canteen"));
  EXPECT_EQ(t.talk.dialogue().robot().place, 12u);
}

TEST(OpenEnds, WhatIsSaidBehindItIsToldOfWhereTheRobotIs) {
  Talk t;
  t.talk.confirmNames("SS04", {"canteen"});
  t.talk.standAt("SS12");
  t.say("You are in the canteen. On your left is the kitchen.");
  const std::string reply = t.say("Yes.");
  EXPECT_TRUE(contains(reply, "The kitchen is on the left of the canteen")) << reply;
}

TEST(OpenEnds, PlacesThatAreFarApartAreNotNextToEachOther) {
  for (const auto& [told, denied] :
       {std::pair("The canteen is next to the library.",
                  "the canteen is SS04 and the library is SS10, "),
        std::pair("A canteen fica ao lado da library.", "canteen é SS04 e ")}) {
    Talk t;
    t.talk.confirmNames("SS04", {"canteen"});
    t.talk.confirmNames("SS10", {"library"});
    const Exchange said = t.talk.say(told);
    EXPECT_TRUE(contains(said.replyText(), denied)) << said.replyText();
    EXPECT_EQ(said.refusals.size(), 1u);
    EXPECT_TRUE(t.talk.dialogue().description().relations.empty());
  }
  Talk t;
  t.talk.confirmNames("SS01", {"canteen"});
  t.talk.confirmNames("SS02", {"library"});
  EXPECT_TRUE(contains(t.say("The canteen is next to the library."), "Noted"));
  EXPECT_TRUE(contains(t.say("The kitchen is next to the library."), "Noted"));
}

TEST(OpenEnds, ConfirmedNamesAreNotUnsure) {
  Talk t;
  t.talk.confirmNames("SS04", {"canteen"});
  t.talk.confirmNames("SS10", {"library"});
  t.say("The kitchen is next to the library. The kitchen is next to the canteen.");
  EXPECT_EQ(t.talk.dialogue().unsure().names.count("canteen"), 0u);
  EXPECT_EQ(t.talk.dialogue().unsure().names.count("library"), 0u);
}

TEST(OpenEnds, ARobotThatWasStoppedGoesOnWhereItWasGoing) {
  for (const auto& [go, stop, on] : {std::tuple("Go to SS10.", "Stop.", "Carry on."),
                                     std::tuple("Go to SS10.", "Stop!", "Continue."),
                                     std::tuple("Vá para SS10.", "Pára aí!", "Continua."),
                                     std::tuple("Vá para SS10.", "Pare.", "Podes continuar.")}) {
    Talk t(false);
    ASSERT_EQ(t.talk.say(go).goal, 10u);
    ASSERT_TRUE(t.talk.say(stop).stopped);
    const Exchange again = t.talk.say(on);
    EXPECT_EQ(again.goal, 10u) << on << ": " << again.replyText();
    EXPECT_EQ(again.motion, Motion::kDriving);
  }
  Talk t(false);
  EXPECT_TRUE(contains(t.say("Carry on."), "not on my way"));
  t.say("Go to SS10.");
  t.say("Never mind.");
  EXPECT_FALSE(t.talk.say("Carry on.").goal.has_value()) << "that was called off";
}

TEST(OpenEnds, WhatGoesOnInARowIsNoThing) {
  for (const char* said :
       {"A primeira porta é a casa de banho e a seguir fica a sala dos professores.",
        "Do lado esquerdo do corredor, a primeira porta é a casa de banho e a seguir fica a sala "
        "dos professores.",
        "E a seguir está a cozinha.", "Logo a seguir está a cozinha."}) {
    Talk t;
    t.say(said);
    EXPECT_TRUE(t.talk.objects().objects.empty()) << said;
  }
}

TEST(OpenEnds, AnArticleOfOneLetterIsNoPartOfAName) {
  Talk t;
  t.talk.confirmNames("SS03", {"a cozinha"});
  t.talk.confirmNames("SS04", {"o laboratório"});
  EXPECT_TRUE(contains(t.say("Onde fica a cozinha?"), "SS03"));
  EXPECT_TRUE(contains(t.say("Onde fica o laboratório?"), "SS04"));
  const hyselam_topo::PlaceMan& places = t.talk.dialogue().places();
  EXPECT_TRUE(places.sameName("a cozinha", "cozinha"));
  EXPECT_FALSE(places.sameName("A wing", "wing"));
}

TEST(OpenEnds, ANameOfTheOtherLanguageHasTheArticleOfItsKind) {
  Talk t;
  t.talk.confirmNames("CC11", {"corridor"});
  const std::string reply = t.say("Ao fundo do corridor fica a enfermaria.");
  EXPECT_TRUE(contains(reply, "no fim do corridor")) << reply;
}

/// A refusal is one cause and one advice.
TEST(OpenEnds, ARefusalHasOneAdvice) {
  Talk t;
  for (const char* said : {"The kitchen is not there.", "A cozinha não é ali.",
                           "The flurb wozzles greenly.", "What is the weather like tomorrow?"}) {
    const std::string reply = t.say(said);
    const std::size_t first = std::min(reply.find("You can say: "), reply.find("Pode dizer: "));
    // The reason's own, or one of what was said.
    EXPECT_NE(first == std::string::npos,
              reply.find("; ") == std::string::npos || reply.find("; ") > first)
        << reply;
  }
}

TEST(OpenEnds, WhatCannotBeTakenIsNotProposed) {
  Talk t;
  t.talk.confirmNames("SS02", {"computer room"});
  const std::string reply =
      t.say("The science lab is after the computer room, on the same side of the corridor.");
  EXPECT_TRUE(contains(reply, "Noted: The science lab comes right after")) << reply;
  EXPECT_NE(t.asked(), Question::Kind::kProposal) << "no side was told before";
}

/// What can be said is told of names that are known here, those of the sentence first.
TEST(OpenEnds, AnAdviceIsOfKnownNames) {
  for (const auto& [name, said, advice] :
       {std::tuple("archive", "What is the weather like tomorrow?", "'Where is the archive?'"),
        std::tuple("storage room", "The storage room is never next to us, blorping.",
                   "storage room"),
        std::tuple("biblioteca", "Qual é o tempo amanhã?", "'Onde fica a biblioteca?'")}) {
    Talk t;
    t.talk.confirmNames("SS03", {name});
    const std::string reply = t.say(said);
    EXPECT_TRUE(contains(reply, advice)) << reply;
    EXPECT_FALSE(contains(reply, "kitchen") || contains(reply, "cozinha")) << reply;
  }
}

/// What is proposed is taken when it is said: of all texts that people have said in the batches.
TEST(OpenEnds, WhatIsProposedIsTaken) {
  std::size_t proposals = 0;
  for (const auto& file :
       std::filesystem::directory_iterator(HYSELAM_PACKAGE_DIR "/test/data/batches")) {
    if (file.path().extension() != ".json") continue;
    for (const auto& entry : nlohmann::json::parse(hyselam::readTextFile(file.path(), 1u << 24))) {
      const auto text = entry["text"].get<std::string>();
      ConversationParams params = quick();
      params.dialogue.match.time_limit = 0.02;
      ExampleTalk example(params);
      example.talk.say("You are in the corridor.");
      example.talk.say(text);
      if (example.talk.dialogue().question().kind != Question::Kind::kProposal) continue;
      ++proposals;
      const std::string proposed = example.talk.question();
      const Exchange taken = example.talk.say("Yes.");
      // Or it asks what only the person can tell: "Shall I call a place 'Narnia'?"
      const Question::Kind asks = example.talk.dialogue().question().kind;
      EXPECT_TRUE(taken.refusals.empty() || asks == Question::Kind::kNewName ||
                  asks == Question::Kind::kSpeaker)
          << text << "\n"
          << proposed << "\n"
          << taken.replyText();
    }
  }
  EXPECT_GE(proposals, 50u);
}

TEST(OpenEnds, ADenialBesideWhatIsSaidSpoilsNothing) {
  for (const char* said : {"We don't call it the library any more, it is the archive now.",
                           "We no longer call the library that, it is the archive.",
                           "Já não lhe chamamos library, agora é archive.",
                           "Já não se chama library, chama-se archive."}) {
    Talk t;
    t.talk.confirmNames("SS03", {"library"});
    const std::string reply = t.say(said);
    EXPECT_EQ(t.names(3), Names{"archive"}) << said << ": " << reply;
  }
  for (const auto& [name, said] :
       {std::pair("library", "The library is not needed, forget that name."),
        std::pair("library", "Forget the library, there is no such thing."),
        std::pair("library", "Forget the library, it does not exist."),
        std::pair("biblioteca", "Esquece a biblioteca, não há tal coisa.")}) {
    Talk t;
    t.talk.confirmNames("SS03", {name});
    const std::string reply = t.say(said);
    EXPECT_TRUE(t.names(3).empty()) << said << ": " << reply;
  }
}
