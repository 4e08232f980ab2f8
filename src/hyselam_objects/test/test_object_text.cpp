// What is understood, taken down, asked and answered: corpora with expected maps.
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>
#include <iostream>

#include "hyselam_common/testing/program_run.hpp"
#include "hyselam_objects/language/fill_map.hpp"

using hyselam_objects::FillMap;
using hyselam_objects::ObjectMap;
using hyselam_objects::ObjectParser;

namespace {

std::vector<std::string> texts(const YAML::Node& node) {
  std::vector<std::string> out;
  if (!node.IsDefined()) return out;
  if (node.IsScalar()) out.push_back(node.Scalar());
  for (const auto& each : node) out.push_back(each.Scalar());
  return out;
}

std::string joined(const std::vector<std::string>& lines) {
  std::string out;
  for (const std::string& line : lines) out += "    " + line + "\n";
  return out;
}

// "Silently wrong" is what differs from the expected without a question or a refusal.
struct Score {
  int texts = 0, sentences = 0, right = 0, silent = 0;
};

/// Whether all words (or none of them) stand in the text, whatever their case.
bool holds(const std::string& text, const YAML::Node& words, bool wanted) {
  const auto lower = [](std::string s) {
    std::transform(s.begin(), s.end(), s.begin(), [](unsigned char c) { return std::tolower(c); });
    return s;
  };
  const std::vector<std::string> all = texts(words);
  return std::all_of(all.begin(), all.end(), [&](const std::string& word) {
    return (lower(text).find(lower(word)) != std::string::npos) == wanted;
  });
}

Score score(const std::string& file, const std::string& language) {
  const YAML::Node corpus = YAML::LoadFile(std::string(HYSELAM_PACKAGE_DIR) + "/test/data/" + file);
  const ObjectParser parser = ObjectParser::shipped(language);
  Score score;
  for (const YAML::Node& each : corpus) {
    ObjectMap map;
    FillMap fill(parser, map);
    fill.setRobotPlace(each["here"].as<std::string>(""));
    std::vector<std::string> codes, answers;
    std::string said;
    bool asked = false;
    for (const std::string& text : texts(each["say"])) {
      ++score.sentences;
      for (const auto& reply : fill.process(text)) {
        using hyselam_objects::ReplyKind;
        said += " " + reply.text;
        asked =
            asked || reply.kind == ReplyKind::kQuestion || reply.kind == ReplyKind::kNotUnderstood;
        if (reply.kind == ReplyKind::kAnswer) answers.push_back(reply.text);
        if (reply.kind == ReplyKind::kQuestion || reply.kind == ReplyKind::kNotUnderstood) {
          codes.push_back(reply.code);
        }
      }
    }
    const std::vector<std::string> told = summaryLines(map);
    std::vector<std::string> wanted = texts(each["map"]);
    std::sort(wanted.begin(), wanted.end());
    std::vector<std::string> or_this = texts(each["map_or"]);
    std::sort(or_this.begin(), or_this.end());
    const bool map_good = told == wanted || (each["map_or"].IsDefined() && told == or_this);
    bool good = map_good && codes == texts(each["asks"]);
    if (each["asks_instead"].IsDefined() && codes == texts(each["asks_instead"])) {
      good = told.empty();  // asking back is right, too
    }
    if (each["tells_or_asks"].IsDefined()) {
      good = map_good;
    } else if (each["tells"].IsDefined()) {
      good = good && !answers.empty() && holds(joined(answers), each["tells"], true) &&
             holds(joined(answers), each["tells_not"], false);
    } else {
      good = good && answers == texts(each["answers"]);
    }
    score.right += good;
    ++score.texts;
    if (good) continue;
    score.silent += !asked;
    std::cout << (asked ? "not right: " : "SILENTLY WRONG: ") << each["say"] << "\n  map:\n"
              << joined(told) << "  wanted:\n"
              << joined(wanted) << "  asked:\n"
              << joined(codes) << "  said:\n   " << said << "\n";
  }
  std::cout << file << ": " << score.right << " of " << score.texts << " right (" << score.sentences
            << " texts), " << score.silent << " silently wrong\n";
  return score;
}

}  // namespace

