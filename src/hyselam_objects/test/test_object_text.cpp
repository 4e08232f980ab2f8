// What is understood, taken down, asked and answered: corpora with expected maps.
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <iostream>

#include "hyselam_objects/fill_map.hpp"

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

}  // namespace

// "Silently wrong" is what differs from the expected without a question or a refusal.
TEST(ObjectText, Corpus) {
  const YAML::Node corpus =
      YAML::LoadFile(std::string(HYSELAM_OBJECTS_SOURCE_DIR) + "/test/data/objects_en.yaml");
  const ObjectParser parser = ObjectParser::shipped("en");
  int right = 0, silent = 0, sentences = 0;
  for (const YAML::Node& each : corpus) {
    ObjectMap map;
    FillMap fill(&parser, &map);
    fill.setPlace(each["here"].as<std::string>(""));
    std::vector<std::string> codes, answers;
    bool asked = false;
    for (const std::string& text : texts(each["say"])) {
      ++sentences;
      for (const auto& reply : fill.say(text)) {
        using hyselam_objects::ReplyKind;
        asked =
            asked || reply.kind == ReplyKind::kQuestion || reply.kind == ReplyKind::kNotUnderstood;
        if (reply.kind == ReplyKind::kAnswer) answers.push_back(reply.text);
        if (reply.kind == ReplyKind::kQuestion || reply.kind == ReplyKind::kNotUnderstood) {
          codes.push_back(reply.code);
        }
      }
    }
    const std::vector<std::string> told = tellObjects(map);
    std::vector<std::string> wanted = texts(each["map"]);
    std::sort(wanted.begin(), wanted.end());
    const std::vector<std::string> wanted_codes = texts(each["asks"]);
    const std::vector<std::string> wanted_answers = texts(each["answers"]);
    const bool good = told == wanted && codes == wanted_codes && answers == wanted_answers;
    right += good;
    if (good) continue;
    silent += !asked;
    std::cout << (asked ? "not right: " : "SILENTLY WRONG: ") << each["say"] << "\n  map:\n"
              << joined(told) << "  wanted:\n"
              << joined(wanted) << "  asked:\n"
              << joined(codes) << "  answers:\n"
              << joined(answers);
  }
  const auto total = static_cast<int>(corpus.size());
  std::cout << right << " of " << total << " right (" << sentences << " texts), " << silent
            << " silently wrong\n";
  EXPECT_GE(sentences, 100);
  EXPECT_GE(right, 0.97 * total);
  EXPECT_EQ(silent, 0);
}

TEST(ObjectText, TheThesisSentences) {
  const ObjectParser parser = ObjectParser::shipped("en");
  ObjectMap map;
  FillMap fill(&parser, &map);
  const auto replies = fill.say(
      "Robot, in John's office there is a PC and one pen over the table. On the left of the table "
      "there is a chair.");
  ASSERT_EQ(replies.size(), 2u);
  EXPECT_EQ(replies[0].kind, hyselam_objects::ReplyKind::kDone);
  EXPECT_EQ(replies[1].kind, hyselam_objects::ReplyKind::kDone);
  EXPECT_EQ(tellObjects(map),
            (std::vector<std::string>{
                "PC at John's office, over table", "chair at John's office, left table",
                "pen at John's office, over table", "table at John's office"}));
  checkMap(map, "map");
}

TEST(ObjectText, NewObjectAsksForWhatTheDictionaryDoesNotKnow) {
  const ObjectParser parser = ObjectParser::shipped("en");
  ObjectMap map;
  FillMap fill(&parser, &map);
  fill.say("There is a pen and a cup in the kitchen.");
  hyselam_objects::ObjectDictionary dictionary;
  hyselam_objects::GenericObject cup;
  cup.name = "cup";
  cup.classifier.type = "x";
  cup.classifier.views = {{1.0f}};
  dictionary.put(cup);
  EXPECT_EQ(fill.unknownKinds(dictionary), std::vector<std::string>{"pen"});
  EXPECT_EQ(fill.askToShow("pen"), "I do not know what a pen looks like: show me one.");
}

TEST(ObjectText, AnyBytesAreSurvived) {
  const ObjectParser parser = ObjectParser::shipped("en");
  ObjectMap map;
  FillMap fill(&parser, &map);
  const std::string sentence = "There are two red cups on the table in the kitchen.";
  std::uint32_t state = 7;
  for (int i = 0; i < 300; ++i) {
    std::string text = sentence;
    for (int k = 0; k < 3; ++k) {
      state = state * 1664525u + 1013904223u;
      text[(state >> 8) % text.size()] = static_cast<char>(state >> 20);
    }
    fill.say(text);
    checkMap(map, "map");
  }
  EXPECT_EQ(fill.say(std::string(100000, 'a')).front().kind,
            hyselam_objects::ReplyKind::kNotUnderstood);
}
