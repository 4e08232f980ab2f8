// Names: given to places by number, replaced, forgotten, taken back.
#include <gtest/gtest.h>

#include <algorithm>

#include "hyselam_topo/dialogue/shared_dialogue.hpp"
#include "talk.hpp"

namespace {

using Names = std::vector<std::string>;
using hyselam_topo::Question;

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// All that it may say of what it knows.
std::string allSaid(Talk* talk) {
  std::string all = talk->say("What have I told you?") + talk->say("Which places do you know?");
  for (const std::string& name : talk->dialogue.knownNames()) all += " " + name;
  return all;
}

const hyselam_topo::Place* firstGuessed(const Talk& talk) {
  const auto& places = talk.dialogue.map().places;
  const auto guessed = std::find_if(places.begin(), places.end(), [](const auto& place) {
    return hyselam_topo::nameStateOf(place) == hyselam_topo::NameState::kUnconfirmed;
  });
  return guessed == places.end() ? nullptr : &*guessed;
}

}  // namespace

TEST(DialogueNames, ANameThatIsTypedForAPlaceReplacesItsOldOne) {
  Talk talk;
  talk.dialogue.name(1, {"coridor"});
  talk.say("The pantry is next to the coridor.");
  ASSERT_TRUE(has(allSaid(&talk), "coridor"));
  const std::string reply = talk.dialogue.name(1, {"corridor"}).text();
  EXPECT_EQ(reply, "Thank you. SS01 is the corridor.");
  EXPECT_EQ(talk.names(1), Names{"corridor"});
  EXPECT_FALSE(has(allSaid(&talk), "coridor")) << allSaid(&talk);
  EXPECT_EQ(talk.say("Is the pantry next to the corridor?"), "Yes.");
  EXPECT_FALSE(has(talk.say("The attic is next to the pantry."), "coridor"));
}

TEST(DialogueNames, ANameThatIsTypedInPortugueseReplacesItsOldOne) {
  Talk talk;
  talk.say("Esta é a sala da Ana.");
  talk.dialogue.name(1, {"sala da Carla"});
  EXPECT_EQ(talk.names(1), Names{"sala da Carla"});
  EXPECT_FALSE(has(allSaid(&talk), "Ana"));
}

TEST(DialogueNames, AWrongGuessThatIsForgottenTellsNothingOfThePlace) {
  for (const bool spoken : {false, true}) {
    Talk talk;
    talk.say("The library is next to the kitchen.");
    const hyselam_topo::Place* guessed = firstGuessed(talk);
    ASSERT_NE(guessed, nullptr) << "nothing was guessed";
    const hyselam_topo::Id id = guessed->id;
    const std::string code = hyselam_topo::codeOf(*guessed), name = talk.names(id).front();
    const std::string reply =
        spoken ? talk.say("Forget the name of " + code + ".") : talk.dialogue.forget(id).text();
    EXPECT_TRUE(has(reply, "forgotten")) << reply;
    for (const auto& place : talk.dialogue.map().places) {
      EXPECT_NE(talk.names(place.id), Names{name}) << reply;
    }
    EXPECT_FALSE(has(allSaid(&talk), code + " is next to")) << allSaid(&talk);
  }
}

TEST(DialogueNames, ANameLikeANumberOfAnotherPlaceMisleadsNobody) {
  Talk talk;
  talk.dialogue.name(1, {"SS02"});
  const auto reply = talk.dialogue.hear("Go to SS02.");
  ASSERT_FALSE(reply.actions.empty()) << reply.text();
  ASSERT_FALSE(reply.actions.back().legs.empty()) << reply.text();
  EXPECT_EQ(reply.actions.back().legs.back().places.back(), 2u);
}

TEST(DialogueNames, ASentenceThatAddsANameAddsIt) {
  Talk talk;
  talk.say("This is the kitchen.");
  ASSERT_TRUE(has(talk.say("This is the canteen."), "also known"));
  talk.say("Yes.");
  EXPECT_EQ(talk.names(1), (Names{"kitchen", "canteen"}));
}

