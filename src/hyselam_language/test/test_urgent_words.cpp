// Stop and cancel, found in whatever is said.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "hyselam_common/errors.hpp"
#include "hyselam_language/grammar/topo_parser.hpp"
#include "hyselam_language/grammar/urgent_words.hpp"

using hyselam_topo::findUrgentWords;
using hyselam_topo::TopoParser;
using hyselam_topo::Urgency;
using hyselam_topo::UrgentWords;

namespace {

const TopoParser& parser() {
  static const TopoParser kParser;
  return kParser;
}

UrgentWords find(const std::string& text) {
  return findUrgentWords(text, parser().grammars());
}

void expectAll(Urgency urgency, const std::vector<std::string>& texts) {
  for (const std::string& text : texts) {
    EXPECT_STREQ(toString(find(text).urgency), toString(urgency)) << text;
  }
}

}  // namespace

TEST(UrgentWords, StopIsFoundHoweverItIsSaid) {
  expectAll(Urgency::kStop, {"stop",
                             "Stop!",
                             "STOP",
                             "stop stop stop",
                             "Stop, stop!",
                             "STOOOOP",
                             "stoooppp",
                             "stop it",
                             "hey robot wait no stop please",
                             "oh my god stop",
                             "s t o p",
                             "S.T.O.P.",
                             "stop-stop",
                             "stopstop",
                             "no no stop",
                             "please stop right now",
                             "stop \xf0\x9f\x99\x8f",
                             "\xf0\x9f\x9b\x91",
                             "go to the kitchen no stop",
                             "the kitchen stop is on the left",
                             "halt",
                             "HAAALT",
                             "freeze",
                             "don't move",
                             "stand still",
                             "whoa",
                             "wait",
                             "hold on",
                             "wait wait the box",
                             "enough",
                             "i said stop",
                             "stop\xff\xfe",
                             "\"stop\"",
                             "Don't, stop!",
                             "don't stop stop",
                             "what are you doing stop"});
}

TEST(UrgentWords, StopIsFoundInPortugueseOfBothShores) {
  expectAll(Urgency::kStop, {"para",
                             "Pára!",
                             "PÁRA",
                             "pare",
                             "Pare!",
                             "parar já",
                             "para já",
                             "para aí",
                             "paraaaa",
                             "para para para",
                             "para, por favor",
                             "robô para",
                             "pare agora mesmo",
                             "alto",
                             "alto lá",
                             "espera aí",
                             "peraí",
                             "espera",
                             "chega",
                             "já chega",
                             "basta",
                             "não te mexas",
                             "fica quieto",
                             "quieto",
                             "calma",
                             "eu disse para",
                             "ei robô para de andar",
                             "vai à cozinha não para",
                             "pode parar",
                             "para com isso",
                             "não, para!"});
}

TEST(UrgentWords, OneSlipOfALetterIsForgiven) {
  expectAll(Urgency::kStop, {"stpo", "sotp", "robot stpo please", "stpp", "stopp",
                             "go back no stpo", "hatl", "fereze"});
  expectAll(Urgency::kCancel, {"cancle", "cancl that", "robot cancell please", "cancla"});
  expectAll(Urgency::kNone, {"the stoop is on your left", "this is the soap room", "the top floor",
                             "the shop is on the right", "half the hall", "cancer ward"});
}

TEST(UrgentWords, CancelIsFound) {
  expectAll(
      Urgency::kCancel,
      {"cancel",       "Cancel that.",    "never mind",      "nevermind",     "abort",
       "forget it",    "oh forget it",    "forget about it", "cancel cancel", "i changed my mind",
       "cancela",      "cancela isso",    "deixa lá",        "deixa pra lá",  "esquece",
       "esqueça isso", "esquece lá isso", "anula",           "aborta",        "não importa",
       "CANCELAAA"});
  expectAll(Urgency::kStop, {"cancel and stop", "stop cancel"});
}

TEST(UrgentWords, WhatOnlyLooksLikeItIsNone) {
  expectAll(Urgency::kNone, {"",
                             "...",
                             "The bus stop is next to the entrance.",
                             "there is a stop sign on your left",
                             "don't stop",
                             "do not stop now",
                             "never stop",
                             "non-stop",
                             "the doorstop",
                             "the door stop",
                             "the last stop",
                             "vai para a cozinha",
                             "a porta para o corredor",
                             "Vai para ali.",
                             "leva isto para a sala",
                             "não pares",
                             "sem parar",
                             "para a direita",
                             "no wait, on the right",
                             "the waiting room is on the left",
                             "a sala de espera fica à esquerda",
                             "esquece a cozinha",
                             "forget the kitchen",
                             "Go to the kitchen and stop there.",
                             "Go to the kitchen and wait there.",
                             "This is \"Stop\".",
                             "o para-raios",
                             "um armário alto",
                             "a paragem de autocarro",
                             "como se chega à cozinha",
                             "como chega à sala 5",
                             "yes",
                             "no",
                             "no, no",
                             "não",
                             "forget everything"});
}

TEST(UrgentWords, TheRestIsKeptWithItsSide) {
  auto words = find("stop and go to the kitchen");
  ASSERT_EQ(words.rest.size(), 1u);
  EXPECT_EQ(words.rest[0].text, "and go to the kitchen");
  EXPECT_TRUE(words.rest[0].after);
  words = find("go to the kitchen no stop please");
  ASSERT_EQ(words.rest.size(), 1u);
  EXPECT_EQ(words.rest[0].text, "go to the kitchen no");
  EXPECT_FALSE(words.rest[0].after);
  EXPECT_TRUE(find("hey robot wait no stop please").rest.empty());
  EXPECT_TRUE(find("Stop! Stop!! STOP!!!").rest.empty());
}

TEST(UrgentWords, TheLanguageIsThatOfTheWord) {
  EXPECT_EQ(find("halt").languages, std::vector<std::string>{"en"});
  EXPECT_EQ(find("pare").languages, std::vector<std::string>{"pt"});
  EXPECT_EQ(find("stop").languages, (std::vector<std::string>{"en", "pt"}));
  EXPECT_EQ(find("stop por favor pare").languages, std::vector<std::string>{"pt"});
}

TEST(UrgentWords, LongTextsTakeNoLongerThanTheirLength) {
  std::string text;
  for (int i = 0; i < 20000; ++i) text += "para a ";
  EXPECT_EQ(find(text).urgency, Urgency::kNone);
  for (int i = 0; i < 20000; ++i) text += "para ";
  EXPECT_EQ(find(text).urgency, Urgency::kStop);
}

TEST(UrgentWords, AGrammarWithAnUnknownKeyIsRefused) {
  auto source = hyselam_topo::Grammar::shippedSource("en");
  const std::string more = "format: hyselam_grammar\nversion: 1\nlanguage: en\nurgent: {";
  EXPECT_THROW(hyselam_topo::Grammar::fromYaml({source, {"more", more + "go: [go]}"}}),
               hyselam::InputError);
  EXPECT_THROW(hyselam_topo::Grammar::fromYaml({source, {"more", more + "stop: [\"(go\"]}"}}),
               hyselam::InputError);
  EXPECT_THROW(hyselam_topo::Grammar::fromYaml({source, {"more", more + "stop: [\"...\"]}"}}),
               hyselam::InputError);
  const auto grammar =
      hyselam_topo::Grammar::fromYaml({source, {"more", more + "stop: [\"(oi|hoo) there\"]}"}});
  EXPECT_EQ(findUrgentWords("hoo there", {grammar}).urgency, Urgency::kStop);
}