TEST(ObjectText, AThingIsWhereTheRobotStandsNotWhereTheTalkWasBefore) {
  for (const auto& [language, before, now] :
       {std::array<std::string, 3>{"en", "There is a cup on the desk in the reception.",
                                   "There is a note on the desk."},
        {"pt", "Há um copo em cima da mesa na receção.", "Há um livro em cima da mesa."}}) {
    const ObjectParser parser = ObjectParser::shipped(language);
    ObjectMap map;
    FillMap fill(parser, map);
    fill.setRobotPlace("lab");
    fill.process(before);
    fill.process(now);  // it has not moved: on that desk
    fill.setRobotPlace("office");
    fill.process(now);
    std::vector<std::string> places;
    for (const auto& object : map.objects) {
      if (const auto* place = map.findPlace(map.placeOf(object.id))) places.push_back(place->name);
    }
    EXPECT_EQ(std::count(places.begin(), places.end(), "office"), 2) << language;
    EXPECT_EQ(std::count(places.begin(), places.end(), "lab"), 0) << language;
  }
}

TEST(ObjectText, UnderstandsEnglishCorpus) {
  const Score of = score("objects_en.yaml", "en");
  EXPECT_GE(of.sentences, 100);
  EXPECT_GE(of.right, 0.97 * of.texts);
  EXPECT_EQ(of.silent, 0);
}

TEST(ObjectText, UnderstandsPortugueseCorpus) {
  const Score of = score("objects_pt.yaml", "pt");
  EXPECT_GE(of.sentences, 40);
  EXPECT_GE(of.right, 0.97 * of.texts);
  EXPECT_EQ(of.silent, 0);
}

TEST(ObjectText, DetectsTheLanguage) {
  const ObjectParser parser = ObjectParser::shipped();
  ObjectMap map;
  FillMap fill(parser, map);
  EXPECT_EQ(fill.process("Há um copo vermelho na cozinha.").front().text,
            "Anotado: um copo vermelho está na cozinha.");
  EXPECT_EQ(fill.process("There is a red pen in the office.").front().text,
            "Noted: a red pen is in the office.");
  EXPECT_EQ(fill.process("Onde está a cadeira?").front().text, "Não sei nada de 'cadeira'.");
}

TEST(ObjectText, KnowsInOneLanguageWhatWasNamedInTheOther) {
  const ObjectParser parser = ObjectParser::shipped();
  ObjectMap map;
  FillMap fill(parser, map);
  fill.process("There is a red pen on the table in room 3.");
  fill.process("Há uma garrafa na mesa da sala 5.");
  const auto contains = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text << " has no " << part;
  };
  contains(fill.process("Onde está a caneta?").front().text, "caneta vermelha");
  contains(fill.process("Where is the bottle?").front().text, "bottle");
  EXPECT_EQ(std::count_if(map.objects.begin(), map.objects.end(),
                          [](const auto& o) { return o.kind == "pen" || o.kind == "caneta"; }),
            1);
  EXPECT_TRUE(parser.isSameKind("garrafa", "bottle"));
  EXPECT_FALSE(parser.isSameKind("garrafa", "pen"));
  EXPECT_EQ(parser.kindIn("pt", "bottle"), "garrafa");
  EXPECT_EQ(parser.kindIn("en", "garrafa"), "bottle");
  EXPECT_EQ(parser.kindIn("pt", "gizmo"), "gizmo");
}

// A word that means different things in the two languages would join them.
TEST(ObjectText, KindsOfOneLanguageAreNoOthersOfTheOther) {
  const std::string folder = std::string(HYSELAM_PACKAGE_DIR) + "/grammar/";
  const YAML::Node pt = YAML::LoadFile(folder + "words_pt.yaml");
  const ObjectParser english = ObjectParser::shipped("en");
  std::set<std::string> nouns;
  for (const YAML::Node& noun : YAML::LoadFile(folder + "words_en.yaml")["nouns"]) {
    nouns.insert(noun.Scalar());
  }
  EXPECT_GE(pt["english"].size(), 100u);
  for (const auto& pair : pt["english"]) {
    EXPECT_EQ(nouns.count(pair.first.Scalar()), 0u) << pair.first.Scalar();
    EXPECT_EQ(english.kindOf(pair.second.Scalar()).kind, pair.second.Scalar());
  }
}

