// The tool topomerg as a shell sees it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string>

#include "hyselam_common/testing/files.hpp"
#include "hyselam_common/testing/program_run.hpp"
#include "hyselam_topological_map/topological_map_xml.hpp"

using hyselam::testing::fileBytes;

namespace {

class TopoMergTool : public testing::Test {
 protected:
  int run(const std::string& arguments) {
    return hyselam::testing::runProgram(
               std::string("\"") + HYSELAM_TOOLS + "/topomerg\" " + arguments, folder_)
        .status;
  }
  /// Of the run that was last.
  void expectError(int status, const std::string& part) {
    EXPECT_TRUE(hyselam::testing::refused({status, "", fileBytes(folder_ / "stderr")}, part));
  }
  nlohmann::json json() { return nlohmann::json::parse(fileBytes(folder_ / "out.json")); }

  const std::string data_ = std::string(HYSELAM_PACKAGE_DIR) + "/test/data/";
  const std::string input_ = data_ + "scenario_532_human.xml " + data_ + "scenario_532_map.xml ";
  hyselam::testing::TemporaryDirectory folder_;
  const std::string output_ =
      " --out " + (folder_ / "merged.xml") + " --json " + (folder_ / "out.json");
};

}  // namespace

TEST_F(TopoMergTool, NamesTheVirtualScenario) {
  ASSERT_EQ(0, run(input_ + "--robot-place 4 --robot-heading 0 --no-dummy --equation-52" + output_))
      << fileBytes(folder_ / "stderr");
  EXPECT_EQ("", fileBytes(folder_ / "stderr"));
  const nlohmann::json result = json();
  EXPECT_NEAR(0.953, result.at("fitness").get<double>(), 0.01);
  EXPECT_EQ(1, result.at("solutions_equal"));
  EXPECT_TRUE(result.at("optimal"));
  EXPECT_EQ(0.0, result.at("gap"));
  EXPECT_GT(result.at("nodes_expanded"), 0);
  EXPECT_GE(result.at("microseconds"), 0.0);
  EXPECT_EQ(7u, result.at("assignment").size());
  EXPECT_EQ("kitchen", result.at("assignment")[3].at("name"));
  EXPECT_EQ(nlohmann::json({5, 6}), result.at("assignment")[3].at("places"));
  EXPECT_NE(std::string::npos, fileBytes(folder_ / "stdout").find("\nkitchen: place 5, 6"));
  EXPECT_EQ(7u, result.at("uncertainties").size());
  const auto map = hyselam_topo::loadXml(folder_ / "merged.xml");
  ASSERT_EQ(1u, map.places[0].words.size());
  EXPECT_EQ("Room B", map.places[0].words[0].text);
  EXPECT_FALSE(map.places[0].words[0].confirmed);
  EXPECT_TRUE(map.places[3].words[0].confirmed);  // the robot's own place
}

TEST_F(TopoMergTool, AllSolversAgreeAndWriteTheSame) {
  std::string first;
  for (const char* solver : {"exact", "explorer", "treesearch"}) {
    ASSERT_EQ(0, run(input_ +
                     "--robot-place 4 --robot-heading 0 --no-dummy --uncertainties 0 "
                     "--solver " +
                     solver + output_))
        << fileBytes(folder_ / "stderr");
    if (first.empty()) first = fileBytes(folder_ / "merged.xml");
    EXPECT_EQ(first, fileBytes(folder_ / "merged.xml")) << solver;
    if (std::string(solver) == "explorer") {
      EXPECT_EQ(823543, json().at("nodes_expanded"));
    }
  }
}

TEST_F(TopoMergTool, ConfirmedAndExcludedNames) {
  ASSERT_EQ(0, run(input_ +
                   "--robot-place 4 --robot-heading 0 --confirmed \"2=Room B\" "
                   "--excluded 3=WC" +
                   output_));
  const auto map = hyselam_topo::loadXml(folder_ / "merged.xml");
  EXPECT_EQ("Room B", map.places[1].words[0].text);
  EXPECT_TRUE(map.places[1].words[0].confirmed);
}

TEST_F(TopoMergTool, BadInputIsOneLine) {
  expectError(run("none.xml " + data_ + "scenario_532_map.xml" + output_), "none.xml");
  expectError(run(data_ + "scenario_532_map.xml " + data_ + "scenario_532_map.xml" + output_), "");
  expectError(run(input_ + "--robot-place 99" + output_), "99");
  expectError(run(input_ + "--confirmed 4=castle" + output_), "castle");
  expectError(run(input_ + "--confirmed corridor" + output_), "PLACE=NAME");
  expectError(run(input_ + "--weight-areas -1" + output_), "areas");
  expectError(run(input_ + "--time-limit -1" + output_), "time-limit");
  expectError(run(input_ + "--out " + (folder_ / "none/x.xml")), "none");
  EXPECT_EQ("", fileBytes(folder_ / "merged.xml"));
}
