// merge_maps as a shell sees it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "hyselam_common/map_io.hpp"
#include "hyselam_common/robot_log.hpp"
#include "hyselam_common/testing/files.hpp"
#include "hyselam_common/trajectory_io.hpp"
#include "merge_advice.hpp"
#include "ngram_slam/slam/slam_engine.hpp"
#include "ngram_slam/slam/slam_state_io.hpp"
#include "tool_test.hpp"
#include "visits.hpp"

using hyselam::testing::fileBytes;
using hyselam::testing::writeFile;

namespace {

using namespace ngram_slam;  // NOLINT: a test

struct MergeMaps : ToolTest {
  static void SetUpTestSuite() {
    ToolTest::SetUpTestSuite();
    const auto building = loopedCorridors(4, 2, 10);
    for (const std::uint64_t seed : {4, 5, 6}) {
      const auto log =
          hyselam_sim::simulate(building.plan, building.route, seed, atScanRate(4.0)).log;
      SlamStateFile::save(*directory / ("robot" + std::to_string(seed) + ".state"),
                          mapOf(log, 0.0, 1.0));
      scans = log.scans.size();
    }
    SlamStateFile::save(*directory / "empty.state", SlamState{});
    const std::string whole = fileBytes(*directory / "robot4.state");
    writeFile(*directory / "cut.state", whole.substr(0, whole.size() / 2));
  }
  int run(const std::string& arguments) { return ToolTest::run("merge_maps " + arguments); }
  std::string state(const std::string& name) const { return d / (name + ".state") + " "; }