TEST(ObjectText, UnderstandsHeldOutSentences) {
  const Score of = score("objects_holdout_en.yaml", "en");
  EXPECT_GE(of.texts, 50);
  EXPECT_GE(of.right, 0.97 * of.texts);
  EXPECT_EQ(of.silent, 0);
}

TEST(ObjectText, UnderstandsKindsOfSentences) {
  const Score en = score("objects_said_en.yaml", "en");
  EXPECT_EQ(en.right, en.texts);
  EXPECT_EQ(en.silent, 0);
  const Score pt = score("objects_said_pt.yaml", "pt");
  EXPECT_EQ(pt.right, pt.texts);
  EXPECT_EQ(pt.silent, 0);
}

// What the layer of objects knows as things shall be no names of places to the layer of places.
TEST(ObjectText, KnowsTheSameThingsAsTheLayerOfPlaces) {
  const hyselam_topo::TopoParser places;
  for (const char* const language : {"en", "pt"}) {
    const YAML::Node words =
        YAML::LoadFile(std::string(HYSELAM_PACKAGE_DIR) + "/grammar/words_" + language + ".yaml");
    hyselam_topo::ParseOptions options;
    options.language = language;
    const bool english = std::string(language) == "en";
    int taken = 0, all = 0;
    for (const YAML::Node& noun : words["nouns"]) {
      const std::string text = english ? "There is a " + noun.Scalar() + " in the kitchen."
                                       : "Há um " + noun.Scalar() + " na cozinha.";
      const auto parsed = places.parse(text, options);
      ++all;
      if (parsed.misunderstood() != 0) continue;
      std::cout << " " << noun.Scalar();
      ++taken;
    }
    EXPECT_GE(all, 800);
    EXPECT_LE(taken, all / 20) << language;
    std::cout << " are words for places as well\n";
  }
}

TEST(ObjectText, TellsWhatMovedAndWhatIsGone) {
  const ObjectParser parser = ObjectParser::shipped();
  ObjectMap map;
  FillMap fill(parser, map);
  fill.process("There is a pen on the table in the library.");
  EXPECT_EQ(fill.process("I moved the pen to the hall.").front().text,
            "Noted: the pen is in the hall (before: on the table in the library).");
  EXPECT_EQ(fill.process("The pen is gone.").front().text,
            "Noted: the pen is no longer in the hall.");
  EXPECT_EQ(fill.process("There are two apples and an egg in the hall.").front().text,
            "Noted: two apples and an egg are in the hall.");
}

TEST(ObjectText, AnswersOneQuestionPerText) {
  const ObjectParser parser = ObjectParser::shipped("en");
  ObjectMap map;
  FillMap fill(parser, map);
  fill.process("The pen is in the hall.");
  fill.process("The pen is in the lab.");
  ASSERT_TRUE(fill.hasQuestion());
  const auto replies = fill.process("No, no.");
  EXPECT_EQ(replies.front().code, "kept");
  EXPECT_FALSE(fill.hasQuestion());
  // Another topic ends a question.
  fill.process("The pen is in the lab.");
  fill.process("There is a cup in the hall.");
  EXPECT_EQ(fill.process("Yes.").front().code, "nothing_asked");
  fill.process("The pen is in the lab.");
  fill.dropQuestion();
  EXPECT_EQ(fill.process("Yes.").front().code, "nothing_asked");
}

TEST(ObjectText, TellsTheChoices) {
  const ObjectParser parser = ObjectParser::shipped("en");
  ObjectMap map;
  FillMap fill(parser, map);
  fill.process("There is a red cup in the lab. There is a blue cup in the hall.");
  fill.process("There is a bed in the attic.");
  EXPECT_EQ(
      fill.process("The cup is broken.").front().text,
      "There are 2 of 'cup': which one do you mean: the red cup in the lab or the blue cup in "
      "the hall?");
}