TEST(DialogueNames, APlaceOfTheMapIsNamedByItsNumber) {
  for (const char* sentence : {"SS02 is the library.", "SS02 is called the library.",
                               "SS02 é a biblioteca.", "O SS02 chama-se biblioteca."}) {
    Talk talk;
    const std::string reply = talk.say(sentence);
    ASSERT_EQ(talk.names(2).size(), 1u) << sentence << ": " << reply;
    EXPECT_TRUE(talk.isConfirmed(2)) << sentence;
    EXPECT_TRUE(has(reply, "SS02 is the library") || has(reply, "SS02 é a biblioteca")) << reply;
    EXPECT_FALSE(has(allSaid(&talk), "also known as library")) << allSaid(&talk);
  }
}

TEST(DialogueNames, APlaceOfTheMapIsNamedTheOtherWayRoundAfterAYes) {
  Talk talk;
  ASSERT_TRUE(has(talk.say("The library is SS02."), "?"));
  EXPECT_EQ(talk.say("Yes."), "Thank you. SS02 is the library.");
  EXPECT_TRUE(talk.isConfirmed(2));
}

TEST(DialogueNames, APlaceWithANameIsAskedForBeforeItsNumberGetsAnother) {
  Talk talk;
  talk.dialogue.name(2, {"kitchen"});
  const std::string reply = talk.say("SS02 is the library.");
  EXPECT_TRUE(has(reply, "Until now SS02 is the kitchen. Is it also known as library?")) << reply;
  EXPECT_EQ(talk.names(2), Names{"kitchen"});
  talk.say("Rename SS02 to library.");
  EXPECT_EQ(talk.names(2), Names{"library"});
}

TEST(DialogueNames, ManyChangesAreTakenBackOneByOne) {
  Talk talk;
  talk.say("This is the kitchen.");
  talk.dialogue.name(1, {"canteen"});
  talk.say("The pantry is next to the canteen.");
  talk.dialogue.forget(1);
  ASSERT_TRUE(talk.names(1).empty());
  EXPECT_FALSE(has(allSaid(&talk), "canteen"));

  EXPECT_EQ(talk.say("Undo that."), "So SS01 is the canteen again.");
  EXPECT_EQ(talk.names(1), Names{"canteen"});
  EXPECT_EQ(talk.say("Is the pantry next to the canteen?"), "Yes.");

  EXPECT_EQ(talk.say("Undo that."), "I have taken back: 'The pantry is next to the canteen'.");
  EXPECT_FALSE(has(allSaid(&talk), "pantry")) << allSaid(&talk);
  EXPECT_EQ(talk.names(1), Names{"canteen"});

  EXPECT_EQ(talk.say("Undo that."), "So SS01 is the kitchen again.");
  EXPECT_EQ(talk.names(1), Names{"kitchen"});
  EXPECT_FALSE(has(allSaid(&talk), "canteen"));

  EXPECT_EQ(talk.say("Undo that."), "I have forgotten the names of SS01.");
  EXPECT_TRUE(talk.names(1).empty());
  EXPECT_TRUE(has(talk.say("Undo that."), "nothing was told"));
}

TEST(DialogueNames, WhatIsTakenBackNextIsKnownBefore) {
  Talk talk;
  EXPECT_EQ(talk.dialogue.nextUndo(), "");
  talk.say("This is the kitchen.");
  EXPECT_EQ(talk.dialogue.nextUndo(), "kitchen");
  talk.dialogue.name(1, {"canteen"});
  EXPECT_EQ(talk.dialogue.nextUndo(), "canteen");
  talk.say("The pantry is next to the canteen.");
  EXPECT_EQ(talk.dialogue.nextUndo(), "The pantry is next to the canteen");
  talk.dialogue.forget(1);
  EXPECT_EQ(talk.dialogue.nextUndo(), "canteen");
  for (const char* next : {"The pantry is next to the canteen", "canteen", "kitchen", ""}) {
    talk.say("Undo that.");
    EXPECT_EQ(talk.dialogue.nextUndo(), next);
  }
}

