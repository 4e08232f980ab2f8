// Texts of people who knew no grammar, judged right once: they must stay right. `bench/strangers
// --judged --keep` writes the files of test/data/strangers.
#include <gtest/gtest.h>

#include <filesystem>

#include "example.hpp"
#include "hyselam_common/atomic_file.hpp"
#include "hyselam_conversation/transcript_player.hpp"
#include "hyselam_language/testing/lost_words.hpp"

using namespace hyselam_conversation;  // NOLINT: a test, not a header
using nlohmann::json;

namespace {

/// The record of the entry's text, in the situation in which it was judged.
json recordOf(const json& entry, TranscriptPlayer& player) {
  for (const json& line : entry["steps"]) {
    for (const Step& step : stepsOf(line.get<std::string>(), "steps")) player.play(step);
  }
  Step said;
  said.text = entry["text"].get<std::string>();
  return *player.play(said);
}

/// As bench/strangers takes it of a record.
json outcomeOf(const json& record, const json& keys) {
  json out;
  for (const auto& [key, value] : keys.items()) {
    if (key == "asks") {
      out[key] = record["question"] != "";
    } else if (key == "names") {
      out[key] = json::object();
      for (const auto& [code, change] : record["names"].items()) {
        if (change["confirmed"] == true) out[key][code] = change["name"];
      }
    } else {
      out[key] = record[key];
    }
  }
  return out;
}

TEST(Strangers, WhatWasRightStaysRight) {
  Beginning beginning;
  beginning.map = exampleMap();
  beginning.start = "1,8,0";
  beginning.params.dialogue.match.time_limit = 0.1;
  TranscriptPlayer player(beginning);
  std::size_t texts = 0, files = 0;
  for (const auto& file :
       std::filesystem::directory_iterator(HYSELAM_PACKAGE_DIR "/test/data/strangers")) {
    if (file.path().extension() != ".json") continue;
    ++files;
    for (const json& entry : json::parse(hyselam::readTextFile(file.path(), 1u << 24))) {
      ++texts;
      const json record = recordOf(entry, player);
      EXPECT_EQ(outcomeOf(record, entry["outcome"]), entry["outcome"])
          << entry["id"] << " in " << file.path().filename() << ": " << entry["text"]
          << "\nmeant: " << entry["meaning"] << "\nrobot: " << record["reply"];
    }
  }
  // Eighteen batches and what was written with this test; each keeps some.
  EXPECT_EQ(files, 19u);
  EXPECT_GE(texts, 927u);
}

/// Of all batches, right or not.
TEST(Strangers, NothingIsDroppedSilently) {
  const hyselam_topo::TopoParser& parser = exampleLanguages()->places;
  std::size_t texts = 0;
  for (const auto& file :
       std::filesystem::directory_iterator(HYSELAM_PACKAGE_DIR "/test/data/batches")) {
    if (file.path().extension() != ".json") continue;
    for (const json& entry : json::parse(hyselam::readTextFile(file.path(), 1u << 24))) {
      ++texts;
      const std::string language = entry["lang"].get<std::string>().substr(0, 2);
      for (const std::string& lost :
           hyselam_topo::testing::lostWords(parser, entry["text"].get<std::string>(), language)) {
        ADD_FAILURE() << entry["id"] << ": " << lost;
      }
    }
  }
  EXPECT_GE(texts, 2465u);
}

}  // namespace
