// The programs converse and chat --offline, as people and scripts start them.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "hyselam_common/atomic_file.hpp"

using nlohmann::json;

namespace {

struct Done {
  int status = 0;
  std::string output;  ///< of both streams
};

Done run(const std::string& command) {
  Done done;
  // Nothing of ROS may be needed at run time.
  FILE* pipe = popen(("unset ROS_MASTER_URI; (" + command + ") 2>&1").c_str(), "r");
  std::array<char, 4096> buffer{};
  while (std::fgets(buffer.data(), static_cast<int>(buffer.size()), pipe) != nullptr) {
    done.output += buffer.data();
  }
  done.status = WEXITSTATUS(pclose(pipe));
  return done;
}

const std::string kConverse = HYSELAM_TOOLS "/converse";
const std::string kChat = HYSELAM_TOOLS "/../hyselam_topo/chat";

TEST(ConverseTool, PrintsTheTalk) {
  const Done done = run("printf 'Hello.\\nWhere are you?\\n' | " + kConverse);
  EXPECT_EQ(done.status, 0);
  EXPECT_EQ(done.output,
            "You:   Hello.\nRobot: Hello.\nYou:   Where are you?\nRobot: I am at CC11.\n");
}

TEST(ConverseTool, WritesOneRecordAText) {
  const std::string file = ::testing::TempDir() + "/converse.json";
  const Done done = run("printf '@id a\\nHello.\\n@ SS03\\n' | " + kConverse + " --json " + file);
  EXPECT_EQ(done.status, 0) << done.output;
  const json records = json::parse(hyselam::readTextFile(file, 1u << 20));
  ASSERT_EQ(records.size(), 2u);
  EXPECT_EQ(records[0]["id"], "a");
  EXPECT_EQ(records[0]["reply"], "Hello.");
  EXPECT_EQ(records[1]["place"], "SS03");
}

TEST(ConverseTool, AnErrorNamesItsLineAndKeepsWhatWasSaid) {
  const std::string file = ::testing::TempDir() + "/converse_error.json";
  const auto talk = [&](const std::string& lines) {
    std::remove(file.c_str());
    return run("printf '" + lines + "' | " + kConverse + " --json " + file);
  };
  const auto said = [&] { return json::parse(hyselam::readTextFile(file, 1u << 20)).size(); };
  Done done = talk("Hello.\\n\\n@ kitchen\\nGoodbye.\\n");
  EXPECT_EQ(done.status, 2);
  EXPECT_NE(done.output.find("error: stdin: line 3: place: no place of the map is called kitchen"),
            std::string::npos)
      << done.output;
  EXPECT_EQ(said(), 1u);
  done = talk("There is a kitchen and a library.\\n@drive kitchen\\n");
  EXPECT_EQ(done.status, 2);
  EXPECT_NE(
      done.output.find("line 2: place: there is no way to kitchen: no place has this name for "
                       "sure, SS"),
      std::string::npos)
      << done.output;
  EXPECT_EQ(said(), 1u);
  done = talk("Hello.\\n> Goodbye\\n");
  EXPECT_EQ(done.status, 1);
  EXPECT_EQ(said(), 1u);
}

TEST(ConverseTool, AnswersLineByLine) {
  const Done done = run("printf 'Hello.\\n@fly\\n@ SS03\\n@ask\\n' | " + kConverse + " --lines");
  EXPECT_EQ(done.status, 0);
  std::istringstream in(done.output);
  std::vector<json> answers;
  for (std::string line; std::getline(in, line);) answers.push_back(json::parse(line));
  ASSERT_EQ(answers.size(), 4u) << done.output;
  EXPECT_EQ(answers[0]["reply"], "Hello.");
  EXPECT_NE(answers[1]["error"].get<std::string>().find("@fly"), std::string::npos);
  EXPECT_EQ(answers[2]["open_question"], "");
  EXPECT_NE(answers[3]["open_question"], "");
}

TEST(ConverseTool, SpeaksTheLanguageThatIsAskedFor) {
  const Done done = run("printf '@ SS03\\n@ask\\n' | " + kConverse + " --language pt");
  EXPECT_NE(done.output.find("Qual"), std::string::npos) << done.output;
}

TEST(ConverseTool, StatusTellsWhatWentWrong) {
  EXPECT_EQ(run(kConverse + " --map /nowhere.xml < /dev/null").status, 2);
  EXPECT_EQ(run(kConverse + " --start moon < /dev/null").status, 2);
  EXPECT_EQ(run("echo @fly | " + kConverse).status, 2);
  EXPECT_EQ(run(kConverse + " --language tlh < /dev/null").status, 2);
  EXPECT_EQ(run("printf 'Hello.\\n> Goodbye\\n' | " + kConverse).status, 1);
}

TEST(ChatOffline, NeedsNoMaster) {
  const std::string file = ::testing::TempDir() + "/chat.json";
  const Done done = run("printf 'Hello.\\n' | " + kChat + " --offline --json " + file);
  EXPECT_EQ(done.status, 0);
  EXPECT_EQ(done.output, "You:   Hello.\nRobot: Hello.\n");
  EXPECT_EQ(json::parse(hyselam::readTextFile(file, 1u << 20)).size(), 1u);
  EXPECT_EQ(run(kChat + " --offline --map /nowhere.xml < /dev/null").status, 2);
}

TEST(ChatOffline, ShowsAnOpenQuestionAgain) {
  const Done done =
      run("ROS_HOME=" + ::testing::TempDir() +
          " python3 " HYSELAM_PACKAGE_DIR "/test/chat_in_terminal.py " + kChat + " '@ask' '@ask'");
  EXPECT_EQ(done.status, 0) << done.output;
  EXPECT_NE(done.output.find("(asked before: What is the name of this place?)"), std::string::npos)
      << done.output;
}

}  // namespace