TEST(DialogueNames, WhatWasSaidOfThingsIsAStepOnTheWayBack) {
  Talk talk;
  hyselam_topo::SharedDialogue shared(talk.dialogue);
  const auto told = [&](bool is_question) {
    hyselam_topo::OtherAnswer answer;
    answer.understood = true;
    answer.is_question = is_question;
    answer.reply = "Noted: a pen is in SS01.";
    hyselam_topo::ForwardedSentence sentence;
    sentence.text = "There is a pen";
    shared.answered(sentence, &answer);
  };
  told(false);
  EXPECT_TRUE(has(talk.say("Undo that."), "about things"));
  talk.say("This is the kitchen.");
  told(true);  // nothing was told yet
  EXPECT_EQ(talk.dialogue.nextUndo(), "kitchen");
  told(false);
  EXPECT_EQ(talk.dialogue.nextUndo(), "");
  const std::string reply = talk.say("Undo that.");
  EXPECT_TRUE(has(reply, "about things") && has(reply, "once more: kitchen")) << reply;
  EXPECT_EQ(talk.names(1), Names{"kitchen"});
  talk.say("Undo that.");
  EXPECT_TRUE(talk.names(1).empty());
  talk.say("This is the kitchen.");
  told(false);
  talk.say("Rename this place to canteen.");
  talk.say("Undo that.");
  EXPECT_EQ(talk.names(1), Names{"kitchen"}) << "the last change, behind the thing";
}

TEST(DialogueNames, ANameThatIsAGuessAgainIsNotForgotten) {
  Talk talk;
  talk.say("The library is next to the kitchen.");
  const hyselam_topo::Place* guessed = firstGuessed(talk);
  ASSERT_NE(guessed, nullptr) << "nothing was guessed";
  const hyselam_topo::Id id = guessed->id;
  const std::string code = hyselam_topo::codeOf(*guessed), name = talk.names(id).front();
  talk.dialogue.name(id, {name});
  EXPECT_EQ(talk.say("Undo that."), code + " is no longer confirmed as the " + name + ".");
  EXPECT_EQ(talk.names(id), Names{name});
}

TEST(DialogueNames, ACorrectionIsTakenBackToWhatWasSaidBefore) {
  Talk talk;
  talk.say("You are in the corridor. On your left you have the kitchen.");
  talk.say("No, the pantry.");
  talk.say("No, the canteen.");
  ASSERT_TRUE(has(allSaid(&talk), "canteen")) << allSaid(&talk);
  EXPECT_TRUE(has(talk.say("Undo that."), "I have taken back: 'the canteen'"));
  EXPECT_TRUE(has(allSaid(&talk), "pantry")) << allSaid(&talk);
  EXPECT_TRUE(has(talk.say("Undo that."), "I have taken back: 'the pantry'"));
  EXPECT_TRUE(has(allSaid(&talk), "kitchen")) << allSaid(&talk);
  EXPECT_TRUE(has(talk.say("Undo that."), "On your left you have the kitchen"));
  EXPECT_FALSE(has(allSaid(&talk), "kitchen")) << allSaid(&talk);
}

TEST(DialogueNames, ARenamingIsOneChange) {
  Talk talk;
  talk.say("This is the kitchen.");
  talk.say("The pantry is next to the kitchen.");
  talk.say("Rename this place to canteen.");
  ASSERT_EQ(talk.names(1), Names{"canteen"});
  EXPECT_TRUE(has(talk.say("Undo that."), "kitchen again"));
  EXPECT_EQ(talk.names(1), Names{"kitchen"});
  EXPECT_EQ(talk.say("Is the pantry next to the kitchen?"), "Yes.");
}

