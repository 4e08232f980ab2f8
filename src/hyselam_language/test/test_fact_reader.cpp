// The second reader: its models, what it reads, and what becomes of it.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <iostream>
#include <random>

#include "building/sentence_writer.hpp"
#include "grammar/compiled_grammar.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_language/grammar/topo_parser.hpp"
#include "hyselam_language/reader/fact_reader.hpp"
#include "reader/fact_writer.hpp"
#include "reader/linear_classifier.hpp"
#include "reader/reader_model.hpp"

namespace hyselam_topo {
namespace {

const TopoParser& parser() {
  static const TopoParser kParser;
  return kParser;
}

const FactReader& reader(const std::string& language) {
  static const FactReader kEnglish = FactReader::shipped(Grammar::shipped("en"));
  static const FactReader kPortuguese = FactReader::shipped(Grammar::shipped("pt"));
  return language == "en" ? kEnglish : kPortuguese;
}

/// "not next lab library".
std::vector<std::string> factsOf(const std::string& language, const std::string& text) {
  std::vector<std::string> facts;
  for (const ReadFact& fact : reader(language).read(text).facts) {
    std::string words =
        std::string(fact.denied ? "not " : "") + (fact.asked ? "ask " : "") + fact.relation;
    for (const FactArgument& each : fact.arguments) words += " | " + each.text;
    facts.push_back(words);
  }
  return facts;
}

using Facts = std::vector<std::string>;

TEST(LinearClassifier, GivesTheSharesOfLogisticValues) {
  language::LinearClassifier classifier({"a", "b"});
  classifier.setWeight("x", 0, 2.0f);
  classifier.setWeight("y", 1, -1.0f);
  const auto p = classifier.probabilities({"x", "y", "unknown"});
  const double a = 1.0 / (1.0 + std::exp(-2.0)), b = 1.0 / (1.0 + std::exp(1.0));
  EXPECT_NEAR(p[0], a / (a + b), 1e-6);
  EXPECT_NEAR(p[0] + p[1], 1.0, 1e-12);
}

TEST(LinearClassifier, ComesBackFromItsText) {
  std::mt19937 random(3);
  language::LinearClassifier classifier({"none", "next/*/*", "left/*"});
  for (int i = 0; i < 200; ++i) {
    const float weight = static_cast<float>(static_cast<int>(random() % 4000) - 2000) / 1000.0f;
    classifier.setWeight("f=" + std::to_string(random() % 50), random() % 3, weight);
  }
  const auto again = language::LinearClassifier::fromText("text", classifier.toText());
  EXPECT_EQ(again.toText(), classifier.toText());
  for (int i = 0; i < 50; ++i) {
    const language::Features features{"f=" + std::to_string(i),
                                      "f=" + std::to_string(random() % 50)};
    const auto p = classifier.probabilities(features), q = again.probabilities(features);
    for (std::size_t j = 0; j < p.size(); ++j) EXPECT_NEAR(p[j], q[j], 1e-5);
  }
}

TEST(ReaderModel, TellsWhatIsWrongWithAText) {
  const std::string good =
      language::ReaderModel::fromText(
          "good",
          "# made\n[lexicon]\nnoun lab\n[tagger]\nclasses O\n[of_one]\nclasses "
          "none\n[of_two]\nclasses "
          "none\n[of_text]\nclasses none\n[modifiers]\nclasses plain\n[calibration]\nreading 1 0 "
          "0\nfact 1 0 0\nother 1 0 0\n")
          .toText();
  const auto reason = [](const std::string& text) -> std::string {
    try {
      language::ReaderModel::fromText("model.txt", text);
    } catch (const hyselam::InputError& error) {
      return error.what();
    }
    return "";
  };
  const auto with = [&](const std::string& what, const std::string& by) {
    std::string text = good;
    return text.replace(text.find(what), what.size(), by);
  };
  EXPECT_EQ(reason(good), "");
  EXPECT_EQ(reason(""), "model.txt: [tagger]: is missing");
  EXPECT_EQ(reason("nonsense\n"), "model.txt: line 1: stands before the first section");
  EXPECT_EQ(reason(with("fact 1 0 0", "fact 1 x 0")),
            "model.txt: [calibration]: needs 'fact' and three numbers");
  EXPECT_EQ(reason(with("[of_two]\nclasses none", "[of_two]\nclasses none\nf 1:500")),
            "model.txt [of_two]: line 2: there is no class 1");
  EXPECT_EQ(reason(with("[of_two]\nclasses none", "[of_two]\nclasses none\nf 0:nan")),
            "model.txt [of_two]: line 2: '0:nan' is not CLASS:WEIGHT");
  EXPECT_EQ(reason(with("[tagger]\nclasses O", "[tagger]\nclasses B-thing")),
            "model.txt [tagger]: 'O': no such tag");
  EXPECT_EQ(reason(with("[tagger]\nclasses O", "[tagger]\nclasses O B")),
            "model.txt [tagger]: 'B': is no tag");
  EXPECT_EQ(reason(with("noun lab", "verb go")),
            "model.txt [lexicon]: 'verb go': is no kind of word");
}

/// Sentences of the tests' own; what a training yields may miss some of them.
TEST(FactReader, ReadsMostOfWhatItWasNotTrainedWith) {
  const std::vector<std::array<std::string, 3>> said{
      {"en", "well you see the spice store is right beside the tailor's workshop you know",
       "next | spice store | tailor's workshop"},
      {"en", "And on your left there'd be the harp room.", "left | harp room"},
      {"en", "The map room isn't opposite the vault anymore", "not opposite | map room | vault"},
      {"en", "You'll find the saddlery between the forge and the barn, I should say.",
       "between | saddlery | forge | barn"},
      {"en", "so right now you're standing in the tasting room", "at | tasting room"},
      {"en", "they say the ladder's behind the kiln", "behind | ladder | kiln"},
      {"en", "the silver spoons are lying on the sideboard as far as I can see",
       "on | silver spoons | sideboard"},
      {"en", "can you tell me where the brass lamp is?", "ask_where | brass lamp"},
      {"pt", "pois olhe, a sala das harpas fica mesmo ao lado do cofre, sabe",
       "next | sala das harpas | cofre"},
      {"pt", "agora estás na oficina do ferreiro", "at | oficina do ferreiro"},
      {"pt", "a estufa é lá no fim do corredor comprido", "end | estufa | corredor comprido"},
      {"pt", "as colheres de prata estão em cima do aparador",
       "on | colheres de prata | aparador"}};
  std::size_t right = 0;
  for (const auto& [language, text, fact] : said) {
    const bool is_right = factsOf(language, text) == Facts{fact};
    right += is_right ? 1 : 0;
    if (!is_right) std::cout << "misread: " << text << '\n';
  }
  EXPECT_GE(right, 8u);
}

TEST(FactReader, KeepsArticlesAndPlaces) {
  const std::string text = "na verdade a tipografia fica em frente do arquivo";
  const Reading reading = reader("pt").read(text);
  ASSERT_EQ(reading.facts.size(), 1u);
  ASSERT_EQ(reading.facts[0].arguments.size(), 2u);
  for (const FactArgument& each : reading.facts[0].arguments) {
    EXPECT_EQ(text.substr(each.range.begin, each.range.end - each.range.begin), each.text);
  }
  EXPECT_EQ(reading.facts[0].arguments[0].article, "a");
  EXPECT_EQ(reading.facts[0].arguments[1].article, "o");
  EXPECT_GT(reading.probability, 0.0);
  EXPECT_LT(reading.probability, 1.0);
}

TEST(FactReader, LivesWithAnyText) {
  std::mt19937 random(11);
  const std::string pieces[] = {"the kitchen",   "'s",    ",", ".",  "?",       " ",        "\n",
                                "\xe2\x80\x99s", "\xff",  "7", "\"", "left of", "\xc3\xa0", "não",
                                "next to",       "John's"};
  for (int round = 0; round < 300; ++round) {
    std::string text;
    for (std::size_t n = random() % 40; n > 0; --n)
      text += pieces[random() % std::size(pieces)] + (random() % 3 ? " " : "");
    for (const char* language : {"en", "pt"}) {
      const Reading reading = reader(language).read(text);
      EXPECT_TRUE(reading.probability >= 0.0 && reading.probability <= 1.0) << text;
    }
  }
  EXPECT_TRUE(reader("en").read(std::string(100000, 'x')).facts.empty());
  std::string many;
  for (int i = 0; i < 500; ++i) many += "the lab is next to the store and ";
  EXPECT_TRUE(reader("en").read(many).facts.empty());
  EXPECT_TRUE(reader("en").read("").facts.empty());
}

/// Each sentence that may be proposed, with names of all kinds, is one that the grammar takes.
TEST(FactWriter, WritesWhatTheGrammarUnderstands) {
  for (const char* language : {"en", "pt"}) {
    const Grammar grammar = Grammar::shipped(language);
    const bool en = std::strcmp(language, "en") == 0;
    const SentenceWriter writer(grammar);
    int tried = 0;
    for (const auto& [key, pattern] : grammar.compiled().say) {
      if (key.find("fact_") == std::string::npos) continue;
      ++tried;
      const bool measure =
          key.find("length") != std::string::npos || key.find("width") != std::string::npos;
      const bool person =
          key.find("speaker") != std::string::npos || key.find("where_works") != std::string::npos;
      const bool count = key.find("count") != std::string::npos ||
                         key.find("ask_exists") != std::string::npos ||
                         (en && key.find("not_fact_exists") != std::string::npos);
      std::vector<SaidValue> values;
      values.push_back(person  ? SaidValue{"1", "Anna", false, true}
                       : count ? SaidValue{"1", en ? "toilets" : "sala", en, true}
                               : writer.named("1", en ? "kitchen" : "cozinha"));
      values.push_back(
          measure ? SaidValue{"2", en ? "ten metres" : "dez metros", false, true}
          : key.find("nth") != std::string::npos
              ? SaidValue{"2", en ? "second" : "segunda", false, true}
          : key.find("area") != std::string::npos
              ? SaidValue{"2", en ? "20 square metres" : "20 metros quadrados", false, true}
          : key.find("owner_2") != std::string::npos
              ? SaidValue{"2", "Anna", false, true}
              : writer.named("2", en ? "library" : "biblioteca"));
      values.push_back(writer.named("3", en ? "archive" : "arquivo"));
      const std::string sentence = writer.sentence(key, values);
      ParseOptions options;
      options.language = language;
      EXPECT_EQ(parser().parse(sentence, options).misunderstood(), 0u) << key << ": " << sentence;
    }
    EXPECT_GT(tried, 60);
  }
}

TEST(SecondReading, ProposesWhatTheGrammarCannotRead) {
  const ParsedText parsed = parser().parse(
      "So the lab, that's gonna be just up there past the kitchen, opposite the print room, "
      "innit.");
  ASSERT_EQ(parsed.utterances.size(), 1u);
  EXPECT_TRUE(parsed.utterances[0].suggests_meaning);
  EXPECT_EQ(parser().parse(parsed.utterances[0].suggestion).misunderstood(), 0u);
}

TEST(SecondReading, NeverProposesWhatIsDoubted) {
  for (const char* text :
       {"Maybe the kitchen is on your left, innit.",
        "Perhaps the lab, that one is past the kitchen",
        "The kitchen's on the left or on the right, innit",
        "Se calhar a biblioteca é à direita, ou então à esquerda, já não sei bem."}) {
    for (const Utterance& each : parser().parse(text).utterances)
      EXPECT_FALSE(each.suggests_meaning) << text;
  }
}

/// What lies there is a thing that the parser of places knows nothing of; not the robot.
TEST(SecondReading, NeverTakesAThingsPlaceForTheRobots) {
  for (const char* text : {"A pasta azul é da dona Rute e está na tesouraria.",
                           "Betoneira já não está no armazém, foi para arranjar.",
                           "O carrinho é meu, e tá na lavandaria, encostado ao muro."}) {
    for (const Utterance& each : parser().parse(text).utterances) {
      EXPECT_NE(each.intent, "robot_in") << text;
    }
  }
}

TEST(SecondReading, LeavesOutTalkBesideTheMatter) {
  const ParsedText parsed =
      parser().parse("The exam hall is opposite the library, what a laugh that is.");
  ASSERT_EQ(parsed.utterances.size(), 1u);
  EXPECT_EQ(parsed.utterances[0].left_out, Facts{"what a laugh that is"});
  // What may be a fact stays refused.
  const ParsedText fact =
      parser().parse("The lab is next to the library. The zibbs grollt the vault.");
  EXPECT_EQ(fact.misunderstood(), 1u);
}

}  // namespace
}  // namespace hyselam_topo
