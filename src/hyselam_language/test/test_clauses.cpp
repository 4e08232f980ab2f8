// People put several things into one breath: clauses that deny, ask for discretion or tell of the
// past are told as left out, the others are read; never where a denial may reach further.
#include <gtest/gtest.h>

#include "hyselam_language/building/description_builder.hpp"
#include "shipped_parser.hpp"

namespace hyselam_topo {
namespace {

struct Heard {
  std::string clauses;   ///< "intent place,place side; ..." of what is taken or asked
  std::string left_out;  ///< "words; words"
  int refused = 0;
};

Heard hear(const std::string& text, const std::string& language) {
  ParseOptions options;
  options.language = language;
  Heard heard;
  const auto add = [](std::string* to, const std::string& what) {
    *to += (to->empty() ? "" : "; ") + what;
  };
  for (const Utterance& each : testing::shippedParser().parse(text, options).utterances) {
    for (const std::string& words : each.left_out) {
      if (each.understood()) add(&heard.left_out, words);
    }
    if (!each.understood()) {
      ++heard.refused;
      continue;
    }
    std::string clause = each.intent;
    for (const Slot& slot : each.slots) {
      for (const SaidName& name : slot.names) {
        clause += " " + (name.reference.empty() ? name.text : "<" + name.reference + ">");
      }
      if (!slot.word.empty()) clause += " " + slot.word;
    }
    add(&heard.clauses, clause);
  }
  return heard;
}

struct Said {
  std::string text, clauses, left_out;
  int refused = 0;
};

void expect(const std::vector<Said>& all, const std::string& language) {
  for (const Said& said : all) {
    const Heard heard = hear(said.text, language);
    EXPECT_EQ(heard.clauses, said.clauses) << said.text;
    EXPECT_EQ(heard.left_out, said.left_out) << said.text;
    EXPECT_EQ(heard.refused, said.refused) << said.text;
  }
}

TEST(Clauses, WhatDeniesNothingToldIsToldAsLeftOut) {
  expect(
      {{"the kitchen is on the left dont ask me why", "neighbours kitchen left", "dont ask me why"},
       {"the gents is third on your right dont go in there", "nth_neighbour gents 3 right",
        "dont go in there"},
       {"first door on the left is the boiler room nobody goes in there",
        "nth_neighbour 1 left boiler room", "nobody goes in there"},
       {"the lab is next to the bar and nobody is allowed in the archive", "next_to lab bar",
        "and nobody is allowed in the archive"},
       {"second on the left is the copy room its not locked", "nth_neighbour 2 left copy room",
        "its not locked"},
       {"the lab is opposite the bar i was never in there", "opposite lab bar",
        "i was never in there"},
       {"the archive is next to the library it was the kitchen before", "next_to archive library",
        "it was the kitchen before"},
       {"the lift is at the end of the corridor you cant miss it and the stairs are next to it",
        "at_end_of lift corridor; next_to stairs <it>", "you cant miss it"},
       {"the bar is on the right you will not get lost", "neighbours bar right",
        "you will not get lost"}},
      "en");
  expect({{"a sala de espera é a primeira à direita ninguém entra lá",
           "nth_neighbour sala de espera 1 right", "ninguém entra lá"},
          {"o arquivo fica à esquerda e ninguém pode entrar lá sem crachá",
           "neighbours arquivo left", "e ninguém pode entrar lá sem crachá"},
          {"o arquivo fica ao lado da biblioteca antes era a cozinha", "next_to arquivo biblioteca",
           "antes era a cozinha"},
          {"o laboratório é em frente à copa não digas a ninguém", "opposite laboratório copa",
           "não digas a ninguém"},
          {"a copa fica à esquerda não digas nada e o bar fica à direita",
           "neighbours copa left; neighbours bar right", "não digas nada"}},
         "pt");
}

TEST(Clauses, DeniedFactsWithoutApostrophesAndStops) {
  expect({{"this isnt the kitchen its the pantry", "this_is kitchen pantry", ""},
          {"this isnt a conference room but its the nursing room",
           "this_is conference room nursing room", ""},
          {"the lab isnt on the left its on the right", "located lab left right yes", ""}},
         "en");
  expect({{"isto já não é a cozinha agora é a despensa", "this_is cozinha despensa", ""},
          {"a sala um não fica à esquerda fica à direita",
           "located sala um left yes; neighbours right <it>", ""}},
         "pt");
}

TEST(Clauses, WhereADenialMayReachFurtherNothingIsTaken) {
  for (const char* const text :
       {"it's not the case that the kitchen is next to the library and the bar is on the left",
        "i dont think the kitchen is next to the library and the archive is next to the bar",
        "nobody says the kitchen is on the left and the bar is on the right",
        "nobody told me that the lab is on the left, and the bar is on the right",
        "we never said its next to the bar and the lab is on the left",
        "i do not know if the kitchen is on the left and the bar is on the right",
        "it is not true the lab is opposite the bar and the kitchen is on the left",
        "the kitchen is next to the bar i am not sure", "the lab is on the left, i do not know",
        "the lab is on the left i would not swear to it",
        "nobody thinks the kitchen is on the left and the bar is on the right",
        "nobody believes that the kitchen is on the left and the bar is on the right",
        "nobody reckons the lab is on the left, and the bar is on the right",
        "nobody has confirmed the kitchen is on the left and the bar is on the right",
        "nobody ever mentioned the kitchen is on the left and the bar is on the right"}) {
    EXPECT_EQ(hear(text, "en").clauses, "") << text;
    EXPECT_GT(hear(text, "en").refused, 0) << text;
  }
  for (const char* const text :
       {"não acho que a cozinha fique à esquerda e o arquivo fica à direita",
        "ninguém disse que a cozinha fica à esquerda e o bar fica à direita",
        "A copa fica ao lado do arquivo, não tenho a certeza.",
        "ninguém acha que a cozinha fica à esquerda e o bar fica à direita",
        "ninguém acredita que a cozinha fica à esquerda e o bar fica à direita",
        "ninguém confirma que a cozinha fica à esquerda e o bar fica à direita"}) {
    EXPECT_EQ(hear(text, "pt").clauses, "") << text;
    EXPECT_GT(hear(text, "pt").refused, 0) << text;
  }
}

TEST(Clauses, BehindOtherWordsNoClauseBegins) {
  for (const char* const text :
       {"Doris reckons there's a bar behind the kitchen", "my boss claims its next to the bar",
        "the lab where you get coffee its on the left"}) {
    EXPECT_EQ(hear(text, "en").clauses, "") << text;
  }
  for (const char* const text :
       {"A impressora está na sala de reuniões", "o chefe da Zé fica à esquerda"}) {
    EXPECT_EQ(hear(text, "pt").clauses, "") << text;
  }
}

TEST(Clauses, ItIsNotWhatWasLeftOut) {
  const Heard heard =
      hear("the kitchen is on the left nobody is allowed in the library its next to the bar", "en");
  EXPECT_EQ(heard.clauses, "");
}

std::vector<std::string> described(const std::string& text, const std::string& language,
                                   std::string* problems) {
  ParseOptions options;
  options.language = language;
  DescriptionBuilder builder(testing::shippedParser());
  for (const DescriptionIssue& issue : builder.add(testing::shippedParser().parse(text, options))) {
    *problems += issue.reason + "; ";
  }
  std::vector<std::string> all;
  const DescribedBuilding& building = builder.building();
  for (const DescribedConnection& each : building.connections) {
    if (each.side == Side::kUnknown) continue;
    all.push_back(std::string(toString(each.side)) + " " + building.findPlace(each.to)->name + " " +
                  std::to_string(each.rank.value_or(0)));
  }
  for (const DescribedRelation& each : building.relations) {
    all.push_back(std::string(toString(each.kind)) + " " + building.findPlace(each.a)->name + " " +
                  building.findPlace(each.b)->name);
  }
  return all;
}

void expectDescribed(const std::string& text, const std::string& language,
                     const std::vector<std::string>& wanted) {
  std::string problems;
  EXPECT_EQ(described(text, language, &problems), wanted) << text << " " << problems;
}

TEST(References, HersIsThePlaceOfWhoWasNamedLast) {
  expectDescribed(
      "You are in the corridor. The office on the left is Anna's and the kitchen is "
      "next to hers.",
      "en", {"left Anna's office 0", "next_to kitchen Anna's office"});
  std::string problems;
  described("You are in the corridor. The bar is on the left. The kitchen is opposite her.", "en",
            &problems);
  EXPECT_NE(problems.find("her"), std::string::npos) << "nobody was named";
}

TEST(References, TwoPlacesNamedTogether) {
  expect({{"Those two are joined by a door.", "joined <two>", ""}}, "en");
}

TEST(Positions, NumbersAndEndsInOtherWords) {
  const std::string en = "You are in the corridor. ", pt = "Estás no corredor. ";
  expectDescribed(en + "the lab is number five on the left", "en", {"left lab 5"});
  expectDescribed(en + "The dry store is at left, number five.", "en", {"left dry store 5"});
  expectDescribed(en + "the pantry is the second to last door on the left", "en",
                  {"left pantry -2"});
  expectDescribed(en + "The archive is the end room on the left.", "en", {"left archive -1"});
  expectDescribed(en + "the archive is the last but two on the right", "en", {"right archive -3"});
  expectDescribed(en + "kitchen is third on the right, archive fourth, lab fifth", "en",
                  {"right kitchen 3", "right archive 4", "right lab 5"});
  expectDescribed(pt + "o laboratório é o número cinco à esquerda", "pt", {"left laboratório 5"});
  expectDescribed(pt + "a despensa é a porta número três à direita", "pt", {"right despensa 3"});
  expectDescribed(pt + "o arquivo é a sala do fundo à direita", "pt", {"right arquivo -1"});
  expectDescribed(pt + "cozinha primeira porta à esquerda", "pt", {"left cozinha 1"});
  expectDescribed(pt + "a cozinha é a primeira à esquerda, o bar a segunda e o arquivo a terceira",
                  "pt", {"left cozinha 1", "left bar 2", "left arquivo 3"});
}

TEST(Positions, WhatIsOnlyAlmostSoIsRefused) {
  for (const char* const text :
       {"the kitchen is almost at the end on the left", "the lab is nearly opposite the bar",
        "the lab is three doors past the kitchen", "the bar is two doors before the kitchen"}) {
    EXPECT_EQ(hear(text, "en").clauses, "") << text;
  }
  for (const char* const text : {"a copa fica quase no fim do corredor",
                                 "o laboratório fica três portas depois da cozinha"}) {
    EXPECT_EQ(hear(text, "pt").clauses, "") << text;
  }
}

TEST(Positions, ThreeDoorsPastIsNotProposedAsRightAfter) {
  ParseOptions options;
  options.language = "en";
  const ParsedText parsed =
      testing::shippedParser().parse("The lab is three doors past the kitchen.", options);
  ASSERT_EQ(parsed.utterances.size(), 1u);
  EXPECT_FALSE(parsed.utterances.front().suggests_meaning);
}

}  // namespace
}  // namespace hyselam_topo