TEST(DialogueNames, AWallIsTakenBackAndComesBack) {
  Talk talk;
  hyselam_topo::DescribedWall wall;
  wall.line = {{1.0, 1.0}, {1.0, 2.0}};
  talk.say("The lab is next to the library.");
  talk.dialogue.addWall(wall);
  hyselam_topo::Reply undone = talk.dialogue.hear("Undo that.");
  EXPECT_EQ(undone.text(), "I have forgotten the glass wall.");
  EXPECT_TRUE(undone.has(hyselam_topo::DialogueAction::Kind::kWalls));
  EXPECT_TRUE(talk.dialogue.places().walls().empty());
  EXPECT_EQ(talk.say("Is the lab next to the library?"), "Yes.") << "only the wall";

  talk.dialogue.addWall(wall);
  talk.say("Forget the glass wall.");
  ASSERT_TRUE(talk.dialogue.places().walls().empty());
  EXPECT_EQ(talk.say("Undo that."), "I have added the glass wall.");
  ASSERT_EQ(talk.dialogue.places().walls().size(), 1u);
  EXPECT_EQ(talk.dialogue.places().walls().front(), wall);
}

TEST(DialogueNames, AVirtualPlaceIsTakenBackWithItsName) {
  Talk talk;
  talk.say("This is the kitchen.");
  talk.dialogue.addVirtualPlace({2.0, 1.5}, 0.5, {"kitchen"});
  talk.at(2.0);
  ASSERT_EQ(talk.dialogue.map().places.size(), 3u);
  ASSERT_NE(talk.dialogue.robot().place, 1u);
  const std::string reply = talk.say("Undo that.");
  EXPECT_TRUE(has(reply, "I have removed the virtual place VV03.")) << reply;
  EXPECT_EQ(talk.dialogue.map().places.size(), 2u);
  EXPECT_EQ(talk.names(1), Names{"kitchen"}) << "which had lost it";
  talk.at(2.0);
  EXPECT_EQ(talk.dialogue.robot().place, 1u);
}

TEST(DialogueNames, AKnownNameIsForgottenWithoutAnArticle) {
  Talk talk;
  talk.dialogue.name(1, {"Narnia"});
  talk.dialogue.name(2, {"coridor"});
  talk.say("forget narnia");
  EXPECT_TRUE(talk.names(1).empty());
  talk.say("forget coridor");
  EXPECT_TRUE(talk.names(2).empty());
  EXPECT_TRUE(has(talk.say("forget mordor"), "I did not understand"));
}

TEST(DialogueNames, ASlipInANameToForgetIsAskedAbout) {
  Talk talk;
  talk.dialogue.name(1, {"Narnia"});
  const std::string reply = talk.say("forget narnja");
  EXPECT_TRUE(has(reply, "Did you mean: 'forget \"Narnia\"'?")) << reply;
  EXPECT_EQ(talk.names(1), Names{"Narnia"});
  talk.say("Yes.");
  EXPECT_TRUE(talk.names(1).empty());
}

// ---- Articles ----

TEST(DialogueNames, KindsOfPlacesAreSaidWithTheirArticle) {
  Talk talk;
  EXPECT_EQ(talk.say("This is the kitchen."), "Thank you. SS01 is the kitchen.");
  talk.dialogue.name(2, {"toilets"});
  EXPECT_EQ(talk.say("Where are you?"), "I am at SS01, the kitchen.");
  EXPECT_EQ(talk.say("Where is the kitchen?"), "The kitchen is SS01. I am there.");
  EXPECT_EQ(talk.say("What is next to the kitchen?"), "Next to the kitchen: the toilets (SS02).");
  EXPECT_EQ(talk.say("Go to the toilets."), "I am going to the toilets (SS02).");
  for (const char* proper : {"Ana's office", "room 5", "I-109", "Main Hall", "cozinha"}) {
    talk.dialogue.name(2, {proper});
    EXPECT_EQ(talk.say("Go to SS02."), std::string("I am going to ") + proper + " (SS02).");
  }
}

