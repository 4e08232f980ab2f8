// Transcripts: their lines, and the talks that the package ships.
#include <gtest/gtest.h>

#include <filesystem>

#include "example.hpp"
#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_conversation/transcript_player.hpp"

using namespace hyselam_conversation;  // NOLINT: a test, not a header

namespace {

Beginning example() {
  Beginning out;
  out.map = exampleMap();
  out.start = "1,8,0";
  return out;
}

TEST(Transcript, LinesBecomeSteps) {
  const auto steps = stepsOf(
      "# a comment\n\n  Where are you?  \n> I am\n@ the kitchen\n@pose 1, 2 0.5\n@ask\n@name SS03 "
      "toilet; "
      "WC\n@guess SS04 lab\n@drive library\n@arrive\n@id 7\n@reset pt\n@reset\r\n",
      "test");
  using Kind = Step::Kind;
  const std::vector<Kind> kinds{Kind::kSay,    Kind::kExpect, Kind::kPlace, Kind::kPose,
                                Kind::kAsk,    Kind::kName,   Kind::kGuess, Kind::kDrive,
                                Kind::kArrive, Kind::kId,     Kind::kReset, Kind::kReset};
  ASSERT_EQ(steps.size(), kinds.size());
  for (std::size_t i = 0; i < kinds.size(); ++i) EXPECT_EQ(steps[i].kind, kinds[i]) << i;
  EXPECT_EQ(steps[0].text, "Where are you?");
  EXPECT_EQ(steps[0].line, 3u);
  EXPECT_EQ(steps[1].text, "I am");
  EXPECT_EQ(steps[2].place, "the kitchen");
  EXPECT_EQ(steps[3].pose.theta, 0.5);
  EXPECT_EQ(steps[5].place, "SS03");
  EXPECT_EQ(steps[5].names, (std::vector<std::string>{"toilet", "WC"}));
  EXPECT_EQ(steps[9].text, "7");
  EXPECT_EQ(steps[10].text, "pt");
  EXPECT_EQ(steps[11].text, "");
}

TEST(Transcript, OtherDirectivesAreRefusedWithTheirLine) {
  for (const char* line :
       {"@fly", "@", "@pose 1 2", "@pose a b c", "@ask now", "@name SS03", "@id"}) {
    try {
      stepsOf(std::string("Hello.\n") + line, "talk.txt");
      FAIL() << line;
    } catch (const hyselam::InputError& e) {
      EXPECT_NE(std::string(e.what()).find("line 2"), std::string::npos) << e.what();
    }
  }
}

TEST(TranscriptPlayer, RecordsTellWhatATextHasChanged) {
  TranscriptPlayer player(example(), exampleLanguages());
  EXPECT_FALSE(player.play(stepsOf("@id first", "")[0]).has_value());
  const auto record =
      player.play(stepsOf("You are in the corridor. On your left you have the kitchen.", "")[0]);
  ASSERT_TRUE(record.has_value());
  EXPECT_EQ((*record)["id"], "first");
  EXPECT_EQ((*record)["session"], 0);
  EXPECT_EQ((*record)["new"], nlohmann::json::array({"at corridor", "corridor left kitchen"}));
  EXPECT_EQ((*record)["refused"], false);
  EXPECT_EQ((*record)["place"], "CC11 corridor");
  const auto again = player.play(stepsOf("Where are you?", "")[0]);
  EXPECT_EQ((*again)["id"], "");
  EXPECT_EQ((*again)["new"], nlohmann::json::array());
}

TEST(TranscriptPlayer, EachResetBeginsAnew) {
  TranscriptPlayer player(example(), exampleLanguages());
  for (const Step& step : stepsOf("This is the kitchen.\n@ SS05\n@reset pt\n", ""))
    player.play(step);
  const auto record = player.play(stepsOf("@ SS04", "")[0]);
  EXPECT_EQ((*record)["session"], 1);
  EXPECT_EQ((*record)["language"], "pt");
  EXPECT_TRUE(player.conversation().dialogue().description().places.empty());
}

TEST(TranscriptPlayer, ExpectationsThatAreNotMetAreTold) {
  TranscriptPlayer player(example(), exampleLanguages());
  for (const Step& step : stepsOf("Hello.\n> Hello\n> Goodbye\n", "")) player.play(step);
  ASSERT_EQ(player.failures().size(), 1u);
  EXPECT_NE(player.failures()[0].find("line 3"), std::string::npos) << player.failures()[0];
}

TEST(TranscriptPlayer, WithoutAStartItIsInTheCorridor) {
  Beginning beginning = example();
  beginning.start = "";
  EXPECT_EQ(TranscriptPlayer(beginning, exampleLanguages()).conversation().dialogue().robot().place,
            11u);
  beginning.start = "the moon";
  EXPECT_THROW(TranscriptPlayer(beginning, exampleLanguages()), hyselam::InputError);
}

TEST(TranscriptPlayer, ShippedTalksGoAsWritten) {
  std::size_t talks = 0;
  for (const auto& file : std::filesystem::directory_iterator(HYSELAM_PACKAGE_DIR "/talks")) {
    ++talks;
    TranscriptPlayer player(example(), exampleLanguages());
    for (const Step& step :
         stepsOf(hyselam::readTextFile(file.path(), 1u << 20), file.path().filename())) {
      player.play(step);
    }
    for (const std::string& failure : player.failures())
      ADD_FAILURE() << file.path() << ": " << failure;
  }
  EXPECT_GE(talks, 3u);
}

}  // namespace
