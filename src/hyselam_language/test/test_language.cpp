// Grammars, the engine, names, the builder and the way back to text.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "grammar/compiled_grammar.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/testing/files.hpp"
#include "hyselam_language/building/describe_building.hpp"
#include "hyselam_language/building/describe_change.hpp"
#include "hyselam_language/building/description_builder.hpp"
#include "hyselam_language/building/description_xml.hpp"
#include "hyselam_language/grammar/words_left_out.hpp"
#include "hyselam_language/testing/language_outlines.hpp"
#include "random_buildings.hpp"
#ifdef HYSELAM_HAVE_RAPIDCHECK
#include "hyselam_common/testing/properties.hpp"
#endif

namespace hyselam_topo {
namespace {

using hyselam::testing::messageOf;

const TopoParser& parser() {
  static const TopoParser kParser;
  return kParser;
}

void expectParts(const std::string& message, const std::vector<std::string>& parts) {
  for (const std::string& part : parts) {
    EXPECT_NE(message.find(part), std::string::npos) << "'" << part << "' is not in: " << message;
  }
}

constexpr char kSmall[] =
    "format: hyselam_grammar\nversion: 1\nlanguage: xx\n"
    "names: {thing: {definite: [the], stop: [is, here]}}\n"
    "reasons: {why: because}\n"
    "classes: {colour: {red: [red, crimson], blue: [blue]}}\n"
    "macros: {be: [is, seems]}\n"
    "units: {weight: {1: [kg], 0.001: [g]}}\n"
    "intents: {tell: {kind: statement, patterns: ['{what:thing} <be> {colour:colour}', "
    "'{what:thing} weighs {weight:weight}']}}\n";

/// Of the small grammar and a further file of its language.
TopoParser smallParserWith(const std::string& more) {
  return TopoParser({Grammar::fromYaml(
      {{"g.yaml", kSmall},
       {"more.yaml", "format: hyselam_grammar\nversion: 1\nlanguage: xx\n" + more}})});
}

std::string errorWith(const std::string& from, const std::string& to) {
  std::string text = kSmall;
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  text.replace(at, from.size(), to);
  return messageOf<hyselam::InputError>([&] { Grammar::fromYaml({{"g.yaml", text}}); });
}

TEST(WordsLeftOut, AreThoseThatTellSomething) {
  const auto left = [](const std::string& language, const std::string& said,
                       const std::string& proposed) {
    for (const Grammar& grammar : parser().grammars()) {
      if (grammar.language() == language) return wordsLeftOut(said, proposed, grammar);
    }
    ADD_FAILURE() << language;
    return std::vector<std::string>{};
  };
  using Runs = std::vector<std::string>;
  EXPECT_EQ(left("en", "The broom's in the Kitchen, behind Anna's fridge.",
                 "The broom is in the kitchen."),
            Runs{"behind Anna's fridge"});
  EXPECT_EQ(
      left("en", "The mop by the 3 sinks is next to the stove.", "The mop is next to the stove."),
      Runs{"by the 3 sinks"});
  EXPECT_EQ(left("en", "The mop is by the stove.", "The mop is next to the stove."), Runs{});
  EXPECT_EQ(left("en", "So, the mop is here.", "The mop is here."), Runs{});
  EXPECT_EQ(left("en", "The mop is here.", ""), Runs{"The mop is here"});
  EXPECT_EQ(left("en", "The attic is on the left.", "The attic is here."), Runs{"on the left"});
  EXPECT_EQ(left("en", "", "The mop is here."), Runs{});
  EXPECT_EQ(left("pt", "A vassoura da Rita está na cozinha, atrás do fogão velho.",
                 "A vassoura está na cozinha."),
            (Runs{"da Rita", "atrás do fogão velho"}));
}

TEST(Grammar, AnyLanguageMayBeGiven) {
  const TopoParser small({Grammar::fromYaml({{"g.yaml", kSmall}})});
  const auto said = small.parse("The ball is crimson. The cup weighs 300 g.").utterances;
  ASSERT_EQ(said.size(), 2u);
  EXPECT_EQ(testing::outline(said[0]), "tell colour=red what=ball");
  EXPECT_EQ(testing::outline(said[1]), "tell weight=0.3 what=cup");
}

TEST(TopoParser, AsidesAreLeftOutAndSaid) {
  const auto said =
      parser().parse("The kitchen, which by the way has terrible coffee, is next to the lab.");
  ASSERT_EQ(said.utterances.size(), 1u);
  EXPECT_EQ(testing::outline(said.utterances[0]), "next_to a=kitchen b=lab");
  EXPECT_EQ(said.utterances[0].left_out,
            std::vector<std::string>{"which by the way has terrible coffee"});
  // What tells something is no aside.
  EXPECT_EQ(parser().parse("The kitchen, which is never left, is next to the lab.").misunderstood(),
            1u);
}

TEST(TopoParser, WhatIsClearIsUnderstoodAndTheRestTold) {
  const auto said = parser()
                        .parse(
                            "The kitchen is next to the lab, and the archive hums in the door, "
                            "and the lift is opposite the stairs.")
                        .utterances;
  ASSERT_EQ(said.size(), 3u);
  EXPECT_EQ(testing::outline(said[0]), "next_to a=kitchen b=lab");
  EXPECT_FALSE(said[1].understood());
  EXPECT_EQ(said[1].text, "and the archive hums in the door");
  EXPECT_FALSE(said[1].suggestion.empty());
  EXPECT_EQ(testing::outline(said[2]), "opposite a=lift b=stairs");
  // What may change the rest is not taken apart from it.
  for (const char* text :
       {"The kitchen is next to the lab, or the archive hums.",
        "The kitchen is next to the lab, if the archive hums in the door.",
        "The kitchen is next to the lab, no wait, the archive hums in the door."}) {
    const auto all = parser().parse(text).utterances;
    EXPECT_TRUE(std::none_of(all.begin(), all.end(), [](const Utterance& u) {
      return u.understood();
    })) << text;
  }
}

TEST(TopoParser, TagsThatDoNotAskLeaveAStatement) {
  const auto outlineOf = [](const std::string& text) {
    return testing::outline(parser().parse(text).utterances.at(0));
  };
  EXPECT_EQ(outlineOf("The kitchen is next to the lab, ok?"), "next_to a=kitchen b=lab");
  EXPECT_EQ(outlineOf("Can you note that the kitchen is next to the lab?"),
            "next_to a=kitchen b=lab");
  EXPECT_EQ(outlineOf("A copa fica ao lado da cozinha, viu?"), "next_to a=copa b=cozinha");
  // These ask.
  for (const char* text :
       {"The kitchen is next to the lab?", "The kitchen is next to the lab, isn't it?",
        "A copa fica ao lado da cozinha, não é?"}) {
    const Utterance said = parser().parse(text).utterances.at(0);
    EXPECT_NE(said.kind, UtteranceKind::kStatement) << text;
  }
}

TEST(TopoParser, ClausesMayRunOnAsRecognisersWriteThem) {
  const auto said =
      parser().parse("you are in the corridor on your left is the kitchen").utterances;
  ASSERT_EQ(said.size(), 2u);
  EXPECT_EQ(testing::outline(said[0]), "robot_in place=corridor");
  EXPECT_EQ(testing::outline(said[1]), "neighbours places=kitchen side=left");
}

TEST(TopoParser, ProposesWhatWasSaidWithoutTheWordsInTheWay) {
  const auto proposed = [](const std::string& text) {
    const Utterance said = parser().parse(text).utterances.at(0);
    EXPECT_FALSE(said.understood()) << text;
    return said.suggests_meaning ? said.suggestion : "";
  };
  EXPECT_EQ(proposed("The kitchen is cosily tucked next to the lab."),
            "The kitchen is next to the lab.");
  // Denial, doubt, sides and numbers are never left out, nor half a name.
  EXPECT_EQ(proposed("The kitchen is hardly never next to the lab."), "");
  EXPECT_EQ(proposed("The kitchen may hum next to the lab."), "");
}

TEST(TopoParser, PossessivesTakeTheNounSaidBefore) {
  const auto outlineOf = [](const std::string& text) {
    return testing::outline(parser().parse(text).utterances.at(0));
  };
  EXPECT_EQ(outlineOf("On your left you have three offices: Tom's, Ann's and Wei's."),
            "neighbours count=3 places=Tom's office,Ann's office,Wei's office side=left");
  EXPECT_EQ(outlineOf("O gabinete do Rui fica em frente ao da Teresa."),
            "opposite a=gabinete do Rui b=gabinete da Teresa");
  const Utterance alone = parser().parse("The kitchen is next to Mary's.").utterances.at(0);
  ASSERT_EQ(alone.names("b").size(), 1u);
  EXPECT_TRUE(alone.names("b")[0].elliptic);
}

TEST(TopoParser, ContractedVerbsStandBehindKindsOfPlaces) {
  const auto first = [](const std::string& text) {
    return testing::outline(parser().parse(text).utterances.front());
  };
  EXPECT_EQ(first("The library's next to the lab."), "next_to a=library b=lab");
  EXPECT_EQ(first("The library's huge."), "size_word place=library size_word=large");
  EXPECT_EQ(first("The museum's main hall is next to the lab."),
            "next_to a=museum's main hall b=lab");
}

TEST(TopoParser, AcronymsAreNoWordsInSmallLetters) {
  const auto first = [](const std::string& text) {
    return testing::outline(parser().parse(text).utterances.front());
  };
  EXPECT_EQ(first("IT is next to the lab."), "next_to a=IT b=lab");
  EXPECT_EQ(first("It is next to the lab."), "next_to a=<it> b=lab");
  EXPECT_EQ(first("IT IS NEXT TO THE LAB."), "next_to a=<it> b=LAB");
}

TEST(Grammar, IntentsMayStandForOthersOrOnlyCorrect) {
  const TopoParser both = smallParserWith(
      "corrections: [sorry]\n"
      "intents: {again: {kind: statement, as: tell, only_correction: true, "
      "patterns: ['<be> {colour:colour}']}}\n");
  const auto said = both.parse("Sorry, is blue. Is blue.").utterances;
  ASSERT_EQ(said.size(), 2u);
  EXPECT_EQ(testing::outline(said[0]), "tell colour=blue");
  EXPECT_TRUE(said[0].correction);
  EXPECT_FALSE(said[1].understood());
}

TEST(Grammar, SlotsWithTwoValuesAreNoReading) {
  const TopoParser parser = smallParserWith(
      "intents: {both: {kind: statement, patterns: ['{what:thing} {colour:colour} "
      "{colour:colour}']}}\n");
  EXPECT_TRUE(parser.parse("The ball red crimson.").utterances.front().understood());
  EXPECT_FALSE(parser.parse("The ball red blue.").utterances.front().understood());
}

TEST(TopoParser, RangesNameAllBetween) {
  const Utterance said = parser().parse("On your left you have rooms 101 to 104.").utterances.at(0);
  EXPECT_EQ(testing::outline(said),
            "neighbours places=room 101,room 102,room 103,room 104 side=left");
  for (const char* text : {"Dressing rooms one to four are on your left.",
                           "The dressing rooms 1 to 4 are on your left."}) {
    EXPECT_EQ(testing::outline(parser().parse(text).utterances.at(0)),
              "neighbours places=dressing room 1,dressing room 2,dressing room 3,dressing room 4 "
              "side=left");
  }
  EXPECT_EQ(
      testing::outline(parser().parse("On your left you have rooms two to three.").utterances[0]),
      "neighbours places=room 2,room 3 side=left");
  EXPECT_EQ(
      testing::outline(parser().parse("As salas um a três ficam à sua esquerda.").utterances[0]),
      "neighbours places=sala 1,sala 2,sala 3 side=left");
  // What is measured, and what counts down, is none.
  for (const char* text : {"On your left you have rooms two to three metres long.",
                           "On your left you have rooms four to one."}) {
    for (const Utterance& each : parser().parse(text).utterances) {
      EXPECT_EQ(testing::outline(each).find("room 3"), std::string::npos) << text;
    }
  }
}

TEST(PlaceNames, AdjectivesTellPlacesApart) {
  const PlaceNames names(parser().grammars());
  const auto same = [&](const std::string& a, const std::string& b) {
    return compare(names.key(a), names.key(b)) == SameName::kYes;
  };
  EXPECT_FALSE(same("dirty utility", "clean utility"));
  EXPECT_FALSE(same("small meeting room", "large meeting room"));
  EXPECT_TRUE(same("the meeting room", "meeting room"));
}

TEST(Grammar, FurtherFilesAddToTheFirst) {
  const TopoParser both = smallParserWith(
      "classes: {colour: {green: [green]}}\n"
      "intents: {ask: {kind: question, patterns: ['where <be> {what:thing}']}}\n");
  EXPECT_EQ(testing::outline(both.parse("the ball is green").utterances[0]),
            "tell colour=green what=ball");
  EXPECT_EQ(testing::outline(both.parse("Where is the ball?").utterances[0]), "ask what=ball");
  const std::string other = "format: hyselam_grammar\nversion: 1\nlanguage: yy\n";
  expectParts(messageOf<hyselam::InputError>([&] {
                Grammar::fromYaml({{"g.yaml", kSmall}, {"other.yaml", other}});
              }),
              {"other.yaml", "'yy'", "'xx'"});
}

TEST(Grammar, ErrorsNameFileLineAndKey) {
  expectParts(errorWith("format: hyselam_grammar", "format: cake"), {"g.yaml", "'format'"});
  expectParts(errorWith("version: 1", "version: 2"), {"'version'", "has version 2", "reads 1;"});
  expectParts(errorWith("language: xx\n", ""), {"'language' is missing"});
  expectParts(errorWith("macros:", "makros:"), {"line 7", "'makros'", "not known"});
  expectParts(errorWith("<be>", "<bee>"),
              {"intents.tell.patterns", "no macro or word class 'bee'"});
  expectParts(errorWith("{what:thing}", "{what:thin}"), {"there is no type 'thin'"});
  expectParts(errorWith("{what:thing}", "{what}"), {"{slot:type}"});
  expectParts(errorWith("<be> ", "(<be> "), {"')' is missing"});
  expectParts(errorWith("<be> ", "<be>] "), {"']' closes nothing"});
  expectParts(errorWith("<be> ", "<be>, "), {"commas"});
  expectParts(errorWith("'{what:thing} weighs {weight:weight}'", "'[perhaps]'"),
              {"matches nothing at all"});
  expectParts(errorWith("be: [is, seems]", "be: [<be> is]"), {"contain one another"});
  expectParts(errorWith("kind: statement", "kind: song"), {"must be statement", "'song'"});
  expectParts(errorWith("kind: statement, ", ""), {"'kind' is missing"});
  expectParts(errorWith("kind: statement", "refuse: never"), {"no reason 'never'"});
  expectParts(errorWith("0.001: [g]", "-1: [g]"), {"factor > 0"});
  expectParts(errorWith("stop: [is", "stip: [is"), {"names.thing.stip"});
  std::string row = "well", nested = "well";
  for (int k = 0; k < 40; ++k) {
    row += " (then|now)";
    nested = "(" + nested + ") [now]";
  }
  for (const std::string& text : {row, nested}) {
    expectParts(errorWith("macros:", "fillers: {before: [\"" + text + "\"]}\nmacros:"),
                {"fillers", "more than 10000 phrases"});
  }
  expectParts(errorWith("intents:", "intents: ["), {"g.yaml", "is not YAML"});
  expectParts(messageOf<hyselam::InputError>([] { Grammar::shipped("tlh"); }), {"'tlh'", "en, pt"});
  EXPECT_THROW(Grammar::load({"/nowhere/g.yaml"}), hyselam::InputError);
  EXPECT_THROW(TopoParser(std::vector<Grammar>{}), hyselam::ParameterError);
  ParseOptions klingon;
  klingon.language = "tlh";
  EXPECT_THROW(parser().parse("yes", klingon), hyselam::ParameterError);
}

TEST(Grammar, ShippedFilesAreTheSameAsInTheLibrary) {
  for (const std::string& language : Grammar::shippedLanguages()) {
    EXPECT_EQ(Grammar::shippedSource(language).yaml,
              hyselam::testing::fileBytes(HYSELAM_PACKAGE_DIR "/grammar/" + language + ".yaml"));
  }
}

TEST(Grammar, EveryExampleMeansItsIntent) {
  std::set<std::string> names[2];
  int i = 0;
  for (const Grammar& grammar : parser().grammars()) {
    for (const language::IntentInfo& intent : grammar.compiled().intents) {
      if (!intent.refuse.empty()) continue;
      // Those that only say another intent in further ways.
      const std::string name = intent.as.empty() ? intent.name : intent.as;
      names[i].insert(name);
      EXPECT_TRUE(!intent.as.empty() || !intent.examples.empty())
          << grammar.language() << " " << intent.name;
      for (const std::string& example : intent.examples) {
        ParseOptions options;
        options.language = grammar.language();
        options.expected = {name};
        const auto said = parser().parse(example, options).utterances;
        const bool found = std::any_of(said.begin(), said.end(),
                                       [&](const Utterance& u) { return u.intent == name; });
        EXPECT_TRUE(found) << grammar.language() << " " << intent.name << ": " << example << " is "
                           << (said.empty() ? "" : testing::outline(said[0]));
      }
    }
    ++i;
  }
  EXPECT_EQ(names[0], names[1]) << "both languages must know the same intents";
}

TEST(TopoParser, RangesAndReasonsPointAtTheWords) {
  const std::string text = "You are in the hall. On yuor left there is a table, é claro.";
  const auto said = parser().parse(text).utterances;
  ASSERT_EQ(said.size(), 2u);
  EXPECT_EQ(text.substr(said[0].range.begin, said[0].range.end - said[0].range.begin),
            "You are in the hall");
  const Slot* place = said[0].find("place");
  ASSERT_NE(place, nullptr);
  EXPECT_EQ(text.substr(place->names[0].range.begin, 4), "hall");
  EXPECT_FALSE(said[1].understood());
  EXPECT_FALSE(said[1].reason.empty());
  EXPECT_GE(said[1].culprit.begin, said[1].range.begin);
}

TEST(TopoParser, ReportsMisspeltWords) {
  const auto said = parser().parse("folow me").utterances;
  ASSERT_EQ(said.size(), 1u);
  ASSERT_EQ(said[0].spelling.size(), 1u);
  EXPECT_EQ(said[0].spelling[0].said, "folow");
  EXPECT_EQ(said[0].spelling[0].taken_as, "follow");
}

TEST(TopoParser, RefusesWhatIsNoText) {
  const auto code = [](const std::string& text, std::size_t limit = 1000) {
    ParseOptions options;
    options.max_bytes = limit;
    const auto said = parser().parse(text, options).utterances;
    return said.size() == 1 && !said[0].understood() ? said[0].reason_code : "";
  };
  EXPECT_EQ(code("\xff\xfe"), "not_text");
  EXPECT_EQ(code(std::string("yes\0no", 6)), "not_text");
  EXPECT_EQ(code("You are in the corridor.", 10), "too_long");
  std::string long_sentence = "on your left";
  for (int i = 0; i < 500; ++i) long_sentence += " and";
  EXPECT_EQ(code(long_sentence, 10000), "too_long");
  EXPECT_TRUE(parser().parse("").utterances.empty());
}

TEST(TopoParser, LanguageIsFound) {
  EXPECT_EQ(parser().parse("Você está no corredor.").language, "pt");
  EXPECT_EQ(parser().parse("You are in the corridor.").language, "en");
  EXPECT_EQ(parser().parse("não").language, "pt");
}

TEST(PlaceNames, VariantsOfANameMeanOnePlace) {
  const PlaceNames names(parser().grammars());
  const auto same = [&](const char* a, const char* b) {
    const SameName found = compare(names.key(a), names.key(b));
    EXPECT_EQ(found, compare(names.key(b), names.key(a))) << a << " " << b;
    return found;
  };
  for (const auto& [a, b] :
       {std::make_pair("room I-110", "Room i 110"), std::make_pair("room3", "room 3"),
        std::make_pair("room room3", "room3"), std::make_pair("room Room B", "Room B"),
        std::make_pair("room two", "room 2"), std::make_pair("John’s office", "John's office"),
        std::make_pair("the kitchen", "Kitchen"), std::make_pair("Café", "cafe"),
        std::make_pair("laboratory 3", "lab 3"),
        std::make_pair("the lab of Dr. Kim", "Dr. Kim's lab"),
        std::make_pair("office of the dean", "dean's office"),
        std::make_pair("gabinete do Rui", "gabinete de Rui")}) {
    EXPECT_EQ(same(a, b), SameName::kYes) << a << " | " << b;
  }
  for (const auto& [a, b] : {std::make_pair("room I-110", "I-110"), std::make_pair("A", "room A"),
                             std::make_pair("lab 5", "5")}) {
    EXPECT_EQ(same(a, b), SameName::kPerhaps) << a << " | " << b;
  }
  for (const auto& [a, b] :
       {std::make_pair("room 5", "lab 5"), std::make_pair("kitchen", "kichen"),
        std::make_pair("lab kitchen", "kitchen"), std::make_pair("living room", "dining room"),
        std::make_pair("room 1", "room 11")}) {
    EXPECT_EQ(same(a, b), SameName::kNo) << a << " | " << b;
  }
  EXPECT_EQ(same("room of Ann", "room of Tom"), SameName::kNo);
  EXPECT_EQ(names.find("110", {{"room 110"}, {"hall"}}), (std::vector<std::size_t>{0}));
  EXPECT_EQ(names.find("110", {{"room 110"}, {"lab 110"}}), (std::vector<std::size_t>{0, 1}));
  EXPECT_EQ(names.find("110", {{"room 110"}, {"110"}}), (std::vector<std::size_t>{1}));
  EXPECT_EQ(names.find("room 110", {{"110", "lab 110"}}), (std::vector<std::size_t>{}));
  EXPECT_EQ(names.kindOf("entrance hall"), PlaceKind::kCorridor);
  EXPECT_EQ(names.kindOf("dining hall"), PlaceKind::kRoom);
  EXPECT_EQ(names.kindOf("corredor da cozinha"), PlaceKind::kCorridor);
  EXPECT_EQ(names.kindOf("room3"), PlaceKind::kRoom);
  EXPECT_EQ(names.kindOf("I-110"), std::nullopt);
}

TEST(DescribeBuilding, TextIsParsedBackToTheSameBuilding) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    for (const Grammar& grammar : parser().grammars()) {
      const DescribedBuilding building = testing::RandomBuildings(seed, grammar).building();
      const std::string text = describeBuilding(building, grammar);
      ParseOptions options;
      options.language = grammar.language();
      DescriptionBuilder builder(parser());
      const auto issues = builder.add(parser().parse(text, options));
      EXPECT_TRUE(issues.empty()) << issues[0].reason << "\n" << text;
      ASSERT_EQ(testing::outline(builder.building(), true), testing::outline(building, true))
          << "seed " << seed << "\n"
          << text;
    }
  }
}