// The detector removes objects between a question and its answer.
TEST(ObjectText, AsksAgainWhereWhatWasMeantIsGone) {
  const ObjectParser parser = ObjectParser::shipped("en");
  const auto tellOfPens = [](FillMap& fill) {
    fill.process("There is a pen on the desk in the kitchen.");
    fill.process("There is a pen on the shelf in the hall.");
    fill.resetContext();
  };
  const auto idIn = [](const ObjectMap& map, const std::string& place) {
    for (const auto& object : map.objects) {
      if (object.kind == "pen" && map.findPlace(map.placeOf(object.id))->name == place) {
        return object.id;
      }
    }
    return hyselam_objects::Id{0};
  };
  {  // chosen, then contradicted
    ObjectMap map;
    FillMap fill(parser, map);
    tellOfPens(fill);
    fill.process("The pen is red.");
    fill.process("the one in the hall");
    fill.resetContext();
    fill.process("The pen is blue.");
    ASSERT_EQ(fill.process("the one in the hall").front().code, "contradiction");
    map.remove(idIn(map, "hall"));
    EXPECT_EQ(fill.process("Yes.").front().code, "unknown");
    checkMap(map, "map");
  }
  {  // all that could be chosen
    ObjectMap map;
    FillMap fill(parser, map);
    tellOfPens(fill);
    ASSERT_EQ(fill.process("The pen is blue.").front().code, "which_one");
    map.remove(idIn(map, "hall"));
    map.remove(idIn(map, "kitchen"));
    EXPECT_EQ(fill.process("Yes.").front().code, "nothing_asked");
  }
  {  // one of those that could be chosen
    ObjectMap map;
    FillMap fill(parser, map);
    tellOfPens(fill);
    fill.process("There is a pen in the lab.");
    fill.resetContext();
    ASSERT_EQ(fill.process("The pen is blue.").front().code, "which_one");
    map.remove(idIn(map, "hall"));
    EXPECT_EQ(fill.process("the one in the hall").front().code, "which_one");
    EXPECT_EQ(fill.process("the one in the lab").front().kind, hyselam_objects::ReplyKind::kDone);
  }
  {  // what was taken down last of a chosen one is corrected
    ObjectMap map;
    FillMap fill(parser, map);
    tellOfPens(fill);
    fill.process("The pen is on the table.");
    fill.process("the one in the hall");
    if (fill.hasQuestion()) fill.process("Yes.");
    for (const std::string place : {"hall", "kitchen"}) map.remove(idIn(map, place));
    fill.process("Sorry, the cup.");
    checkMap(map, "map");
  }
}

TEST(ObjectText, ExamplesOfRefusalsAreUnderstood) {
  for (const char* const language : {"en", "pt"}) {
    const ObjectParser parser = ObjectParser::shipped(language);
    for (const char* const code :
         {"uncertain", "belongs", "past", "choice", "condition", "denial", "person", "place",
          "abstract", "vague", "bare", "two_places", "whose", "question"}) {
      const std::string example = parser.grammar(language).say(std::string("instead_") + code);
      for (const auto& statement : parser.parse(example)) {
        EXPECT_NE(statement.kind, hyselam_topo::UtteranceKind::kNotUnderstood) << example;
      }
    }
  }
}

TEST(ObjectText, UnderstandsTheSentencesOfTheThesis) {
  const ObjectParser parser = ObjectParser::shipped("en");
  ObjectMap map;
  FillMap fill(parser, map);
  const auto replies = fill.process(
      "Robot, in John's office there is a PC and one pen over the table. On the left of the table "
      "there is a chair.");
  ASSERT_EQ(replies.size(), 2u);
  EXPECT_EQ(replies[0].kind, hyselam_objects::ReplyKind::kDone);
  EXPECT_EQ(replies[1].kind, hyselam_objects::ReplyKind::kDone);
  EXPECT_EQ(summaryLines(map),
            (std::vector<std::string>{
                "PC at John's office, over table", "chair at John's office, left table",
                "pen at John's office, over table", "table at John's office"}));
  checkMap(map, "map");
}

TEST(ObjectText, AsksToBeShownUnknownKinds) {
  const ObjectParser parser = ObjectParser::shipped("en");
  ObjectMap map;
  FillMap fill(parser, map);
  fill.process("There is a pen and a cup in the kitchen.");
  hyselam_objects::ObjectDictionary dictionary;
  hyselam_objects::GenericObject cup;
  cup.name = "cup";
  cup.classifier.type = "x";
  cup.classifier.views = {{1.0f}};
  dictionary.put(cup);
  EXPECT_EQ(fill.unknownKinds(dictionary), std::vector<std::string>{"pen"});
  const auto told = fill.process("There is a pen on the table in the lab.");
  EXPECT_EQ(fill.kindToShow(dictionary, told), "pen");
  EXPECT_EQ(fill.kindToShow(dictionary, told), "") << "once at most, and no furniture";
  EXPECT_EQ(fill.showRequest("pen"),
            "I do not know what a pen looks like. To show me, hold one before my camera and say "
            "what it is.");
}