  static std::size_t scans;
};

std::size_t MergeMaps::scans = 0;

TEST_F(MergeMaps, writesOneMapAndWhoMetWhom) {
  const std::string out = d / "a";
  ASSERT_EQ(run(state("robot4") + state("robot5") + "--out " + out + " --json " + d / "a.json"), 0)
      << errors;
  EXPECT_EQ(errors, "");
  EXPECT_NE(output.find("| robot4 | robot5 |"), std::string::npos) << output;
  EXPECT_GT(hyselam::loadMap(out + "/map.yaml").geometry.width, 50);
  EXPECT_EQ(hyselam::readTum(out + "/trajectory_robot4.tum").size(), scans);
  EXPECT_EQ(hyselam::readTum(out + "/trajectory_robot5.tum").size(), scans);
  const auto merged = SlamStateFile::load(out + "/map.state", SlamParams{}.surface);
  EXPECT_EQ(merged.scans.size(), 2 * scans);
  EXPECT_FALSE(std::filesystem::exists(out + "/map_2.state"));
  auto told = nlohmann::json::parse(fileBytes(d / "a.json"));
  EXPECT_GT(told["cpu_seconds"], 0.0);
  told.erase("cpu_seconds");
  EXPECT_EQ(told, nlohmann::json::parse(fileBytes(out + "/report.json")));
  ASSERT_EQ(told["maps"].size(), 1U);
  EXPECT_EQ(told["maps"][0]["sessions"][1]["name"], "robot5");
  EXPECT_EQ(told["maps"][0]["keyframes"], merged.keyframes.size());
  EXPECT_GE(told["meetings"][0]["far_loops"], 3);
  const std::string page = fileBytes(out + "/report.html");
  EXPECT_NE(page.find("2 sessions, 1 map"), std::string::npos);
  EXPECT_NE(page.find("data:image/png;base64,"), std::string::npos);
}

TEST_F(MergeMaps, advisesWhereManyLoopsAreVerifiedAndNoneIsBelieved) {
  MergedMaps merged;
  for (const std::size_t session : {0, 1, 2}) {
    merged.maps.push_back({{}, {{session, {}, {}, {}, {}}}});
  }
  merged.meetings = {{0, 1, 0, 0, 310, 0.0}, {0, 2, 0, 0, 3, 0.0}, {1, 2, 4, 0, 50, 0.9}};
  const std::vector<std::string> labels{"monday", "tuesday", "elsewhere"};
  const std::string advice = adviceOn(merged, labels, 0.0);
  for (const char* part : {"monday and tuesday: 310 loops verified, none believed",
                           "--place-interval 2", "--start unknown"}) {
    EXPECT_NE(advice.find(part), std::string::npos) << advice;
  }
  EXPECT_EQ(advice.find("elsewhere"), std::string::npos) << advice;
  EXPECT_EQ(adviceOn(merged, labels, 2.0).find("--place-interval"), std::string::npos);
  merged.maps[0].parts.push_back(merged.maps[1].parts[0]);
  EXPECT_EQ(adviceOn(merged, labels, 0.0), "") << "they lie in one map";
}

TEST_F(MergeMaps, givesTheSameFilesWithOneThreadAndWithThree) {
  const std::string both = state("robot4") + state("robot5");
  ASSERT_EQ(run(both + "--threads 1 --out " + d / "b"), 0) << errors;
  ASSERT_EQ(run(both + "--threads 3 --out " + d / "c"), 0) << errors;
  for (const char* name : {"map.state", "map.pgm", "map.yaml", "trajectory_robot4.tum",
                           "trajectory_robot5.tum", "report.json", "report.html"}) {
    EXPECT_TRUE(fileBytes(d / "b" + "/" + name) == fileBytes(d / "c" + "/" + name)) << name;
  }
}

TEST_F(MergeMaps, leavesOutWhatCannotBeUsedAndSaysSo) {
  ASSERT_EQ(run(state("cut") + state("robot4") + state("empty") + state("robot4") +
                d / "none.state" + " --out " + d / "e"),
            0)
      << errors;
  EXPECT_EQ(std::count(errors.begin(), errors.end(), '\n'), 4) << errors;
  for (const char* part : {"cut.state", "empty.state: left out: holds no keyframes", "none.state",
                           "robot4.state: left out: holds nothing that"}) {
    EXPECT_NE(errors.find(part), std::string::npos) << part << "\n" << errors;
  }
  const auto report = nlohmann::json::parse(fileBytes(d / "e" + "/report.json"));
  EXPECT_EQ(report["left_out"].size(), 4U);
  EXPECT_EQ(report["maps"][0]["sessions"].size(), 1U);
  EXPECT_NE(fileBytes(d / "e" + "/report.html").find("left out"), std::string::npos);
}

TEST_F(MergeMaps, namesEachSessionAnotherWayAndLeavesNothingOfAMergingBefore) {
  for (const char* folder : {"m", "k/m", "w"}) std::filesystem::create_directories(d / folder);
  std::filesystem::copy_file(d / "robot4.state", d / "m/x.state");
  std::filesystem::copy_file(d / "robot5.state", d / "k/m/x.state");
  std::filesystem::copy_file(d / "robot6.state", d / "w/m_x_2.state");
  const std::string out = d / "g";
  ASSERT_EQ(
      run(d / "m/x.state" + " " + d / "k/m/x.state" + " " + d / "w/m_x_2.state" + " --out " + out),
      0)
      << errors;
  std::set<std::string> names, trajectories;
  const auto report = nlohmann::json::parse(fileBytes(out + "/report.json"));
  for (const auto& map : report["maps"]) {
    for (const auto& s : map["sessions"]) {
      names.insert(s["name"].get<std::string>());
      trajectories.insert(s["trajectory"].get<std::string>());
      EXPECT_EQ(s["scan_ranges"], nlohmann::json::parse("[[0, " + std::to_string(scans) + "]]"));
    }
  }
  EXPECT_EQ(names.size(), 3U);
  EXPECT_EQ(trajectories.size(), 3U);
  writeFile(out + "/trajectory_mine.tum", "");
  ASSERT_EQ(run(state("robot4") + "--out " + out), 0) << errors;
  EXPECT_TRUE(std::filesystem::exists(out + "/trajectory_robot4.tum"));
  EXPECT_TRUE(std::filesystem::exists(out + "/trajectory_mine.tum"));
  for (const std::string& t : trajectories)
    EXPECT_FALSE(std::filesystem::exists(out + "/" + t)) << t;
}

TEST_F(MergeMaps, refusesUnusableInput) {
  EXPECT_EQ(run(state("empty") + state("cut") + "--out " + d / "f"), 2);
  EXPECT_NE(errors.find("error: merge_maps: none of the 2 maps can be used"), std::string::npos)
      << errors;
  EXPECT_EQ(run(state("robot4") + "--threads 0 --out " + d / "f"), 2);
  EXPECT_NE(errors.find("threads"), std::string::npos) << errors;
  EXPECT_EQ(run(state("robot4") + "--resolution 0 --out " + d / "f"), 2);
  EXPECT_NE(errors.find("resolution"), std::string::npos) << errors;
  EXPECT_EQ(run("--out " + d / "f"), 2);
  writeFile(d / "file", "");
  EXPECT_EQ(run(state("robot4") + "--out " + d / "file/x"), 2);
  EXPECT_NE(errors.find("file/x"), std::string::npos) << errors;
}

}  // namespace