/// What is understood of all that is told of a building; `trouble`: the first sentence that is not.
DescribedBuilding parsedBack(const DescribedBuilding& building, const Grammar& grammar,
                             std::string* trouble) {
  ParseOptions options;
  options.language = grammar.language();
  DescriptionBuilder builder(parser());
  for (const std::string& sentence : describeChange({}, building, grammar)) {
    const ParsedText parsed = parser().parse(sentence, options);
    const auto issues = builder.add(parsed);
    if (!trouble->empty()) continue;
    if (parsed.misunderstood() > 0) *trouble = sentence + ": " + parsed.utterances[0].reason;
    if (!issues.empty()) *trouble = sentence + ": " + issues[0].reason;
  }
  return builder.building();
}

TEST(DescribeChange, ToldFromNothingIsParsedBackToTheSameBuilding) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    for (const Grammar& grammar : parser().grammars()) {
      const DescribedBuilding building = testing::RandomBuildings(seed, grammar).building();
      std::string trouble;
      const DescribedBuilding understood = parsedBack(building, grammar, &trouble);
      ASSERT_EQ(trouble, "");
      ASSERT_EQ(testing::outline(understood, true), testing::outline(building, true))
          << "seed " << seed << "\n"
          << describeBuilding(building, grammar);
    }
  }
}