TEST(DialogueNames, ArticlesOfPortugueseNamesGrowTogetherWithPrepositions) {
  Talk talk;
  EXPECT_EQ(talk.say("Isto é a cozinha."), "Obrigado. SS01 é a cozinha.");
  EXPECT_EQ(talk.say("Onde fica a cozinha?"), "A cozinha é SS01. Estou lá.");
  talk.dialogue.name(2, {"gabinete do Rui"});
  EXPECT_EQ(talk.say("O que fica ao lado da cozinha?"),
            "Ao lado da cozinha: o gabinete do Rui (SS02).");
  EXPECT_EQ(talk.say("O que fica em frente à cozinha?"),
            "Ninguém me disse o que fica em frente à cozinha.");
  EXPECT_EQ(talk.say("Vá para o gabinete do Rui."), "Vou para o gabinete do Rui (SS02).");
  talk.dialogue.name(2, {"receção"});
  EXPECT_EQ(talk.say("Vá para a receção."), "Vou para a receção (SS02).");
  talk.dialogue.name(2, {"kitchen"});
  EXPECT_EQ(talk.say("Vá para SS02."), "Vou para a kitchen (SS02).") << "of another language";
}

TEST(DialogueNames, AGuessIsToldInASentenceOfTheLanguage) {
  Talk talk;
  hyselam_topo::DialogueState state = talk.dialogue.state();
  state.places.map.findPlace(2)->words = {{"kitchen", false}};
  talk.dialogue.restore(std::move(state));
  EXPECT_TRUE(has(talk.say("Onde fica a cozinha?"), "Acho que a kitchen é SS02"));
  EXPECT_TRUE(has(talk.say("Where is the kitchen?"), "Perhaps the kitchen is SS02"));
}

TEST(DialogueNames, TheNumberOfPlacesAndTheirListAgree) {
  Talk talk;
  EXPECT_EQ(talk.say("How many rooms do you know?"), "I know 2 places: SS01 and SS02.");
  talk.dialogue.name(2, {"kitchen"});
  EXPECT_EQ(talk.say("How many rooms do you know?"),
            "I know 2 places, 1 of them by name: the kitchen (SS02).");
  EXPECT_EQ(talk.say("Que lugares conhece?"),
            "Conheço 2 lugares, 1 deles pelo nome: a kitchen (SS02).");
  talk.dialogue.name(1, {"library"});
  EXPECT_EQ(talk.say("How many rooms do you know?"),
            "I know 2 places: the library (SS01) and the kitchen (SS02).");
}

// ---- Names of two languages ----

TEST(DialogueNames, AKindOfPlaceIsFoundInTheOtherLanguage) {
  Talk talk;
  talk.dialogue.name(2, {"kitchen"});
  EXPECT_TRUE(has(talk.say("Vá para a cozinha."), "SS02"));
  EXPECT_TRUE(has(talk.say("Onde fica a cozinha?"), "SS02"));
  talk.say("A despensa fica ao lado da cozinha.");
  EXPECT_EQ(talk.say("Is the pantry next to the kitchen?"), "Yes.");
  talk.dialogue.name(1, {"casa de banho"});
  EXPECT_TRUE(has(talk.say("Where is the toilet?"), "SS01"));
  EXPECT_TRUE(has(talk.say("Where is the library?"), "I do not know the place library"));
}

TEST(DialogueNames, SeveralOfAKindInTheOtherLanguageAreAskedAbout) {
  Talk talk;
  talk.dialogue.name(1, {"toilet"});
  talk.dialogue.name(2, {"bathroom"});
  const hyselam_topo::Reply reply = talk.dialogue.hear("Vá para a casa de banho.");
  EXPECT_TRUE(has(reply.text(), "Pode ser")) << reply.text();
  EXPECT_FALSE(reply.has(hyselam_topo::DialogueAction::Kind::kGo));
  EXPECT_TRUE(has(talk.say("Go to the toilet."), "SS01"));
}

TEST(DialogueNames, ANameThatCameWithAStatementGoesWithIt) {
  Talk talk;
  talk.say("You are in the boiler room. The pantry is next to it.");
  ASSERT_EQ(talk.names(1), Names{"boiler room"});
  EXPECT_TRUE(has(talk.say("Undo that."), "The pantry is next to it"));
  EXPECT_EQ(talk.names(1), Names{"boiler room"});
  EXPECT_TRUE(has(talk.say("Undo that."), "You are in the boiler room"));
  EXPECT_TRUE(talk.names(1).empty());
}