TEST(ObjectText, TellsThePositionWhereNoPlaceIsKnown) {
  const ObjectParser parser = ObjectParser::shipped("en");
  ObjectMap map;
  FillMap fill(parser, map);
  fill.process("There is a red cup in the kitchen. There is a pen in the lab.");
  ASSERT_EQ(map.objects.size(), 2u);
  for (auto& object : map.objects) {
    object.pose.emplace();
    object.pose->position = {28.62, -0.04, 0.7};
  }
  map.relations.erase(
      std::remove_if(map.relations.begin(), map.relations.end(),
                     [&](const auto& r) { return map.find(r.object)->kind == "cup"; }),
      map.relations.end());
  EXPECT_EQ(fill.process("Where is the cup?").front().text, "The red cup is at (28.6, 0.0).");
  EXPECT_EQ(fill.process("Where is the pen?").front().text, "The pen is in the lab.");
}

TEST(ObjectText, ManyFurnituresArePieces) {
  const ObjectParser parser = ObjectParser::shipped("en");
  ObjectMap map;
  FillMap fill(parser, map);
  fill.process("There are two yellow chairs in the kitchen.");
  ASSERT_EQ(map.objects.size(), 2u);
  for (auto& object : map.objects) object.kind = "furniture";  // as the camera has it
  EXPECT_EQ(fill.process("What is in the kitchen?").front().text,
            "There are two yellow pieces of furniture.");
}

TEST(DescribeObjectsTool, AQuestionWritesNothing) {
  const hyselam::testing::TemporaryDirectory folder;
  const std::string map = folder / "objects.xml";
  const auto say = [&](const std::string& text) {
    return hyselam::testing::runProgram(
        HYSELAM_TOOLS "/describe_objects '" + text + "' --map " + map, folder);
  };
  EXPECT_TRUE(hyselam::testing::refused(say("Where is the pen?"), map + ": does not exist"));
  EXPECT_FALSE(std::ifstream(map).good());
  // The first telling creates it.
  EXPECT_EQ(say("There is a pen in the kitchen. Where is the pen?").status, 0);
  const std::string told = hyselam::testing::fileBytes(map);
  EXPECT_NE(told.find("pen"), std::string::npos);
  // Even bytes that the program would write otherwise stay.
  std::ofstream(map, std::ios::app) << "<!-- kept -->\n";
  EXPECT_EQ(say("Where is the pen?").output, "The pen is in the kitchen.\n");
  EXPECT_EQ(hyselam::testing::fileBytes(map), told + "<!-- kept -->\n");
}

TEST(DescribeObjectsTool, SaysThatThereIsNoCamera) {
  const hyselam::testing::TemporaryDirectory folder;
  for (const auto& [text, told] :
       {std::pair<std::string, std::string>{"This is a cup.", "no camera"},
        {"Isto é uma chávena.", "Não há aqui uma câmara"}}) {
    const auto run = hyselam::testing::runProgram(
        HYSELAM_TOOLS "/describe_objects '" + text + "' --map " + (folder / "o.xml"), folder);
    EXPECT_EQ(run.status, 0) << run.errors;
    EXPECT_NE(run.output.find(told), std::string::npos) << run.output;
    EXPECT_EQ(run.output.find("look at it"), std::string::npos) << run.output;
  }
}

TEST(ObjectText, SurvivesAnyBytes) {
  const ObjectParser parser = ObjectParser::shipped("en");
  ObjectMap map;
  FillMap fill(parser, map);
  const std::string sentence = "There are two red cups on the table in the kitchen.";
  std::uint32_t state = 7;
  for (int i = 0; i < 300; ++i) {
    std::string text = sentence;
    for (int k = 0; k < 3; ++k) {
      state = state * 1664525u + 1013904223u;
      text[(state >> 8) % text.size()] = static_cast<char>(state >> 20);
    }
    fill.process(text);
    checkMap(map, "map");
  }
  EXPECT_EQ(fill.process(std::string(100000, 'a')).front().kind,
            hyselam_objects::ReplyKind::kNotUnderstood);
}