#ifdef HYSELAM_HAVE_RAPIDCHECK
RC_GTEST_PROP(DescribeChange, EveryBuildingIsParsedBack, (unsigned seed)) {
  for (const Grammar& grammar : parser().grammars()) {
    const DescribedBuilding building = testing::RandomBuildings(seed, grammar).building();
    std::string trouble;
    const DescribedBuilding understood = parsedBack(building, grammar, &trouble);
    RC_ASSERT(testing::outline(understood, true) == testing::outline(building, true));
  }
}

RC_GTEST_PROP(DescribeBuilding, EveryBuildingIsParsedBack, (unsigned seed)) {
  for (const Grammar& grammar : parser().grammars()) {
    const DescribedBuilding building = testing::RandomBuildings(seed, grammar).building();
    ParseOptions options;
    options.language = grammar.language();
    DescriptionBuilder builder(parser());
    builder.add(parser().parse(describeBuilding(building, grammar), options));
    RC_ASSERT(testing::outline(builder.building(), true) == testing::outline(building, true));
  }
}
#endif

TEST(DescribeBuilding, RefusesNamesThatCannotBeQuoted) {
  DescribedBuilding building;
  building.places.resize(1);
  building.places[0].id = 1;
  building.places[0].name = "\"a\" “b” «c» is";
  EXPECT_THROW(describeBuilding(building, parser().grammars()[0]), hyselam::InputError);
}

}  // namespace
}  // namespace hyselam_topo
