#include <gtest/gtest.h>

#include "hyselam_common/testing/files.hpp"
#include "hyselam_common/testing/program_run.hpp"
#include "hyselam_language/building/description_xml.hpp"
#include "hyselam_language/testing/language_outlines.hpp"

namespace hyselam_topo {
namespace {

void expectParts(const std::string& message, const std::vector<std::string>& parts) {
  for (const std::string& part : parts) {
    EXPECT_NE(message.find(part), std::string::npos) << "'" << part << "' is not in: " << message;
  }
}

int status(const std::string& arguments) {
  return hyselam::testing::runProgram(HYSELAM_TOOLS "/parse_description " + arguments).status;
}

TEST(ParseDescriptionTool, WritesTheGraph) {
  const hyselam::testing::TemporaryDirectory dir;
  const std::string out = " --out " + (dir / "h.xml"), json = " --json " + (dir / "h.json");
  ASSERT_EQ(status("'You are in the hall. On your left is room A. Blah.'" + out + json), 0);
  EXPECT_EQ(testing::outline(loadDescription(dir / "h.xml")),
            (std::vector<std::string>{"at hall", "hall left room A"}));
  const std::string told = hyselam::testing::fileBytes(dir / "h.json");
  expectParts(told, {"\"not_understood\"", "\"Blah.\"", "\"reason\"", "\"microseconds\"",
                     "\"robot_place\": 1", "\"neighbours\""});
  hyselam::testing::writeFile(dir / "t.txt", "Você está no corredor.");
  ASSERT_EQ(status((dir / "t.txt") + out + " --language pt"), 0);
  EXPECT_EQ(loadDescription(dir / "h.xml").places.at(0).name, "corredor");
  ASSERT_EQ(status("-" + out + " < " + (dir / "t.txt")), 0);
  EXPECT_EQ(status("--help"), 0);
  // One sentence without an end does not spoil the others.
  std::string text = "You are in the hall. On your left";
  for (int i = 0; i < 500; ++i) text += " and";
  hyselam::testing::writeFile(dir / "t.txt", text);
  ASSERT_EQ(status((dir / "t.txt") + out + json), 0);
  EXPECT_EQ(loadDescription(dir / "h.xml").places.at(0).name, "hall");
  expectParts(hyselam::testing::fileBytes(dir / "h.json"), {"\"code\": \"too_long\""});
}

TEST(ParseDescriptionTool, TellsRanksDenialsAndWhatMustBeAsked) {
  const hyselam::testing::TemporaryDirectory dir;
  const std::string out = " --out " + (dir / "h.xml"), json = " --json " + (dir / "h.json");
  const std::string text =
      "'You are in the hall. The second place on the left of the hall is room A, 10 meters away. "
      "Room A is not next to room B. Room A has 2 doors. Room B is one floor up. Room B is large. "
      "Room A is next to Atlantis.'";
  ASSERT_EQ(status(text + out + json), 0);
  const std::vector<std::string> graph{
      "at hall",        "hall left room A#2@10", "not room A next_to room B",
      "room A doors 2", "room B floor 1",        "room B large"};
  EXPECT_EQ(testing::outline(loadDescription(dir / "h.xml")), graph);
  expectParts(
      hyselam::testing::fileBytes(dir / "h.json"),
      {"\"rank\": 2", "\"distance\": 10.0", "\"denied\": true", "\"doors\": 2", "\"floor\": 1",
       "\"size_word\": \"large\"", "\"asks\"", "\"strange name\"", "\"name\": \"Atlantis\""});
  ASSERT_EQ(status(text + out + " --accept-name Atlantis"), 0);
  EXPECT_EQ(loadDescription(dir / "h.xml").places.size(), 4u);
  ASSERT_EQ(status(text + out + " --ask-strange-names false"), 0);
  EXPECT_EQ(loadDescription(dir / "h.xml").places.size(), 4u);
}

TEST(ParseDescriptionTool, UnusableInputEndsWithStatusTwo) {
  const hyselam::testing::TemporaryDirectory dir;
  const std::string out = " --out " + (dir / "h.xml");
  EXPECT_EQ(status(""), 2);
  EXPECT_EQ(status("'You are in the hall.'"), 2);
  EXPECT_EQ(status("'You are in the hall.' --out /nowhere/h.xml"), 2);
  EXPECT_EQ(status("'You are in the hall.' --language tlh" + out), 2);
  EXPECT_EQ(status("'You are in the hall.' --grammar /nowhere/g.yaml" + out), 2);
  hyselam::testing::writeFile(dir / "bytes", "\xff\xfe\x01");
  EXPECT_EQ(status((dir / "bytes") + out), 2);
  EXPECT_EQ(dir.fileCount(), 1u);
}

}  // namespace
}  // namespace hyselam_topo