TEST(DialogueNames, WhatWasForgottenAsAWholeComesBack) {
  Talk talk;
  talk.say("You are in the kitchen. The pantry is next to the kitchen.");
  talk.say("Forget all names.");
  talk.say("Yes.");
  ASSERT_TRUE(talk.dialogue.knownNames().empty());
  EXPECT_EQ(talk.say("Desfaz isso."), "Então SS01 volta a ser a kitchen.");
  EXPECT_EQ(talk.say("Is the pantry next to the kitchen?"), "Yes.");
}

TEST(DialogueNames, AForgottenNameIsGoneFromAllThatIsSaid) {
  for (const char* forget : {"Forget the name kitchen.", "Forget the kitchen.", ""}) {
    Talk talk;
    talk.say("You are in the kitchen. The pantry is next to the kitchen.");
    if (*forget == 0) {
      talk.dialogue.forget(1);
    } else {
      talk.say(forget);
    }
    EXPECT_TRUE(talk.names(1).empty()) << forget;
    EXPECT_FALSE(has(allSaid(&talk), "kitchen")) << forget << allSaid(&talk);
    EXPECT_FALSE(has(talk.say("The attic is next to the pantry."), "kitchen")) << forget;
  }
}

TEST(DialogueNames, NamesThatAreOnlyToldOrOnlyOnTheMapAreForgotten) {
  Talk talk;
  talk.say("The pantry is next to the library. The attic is next to the cellar.");
  EXPECT_FALSE(has(talk.say("Forget the name attic."), "do not know"));
  EXPECT_FALSE(has(allSaid(&talk), "attic"));
  talk.dialogue.name(2, {"gym"});
  EXPECT_EQ(talk.say("Forget the gym."), "I have forgotten the names of SS02.");
  EXPECT_FALSE(has(allSaid(&talk), "gym")) << allSaid(&talk);
  EXPECT_TRUE(has(talk.say("Forget the gym."), "was not told of"));
}

TEST(DialogueNames, ASentenceIsTriedWithoutEffect) {
  Talk talk;
  EXPECT_TRUE(talk.dialogue.notUnderstood("This is the kitchen. Where are you?").empty());
  EXPECT_TRUE(talk.dialogue.notUnderstood("Esta é a cozinha.").empty());
  EXPECT_EQ(talk.dialogue.notUnderstood("Where are you? Xyzzy plugh the wug.").size(), 1u);
  EXPECT_TRUE(talk.names(1).empty());
}

TEST(DialogueGo, APlaceThatIsNamedByItsNumberIsNotDoubted) {
  Talk talk;
  talk.say("The library is next to the lab.");
  const hyselam_topo::Reply reply = talk.dialogue.hear("Go to SS02.");
  EXPECT_TRUE(reply.has(hyselam_topo::DialogueAction::Kind::kGo)) << reply.text();
  EXPECT_EQ(reply.text(), "I am going to SS02.");
}

TEST(DialogueNames, AnotherNameThatWasToldBeforeIsOfThePlaceThatIsConfirmed) {
  for (const bool by_tap : {false, true}) {
    Talk talk;
    talk.say("The workshop is next to the kitchen.");
    talk.say("The workshop is also called the garage.");
    if (by_tap) {
      talk.dialogue.name(2, {"workshop"});
    } else {
      talk.say("SS02 is the workshop.");
    }
    EXPECT_EQ(talk.names(2), (Names{"workshop", "garage"})) << by_tap;
    const auto reply = talk.dialogue.hear("Go to the garage.");
    ASSERT_FALSE(reply.actions.empty()) << reply.text();
    ASSERT_FALSE(reply.actions.back().legs.empty()) << reply.text();
    EXPECT_EQ(reply.actions.back().legs.back().places.back(), 2u);
  }
  Talk talk;
  talk.say("A oficina fica ao lado da cozinha. A oficina também se chama garagem.");
  talk.say("O SS02 é a oficina.");
  EXPECT_TRUE(has(talk.say("Onde fica a garagem?"), "SS02"));
}

