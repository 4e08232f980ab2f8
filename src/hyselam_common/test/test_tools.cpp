// The programs as people call them: exit status, one line of error, results as JSON.
#include <gtest/gtest.h>
#include <rosbag/bag.h>

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/map_io.hpp"
#include "hyselam_common/ros/bag_io.hpp"
#include "hyselam_common/ros/conversions.hpp"
#include "hyselam_common/testing/files.hpp"
#include "hyselam_common/testing/program_run.hpp"
#include "hyselam_common/tool.hpp"

namespace hyselam {
namespace {

using testing::fileBytes;
using testing::ProgramRun;
using testing::refused;
using testing::TemporaryDirectory;
using testing::writeFile;

ProgramRun run(const std::string& command) {
  return testing::runProgram(std::string(HYSELAM_TOOLS) + "/" + command);
}

std::string scanLine(double stamp, double x) {
  std::string line = "FLASER 180";
  for (int i = 0; i < 180; ++i) line += " 3.0";
  return line + " 0 0 0 " + std::to_string(x) + " 0 0 1 h " + std::to_string(stamp) + "\n";
}

class Tools : public ::testing::Test {
 protected:
  void SetUp() override {
    writeFile(d / "in.log",
              scanLine(1, 0) + "FLASER 180 1 2\n" + scanLine(2, 0.5) + scanLine(3, 1.0));
  }
  TemporaryDirectory d;
};

TEST_F(Tools, CarmenToBagConverts) {
  const ProgramRun r = run("carmen_to_bag " + d / "in.log" + " " +
                           d / "out.bag --laser-frame front --json " + d / "out.json");
  ASSERT_EQ(r.status, 0) << r.errors;
  EXPECT_NE(r.errors.find("line 2: skipped"), std::string::npos);
  const auto json = nlohmann::json::parse(fileBytes(d / "out.json"));
  EXPECT_EQ(json["scans"], 3);
  EXPECT_EQ(json["beams"], 180);
  EXPECT_EQ(json["odometry"], 3);
  EXPECT_EQ(json["skipped"], 1);
  EXPECT_EQ(json["duration"], 2.0);
  EXPECT_EQ(json["issues"][0]["line"], 2);
  EXPECT_EQ(readBag(d / "out.bag").scans.size(), 3U);
  const std::string first = fileBytes(d / "out.bag");
  EXPECT_NE(first.find("front"), std::string::npos);
  run("carmen_to_bag " + d / "in.log" + " " + d / "out.bag --laser-frame front");
  EXPECT_TRUE(first == fileBytes(d / "out.bag"));
}

TEST_F(Tools, BuildMapMaps) {
  ASSERT_EQ(run("build_map " + d / "in.log" + " " +
                d / "map.yaml --poses odometry "
                    "--resolution 0.1 --json " +
                d / "out.json")
                .status,
            0);
  const OccupancyGrid grid = loadMap(d / "map.yaml");
  EXPECT_EQ(grid.geometry.resolution, 0.1);
  EXPECT_EQ(grid.valueOr(grid.geometry.cellAt({1.0, 0.5})), OccupancyGrid::kFree);
  EXPECT_EQ(nlohmann::json::parse(fileBytes(d / "out.json"))["scans"], 3);
}

TEST_F(Tools, BagsMayNameTheirTopicsAndFramesOtherwise) {
  const RobotLog log = readCarmenLog(d / "in.log");
  BagOptions named;
  named.scan_topic = "/front";
  named.odometry_topic = "/wheels";
  named.odom_frame = "robot/odom";
  named.base_frame = "robot/base";
  writeBag(d / "in.bag", log, named);
  {
    rosbag::Bag bag(d / "in.bag", rosbag::bagmode::Append);
    bag.write("/rear", toRosTime(1.0), toMsg(log.scans[0], "laser"));
  }
  const auto build = [&](const std::string& scans, const std::string& odometry,
                         const std::string& base) {
    return run("build_map " + (d / "in.bag") + " " + (d / "map.yaml") + " --poses odometry" +
               scans + odometry + base + " --odom-frame robot/odom --json " + (d / "out.json"));
  };
  const std::string scans = " --scan-topic front", odometry = " --odom-topic wheels",
                    base = " --base-frame robot/base";
  EXPECT_TRUE(refused(build("", odometry, base), "/front /rear"));
  EXPECT_TRUE(refused(build(" --scan-topic frnt", odometry, base), "there is no topic frnt"));
  EXPECT_TRUE(refused(build(scans, " --odom-topic typo", base), "only /wheels"));
  EXPECT_TRUE(refused(build(scans, odometry, ""),
                      "no transform leads to it from base_link; frames of the bag: laser robot"));
  EXPECT_TRUE(refused(build(scans, odometry, " --base-frame typo"), "from typo"));
  const ProgramRun r = build(scans, odometry, base);
  ASSERT_EQ(r.status, 0) << r.errors;
  EXPECT_EQ(nlohmann::json::parse(fileBytes(d / "out.json"))["scans"], 3);
}

TEST_F(Tools, HelpIsNoError) {
  EXPECT_EQ(run("carmen_to_bag --help").status, 0);
  EXPECT_EQ(run("build_map --help").status, 0);
}

TEST_F(Tools, WrongUsageIsStatus2) {
  EXPECT_TRUE(refused(run("carmen_to_bag"), "IN"));
  EXPECT_TRUE(refused(run("carmen_to_bag a b --no-such-option"), "--no-such-option"));
  EXPECT_TRUE(refused(run("carmen_to_bag a b --clock sun"), "--clock"));
  EXPECT_TRUE(refused(run("build_map a b"), "--poses"));
  EXPECT_TRUE(refused(run("build_map a b --poses odometry --resolution x"), "--resolution"));
}

TEST_F(Tools, UnreadableInputIsStatus2) {
  EXPECT_TRUE(refused(run("carmen_to_bag " + d / "none.log " + d / "o.bag"), "none.log"));
  writeFile(d / "bad.log", "");
  EXPECT_TRUE(refused(run("carmen_to_bag " + d / "bad.log " + d / "o.bag"), "no usable scan"));
  EXPECT_TRUE(
      refused(run("carmen_to_bag " + d / "in.log " + d / "o.bag --range-max -1"), "range_max"));
  EXPECT_TRUE(
      refused(run("build_map " + d / "none.bag " + d / "o.yaml --poses odometry"), "none.bag"));
  EXPECT_FALSE(std::filesystem::exists(d / "o.bag"));
}

TEST_F(Tools, UnwritableOutputIsStatus2) {
  const ProgramRun r = run("carmen_to_bag " + d / "in.log " + d / "none/o.bag");
  EXPECT_EQ(r.status, 2);
  EXPECT_NE(r.errors.find("\nerror: "), std::string::npos);  // after the warning of line 2
  EXPECT_EQ(run("carmen_to_bag " + d / "in.log " + d / "o.bag --json " + d / "none/o.json").status,
            2);
}

TEST_F(Tools, PosesThatDoNotFitTheLogAreRefused) {
  writeFile(d / "clean.log", scanLine(1, 0) + scanLine(2, 0.5));
  const std::string build = "build_map " + d / "clean.log " + d / "o.yaml --poses ";
  EXPECT_TRUE(refused(run(build + d / "none.tum"), "none.tum"));
  EXPECT_TRUE(refused(run(build + "ground_truth"), "no ground truth"));
  writeFile(d / "late.tum", "100 0 0 0 0 0 0 1\n");
  EXPECT_TRUE(refused(run(build + d / "late.tum"), "no scan falls into the time"));
  writeFile(d / "r.txt", "# scan_index\n0 0 0 0 0 0\n");
  EXPECT_TRUE(refused(run(build + d / "r.txt"), "1 poses for 2 scans"));
  EXPECT_TRUE(refused(run(build + "odometry --resolution 0"), "resolution"));
  EXPECT_TRUE(refused(run("build_map " + d / "clean.log " + d / "o.pgm --poses odometry"),
                      "name of the image"));
}

/// A program that fails with `error` after a part of its work.
ProgramRun runPartly(const std::string& json_path, const std::exception_ptr& error) {
  CLI::App app;
  const char* const arguments[] = {"partly", "--json", json_path.c_str()};
  ::testing::internal::CaptureStderr();
  ProgramRun r;
  r.status = runTool(3, arguments, app, [&]() -> nlohmann::json {
    throw PartialResult{{{"done", 1}}, error};
  });
  r.errors = ::testing::internal::GetCapturedStderr();
  return r;
}

TEST_F(Tools, APartialResultIsWrittenAndItsErrorTold) {
  const auto unusable = std::make_exception_ptr(InputError("talk.txt", "line 3", "is nothing"));
  const ProgramRun r = runPartly(d / "part.json", unusable);
  EXPECT_TRUE(refused(r, "line 3"));
  EXPECT_EQ(r.errors.find("cannot be written"), std::string::npos) << r.errors;
  EXPECT_EQ(nlohmann::json::parse(fileBytes(d / "part.json")), nlohmann::json({{"done", 1}}));
}

TEST_F(Tools, BothErrorsOfAPartialResultAreTold) {
  const auto unusable = std::make_exception_ptr(InputError("talk.txt", "line 3", "is nothing"));
  const ProgramRun r = runPartly(d / "none/part.json", unusable);
  EXPECT_TRUE(refused(r, "line 3"));
  EXPECT_TRUE(refused(r, "cannot be written"));
  EXPECT_TRUE(refused(r, "none/part.json"));
  // The first error decides on the status.
  const auto failed = std::make_exception_ptr(std::runtime_error("broken"));
  const ProgramRun other = runPartly(d / "none/part.json", failed);
  EXPECT_EQ(other.status, 1);
  EXPECT_EQ(other.errors.rfind("error: broken; ", 0), 0U) << other.errors;
}

}  // namespace
}  // namespace hyselam
