// slam_offline as a shell sees it, in a small made-up building.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "hyselam_common/map_io.hpp"
#include "hyselam_common/ros/bag_io.hpp"
#include "hyselam_common/testing/files.hpp"
#include "hyselam_common/trajectory_io.hpp"
#include "hyselam_sim/generate_corridors.hpp"
#include "hyselam_sim/simulation.hpp"

using hyselam::testing::fileBytes;
using hyselam::testing::TemporaryDirectory;
using hyselam::testing::writeFile;

namespace {

struct SlamOffline : testing::Test {
  static void SetUpTestSuite() {
    directory = new TemporaryDirectory;
    hyselam_sim::CorridorParams corridors;
    corridors.lines = 2;
    corridors.loops = 1.0;
    corridors.legs = 10;
    const auto building = hyselam_sim::generateCorridors(4, corridors);
    hyselam_sim::SimulationParams params;
    params.scan_rate = 4.0;
    auto log = hyselam_sim::simulate(building.plan, building.route, 4, params).log;
    scans = log.scans.size();
    hyselam::writeBag(*directory / "run.bag", log);
    log.odometry.erase(log.odometry.begin() + 1, log.odometry.end());
    log.odometry[0].stamp = 1e6;
    hyselam::writeBag(*directory / "late.bag", log);
  }
  static void TearDownTestSuite() {
    delete directory;
    directory = nullptr;
  }
  int run(const std::string& arguments) {
    const int status = std::system((std::string(HYSELAM_TOOLS) + "/slam_offline " + arguments +
                                    " >" + d / "stdout" + " 2>" + d / "stderr")
                                       .c_str());
    errors = fileBytes(d / "stderr");
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  void expectRefused(const std::string& arguments, const std::string& part) {
    EXPECT_EQ(run(arguments), 2) << arguments << "\n" << errors;
    EXPECT_EQ(errors.rfind("error: ", 0), 0u) << errors;
    EXPECT_EQ(std::count(errors.begin(), errors.end(), '\n'), 1) << errors;
    EXPECT_NE(errors.find(part), std::string::npos) << errors;
  }
  static std::size_t lines(const std::string& path) {
    const std::string text = fileBytes(path);
    return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
  }

  static TemporaryDirectory* directory;
  static std::size_t scans;
  const TemporaryDirectory& d = *directory;
  std::string errors;
};

TemporaryDirectory* SlamOffline::directory = nullptr;
std::size_t SlamOffline::scans = 0;

TEST_F(SlamOffline, writesTheFilesOfTheContract) {
  const std::string out = d / "a";
  ASSERT_EQ(
      run("--bag " + d / "run.bag" + " --out " + out + " --side-by-side --json " + d / "a.json"), 0)
      << errors;
  EXPECT_EQ(errors, "");
  EXPECT_EQ(hyselam::readTum(out + "/trajectory.tum").size(), scans);
  EXPECT_GE(hyselam::readTum(out + "/odometry.tum").size(), scans);
  EXPECT_GT(hyselam::loadMap(out + "/map.yaml").geometry.width, 50);
  EXPECT_EQ(fileBytes(out + "/matches.csv")
                .rfind("stamp_a,stamp_b,level,n,direction,x,y,theta,verified", 0),
            0u);
  EXPECT_EQ(fileBytes(out + "/regions.csv").rfind("first,last,stamp_begin,stamp_end,class", 0), 0u);
  EXPECT_GT(lines(out + "/words.csv"), 5U);
  EXPECT_EQ(fileBytes(out + "/words.csv").rfind("word,level,first,last,run,stamp_begin", 0), 0u);
  EXPECT_NE(fileBytes(out + "/graph.g2o").find("EDGE_SE2"), std::string::npos);
  const std::string report = fileBytes(out + "/report.html");
  EXPECT_NE(report.find("data:image/png;base64,"), std::string::npos);
  EXPECT_NE(report.find("loops: thesis"), std::string::npos);
  EXPECT_NE(report.find("side_by_side_none"), std::string::npos);
  EXPECT_NE(report.find("<title>word 0: class"), std::string::npos);
  EXPECT_GT(hyselam::loadMap(out + "/map_thesis.yaml").geometry.width, 50);
  const auto page = nlohmann::json::parse(fileBytes(out + "/report.json"));
  EXPECT_EQ(page["figures"].size(), 3U);
  EXPECT_EQ(page["figures"][0]["trajectory"].size(), scans);
  EXPECT_NE(report.find("<h1>run.bag</h1>"), std::string::npos);
  const auto summary = nlohmann::json::parse(fileBytes(out + "/summary.json"));
  EXPECT_EQ(summary, nlohmann::json::parse(fileBytes(d / "a.json")));
  EXPECT_EQ(summary["scans"], scans);
  EXPECT_LT(summary["errors"]["rms_m"], 0.15);
  EXPECT_EQ(summary["errors"]["false_loops_near"], 0);
  EXPECT_EQ(summary["errors"]["false_loops_far"], 0);
  EXPECT_TRUE(summary.contains("side_by_side_none"));
}

TEST_F(SlamOffline, givesTheSameBytesForTheSameLog) {
  const std::string arguments = "--bag " + d / "run.bag" + " --odometry-noise 5 --seed 3 --out ";
  ASSERT_EQ(run(arguments + d / "b"), 0) << errors;
  ASSERT_EQ(run(arguments + d / "c"), 0) << errors;
  for (const char* name : {"trajectory.tum", "odometry.tum", "graph.g2o", "map.pgm", "map.yaml",
                           "words.csv", "regions.csv", "matches.csv"})
    EXPECT_EQ(fileBytes(d / "b" + "/" + name), fileBytes(d / "c" + "/" + name)) << name;
}

TEST_F(SlamOffline, tellsTheTroubleThatItMakes) {
  ASSERT_EQ(run("--bag " + d / "run.bag" + " --out " + d / "smooth --json " + d / "smooth.json"), 0)
      << errors;
  EXPECT_TRUE(nlohmann::json::parse(fileBytes(d / "smooth.json"))["trouble"].empty());
  ASSERT_EQ(run("--bag " + d / "run.bag" + " --freeze-odometry 30,5 --gap 50,5 --laser-error " +
                "-0.1,0.08,5 --correct-laser --out " + d / "rough --json " + d / "rough.json"),
            0)
      << errors;
  const auto rough = nlohmann::json::parse(fileBytes(d / "rough.json"));
  EXPECT_GT(rough["rough_road"]["path_unseen_m"], 1.0);
  EXPECT_GT(rough["rough_road"]["gaps"], 0);
  EXPECT_LT(rough["scans"], scans);
  EXPECT_TRUE(rough["laser_mount"]["wrong"]);
  EXPECT_TRUE(rough["laser_mount"]["corrected"]);
  EXPECT_NE(rough["trouble"].dump().find("while the odometry stands still"), std::string::npos);
}

TEST_F(SlamOffline, refusesUnusableInput) {
  const std::string some = "--bag " + d / "run.bag" + " --out " + d / "x ";
  expectRefused(some + "--freeze-odometry 100", "is not 2 numbers");
  expectRefused(some + "--gap 5,100", "EVERY above FOR");
  expectRefused(some + "--gap 100,5,", "is not 2 numbers");
  expectRefused(some + "--every 0", "--every");
  expectRefused(some + "--laser-error 1,2,left", "is not 3 numbers");
  expectRefused("--out " + d / "x", "--bag or --carmen");
  expectRefused("--bag " + d / "none.bag" + " --out " + d / "x", "none.bag");
  expectRefused("--bag " + d / "run.bag" + " --loops some --out " + d / "x", "loops");
  expectRefused("--bag " + d / "run.bag" + " --levels 0 --out " + d / "x", "levels");
  expectRefused("--bag " + d / "run.bag" + " --levels 2000000000 --loops thesis --out " + d / "x",
                "levels");
  expectRefused("--bag " + d / "run.bag" + " --resolution 0 --out " + d / "y", "resolution");
  EXPECT_FALSE(std::filesystem::exists(d / "y"));  // refused before anything is made
  expectRefused("--bag " + d / "late.bag" + " --out " + d / "x", "no odometry");
  writeFile(d / "empty.log", "");
  expectRefused("--carmen " + d / "empty.log" + " --out " + d / "x", "empty.log");
  writeFile(d / "file", "");
  expectRefused("--bag " + d / "run.bag" + " --out " + d / "file/x", "file/x");
  EXPECT_NE(run("--bag a --carmen b --out " + d / "x"), 0);
}

}  // namespace