TEST(DialogueNames, AnotherNameThatAnotherPlaceHasStaysThere) {
  Talk talk;
  talk.say("The workshop is also called the garage.");
  talk.dialogue.name(1, {"garage"});
  talk.dialogue.name(2, {"workshop"});
  EXPECT_EQ(talk.names(2), Names{"workshop"});
  EXPECT_TRUE(has(talk.say("Where is the garage?"), "SS01"));
}

TEST(DialogueNames, WhatAPlaceIsNotIsTakenFromItAndWhatItIsInsteadIsItsName) {
  for (const char* sentence :
       {"No, that's wrong: SS02 is not the music room, it is the staff room.",
        "SS02 is not the music room but the staff room.",
        "SS02 is the staff room, not the music room."}) {
    for (const bool confirmed : {true, false}) {
      Talk talk;
      hyselam_topo::DialogueState state = talk.dialogue.state();
      state.places.map.findPlace(2)->words = {{"music room", confirmed}};
      talk.dialogue.restore(state);
      const std::string reply = talk.say(sentence);
      EXPECT_EQ(talk.names(2), Names{"staff room"}) << sentence << ": " << reply;
      EXPECT_TRUE(talk.isConfirmed(2)) << sentence;
      talk.say("Undo that.");
      EXPECT_EQ(talk.names(2), Names{"music room"}) << sentence;
    }
  }
  Talk talk;
  talk.dialogue.name(2, {"sala de música"});
  talk.say("Não, o SS02 não é a sala de música, é a sala dos professores.");
  EXPECT_EQ(talk.names(2), Names{"sala dos professores"});
}

TEST(DialogueNames, WhatAPlaceIsNotIsNoMoreItsName) {
  for (const char* sentence : {"SS02 is not the kitchen.", "O SS02 não é a cozinha."}) {
    Talk talk;
    talk.dialogue.name(2, {sentence[0] == 'S' ? "kitchen" : "cozinha"});
    const std::string reply = talk.say(sentence);
    EXPECT_TRUE(has(reply, "So SS02 is not") || has(reply, "Então SS02 não é")) << reply;
    EXPECT_TRUE(talk.names(2).empty()) << sentence;
  }
}

TEST(DialogueNames, AllGuessesAreConfirmedAtOnce) {
  for (const char* sentence :
       {"All the names on the map are right.", "The names are all correct.", "They are all right.",
        "Everything on the map is correct.", "Todos os nomes estão certos.",
        "Os nomes no mapa estão todos certos."}) {
    Talk talk;
    hyselam_topo::DialogueState state = talk.dialogue.state();
    state.places.map.findPlace(1)->words = {{"kitchen", false}};
    state.places.map.findPlace(2)->words = {{"library", false}};
    talk.dialogue.restore(state);
    const std::string reply = talk.say(sentence);
    EXPECT_TRUE(talk.isConfirmed(1) && talk.isConfirmed(2)) << sentence << ": " << reply;
    EXPECT_TRUE(has(reply, "kitchen") && has(reply, "library")) << reply;
    EXPECT_FALSE(has(talk.say(sentence), "kitchen")) << "nothing more to confirm";
    talk.say("Undo that.");
    EXPECT_FALSE(talk.isConfirmed(1) || talk.isConfirmed(2)) << sentence;
  }
}

TEST(DialogueNames, ANameThatIsTypedWithItsArticleIsSaidWithOne) {
  Talk talk;
  const std::string reply = talk.dialogue.name(1, {"the kitchen"}).text();
  EXPECT_TRUE(has(reply, "is the kitchen")) << reply;
  EXPECT_FALSE(has(reply, "the the")) << reply;
  EXPECT_EQ(talk.names(1), std::vector<std::string>{"kitchen"});
  talk.dialogue.name(1, {"A"});
  EXPECT_EQ(talk.names(1), std::vector<std::string>{"A"});
  talk.dialogue.useLanguage("pt");
  talk.dialogue.name(1, {"a cozinha"});
  EXPECT_EQ(talk.names(1), std::vector<std::string>{"cozinha"});
}
