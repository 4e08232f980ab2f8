// The tools as a shell sees them: exit codes, one line of error, byte-identical bags.
#include <gtest/gtest.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <tf2_msgs/TFMessage.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "hyselam_common/map_io.hpp"
#include "hyselam_common/ros/bag_io.hpp"
#include "hyselam_common/testing/files.hpp"
#include "hyselam_common/testing/program_run.hpp"

namespace {

namespace fs = std::filesystem;

std::string content(const fs::path& path) {
  return hyselam::testing::fileBytes(path.string());
}

class Tools : public testing::Test {
 protected:
  fs::path file(const std::string& name) const { return directory_ / name; }

  int run(const std::string& tool, const std::string& arguments) {
    return hyselam::testing::runProgram("\"" HYSELAM_TOOLS "/" + tool + "\" " + arguments,
                                        directory_)
        .status;
  }
  int simulate(const std::string& arguments) { return run("simulate", arguments); }

  /// Of the program that ran last.
  void expectError(int status, const std::string& part) {
    EXPECT_TRUE(hyselam::testing::refused({status, "", content(file("stderr"))}, part));
  }

  hyselam::testing::TemporaryDirectory directory_;
};

TEST_F(Tools, EqualSeedsGiveEqualBytesAndOtherSeedsOthers) {
  for (const char* name : {"a", "b"}) {
    ASSERT_EQ(simulate("--plan small --route small --seed 5 --out " +
                       file(std::string(name) + ".bag").string()),
              0)
        << content(file("stderr"));
  }
  ASSERT_EQ(simulate("--plan small --route small --seed 6 --out " + file("c.bag").string()), 0);
  const std::string a = content(file("a.bag"));
  EXPECT_GT(a.size(), 100000U);
  EXPECT_TRUE(a == content(file("b.bag")));
  EXPECT_FALSE(a == content(file("c.bag")));
}

TEST_F(Tools, DrawsPilesBySeed) {
  for (const char* name : {"a", "b"}) {
    ASSERT_EQ(run("pile", "--seed 3 --things 3 --with mug --out " + file(name).string() +
                              " --json " + file("j.json").string()),
              0)
        << content(file("stderr"));
  }
  const std::string a = content(file("a.pcd"));
  EXPECT_GT(a.size(), 640U * 480U * 16U);
  EXPECT_TRUE(a == content(file("b.pcd")));
  EXPECT_TRUE(fs::exists(file("a.png")));
  const nlohmann::json json = nlohmann::json::parse(content(file("j.json")));
  EXPECT_EQ(json.at("things").size(), 3U);
  EXPECT_GE(json.at("visible").get<double>(), 0.4);
  EXPECT_EQ(json.at("thing_in_camera").size(), 4U);
  expectError(run("pile", "--with elephant --out " + file("c").string()), "elephant");
  expectError(run("pile", "--show mug --with tin --out " + file("c").string()), "");
}

TEST_F(Tools, FilmsARun) {
  ASSERT_EQ(simulate("--route small --out " + file("run.bag").string()), 0);
  const std::string options =
      " --route small --rate 0.5 --width 64 --height 48 --bag " + file("run.bag").string();
  for (const char* name : {"a", "b"}) {
    ASSERT_EQ(
        run("film", options + " --jpeg 90 --out " + file(std::string(name) + ".bag").string() +
                        " --images " + file(name).string() + " --json " + file("j.json").string()),
        0)
        << content(file("stderr"));
  }
  EXPECT_TRUE(content(file("a.bag")) == content(file("b.bag")));
  const std::string rows = content(file("a/labels.csv"));
  EXPECT_TRUE(rows == content(file("b/labels.csv")));
  EXPECT_EQ(rows.rfind("image_path,place,depth_path,stamp,x,y,theta,scan_0,", 0), 0U);
  EXPECT_NE(rows.find("rgb/00000.jpg,left room,depth/00000.png,"), std::string::npos);
  EXPECT_TRUE(fs::exists(file("a/rgb/00000.jpg")));
  EXPECT_TRUE(fs::exists(file("a/depth/00000.png")));
  // The run itself is still there, byte for byte.
  const hyselam::RobotLog run_log = hyselam::readBag(file("run.bag").string());
  const hyselam::RobotLog filmed = hyselam::readBag(file("a.bag").string());
  ASSERT_EQ(run_log.scans.size(), filmed.scans.size());
  EXPECT_EQ(run_log.scans.back().ranges, filmed.scans.back().ranges);
  EXPECT_EQ(run_log.ground_truth.size(), filmed.ground_truth.size());
  const auto json = nlohmann::json::parse(content(file("j.json")));
  EXPECT_GT(json["pictures"], 10);
}

TEST_F(Tools, TellsWhereTheCameraIsThoughTheRunTellsOfNoMounts) {
  ASSERT_EQ(simulate("--route small --out " + file("run.bag").string()), 0);
  {
    rosbag::Bag run(file("run.bag").string()),
        bare(file("bare.bag").string(), rosbag::bagmode::Write);
    for (const auto& message : rosbag::View(run)) {
      if (message.getTopic() == "/tf_static") continue;
      bare.write(message.getTopic(), message.getTime(), message, message.getConnectionHeader());
    }
  }
  for (const char* name : {"run", "bare"}) {
    ASSERT_EQ(run("film", "--route small --rate 0.1 --width 64 --height 48 --bag " +
                              file(std::string(name) + ".bag").string() + " --out " +
                              file("filmed.bag").string()),
              0)
        << content(file("stderr"));
    rosbag::Bag filmed(file("filmed.bag").string());
    int found = 0;
    for (const auto& message : rosbag::View(filmed, rosbag::TopicQuery("/tf_static"))) {
      const auto fixed = message.instantiate<tf2_msgs::TFMessage>();
      ASSERT_TRUE(fixed);
      EXPECT_EQ(message.getConnectionHeader()->at("latching"), "1");
      for (const auto& t : fixed->transforms) found += t.child_frame_id == "camera_optical_frame";
    }
    EXPECT_EQ(found, 1) << name;
  }
}

TEST_F(Tools, RefusesToFilmWhatCannotBeFilmed) {
  expectError(run("film", "--route small --bag " + file("none.bag").string() + " --out " +
                              file("o.bag").string()),
              "none.bag");
  ASSERT_EQ(simulate("--route small --out " + file("run.bag").string()), 0);
  expectError(run("film", "--route small --bag " + file("run.bag").string()), "--out");
  expectError(run("film", "--route small --width 3 --bag " + file("run.bag").string() + " --out " +
                              file("o.bag").string()),
              "width");
  expectError(run("film", "--route small --things none.yaml --bag " + file("run.bag").string() +
                              " --out " + file("o.bag").string()),
              "none.yaml");
  EXPECT_FALSE(fs::exists(file("o.bag")));
}

TEST_F(Tools, WritesBagMapPictureAndJson) {
  ASSERT_EQ(simulate("--route small --out " + file("o.bag").string() + " --map " +
                     file("m.yaml").string() + " --resolution 0.05 --picture " +
                     file("p.png").string() + " --json " + file("j.json").string()),
            0)
      << content(file("stderr"));
  const hyselam::RobotLog log = hyselam::readBag(file("o.bag").string());
  const auto json = nlohmann::json::parse(content(file("j.json")));
  EXPECT_EQ(json["scans"], log.scans.size());
  EXPECT_EQ(log.ground_truth.size(), log.odometry.size());
  EXPECT_NEAR(log.scans.at(0).laser_in_base.x, 0.1, 1e-9);
  EXPECT_GT(json["times_real_time"], 1.0);
  EXPECT_EQ(hyselam::loadMap(file("m.yaml").string()).geometry.width, 180);
  EXPECT_GT(fs::file_size(file("p.png")), 1000U);
}

TEST_F(Tools, PlanToMapWritesTheMap) {
  ASSERT_EQ(run("plan_to_map", "mcl_c " + file("m.yaml").string()), 0) << content(file("stderr"));
  const hyselam::OccupancyGrid grid = hyselam::loadMap(file("m.yaml").string());
  EXPECT_EQ(grid.geometry.width, 262);
  EXPECT_EQ(grid.geometry.origin.x, -0.6);
}

TEST_F(Tools, Help) {
  EXPECT_EQ(simulate("--help"), 0);
  EXPECT_EQ(run("plan_to_map", "--help"), 0);
}

TEST_F(Tools, BadUsage) {
  expectError(simulate("--plan small"), "--");
}
TEST_F(Tools, UnknownPlan) {
  expectError(simulate("--plan smal --route small --out " + file("o.bag").string()),
              "did you mean 'small'?");
}
TEST_F(Tools, MissingRouteFile) {
  expectError(simulate("--route nowhere.yaml --out " + file("o.bag").string()), "nowhere.yaml");
}
TEST_F(Tools, UnwritableBag) {
  expectError(simulate("--route small --out /nowhere/o.bag"), "/nowhere/o.bag");
}
TEST_F(Tools, UnknownPictureFormat) {
  expectError(simulate("--route small --out " + file("o.bag").string() + " --picture " +
                       file("p.xyz").string()),
              "p.xyz");
}
TEST_F(Tools, BadResolution) {
  expectError(run("plan_to_map", "small " + file("m.yaml").string() + " --resolution -1"),
              "resolution");
}
TEST_F(Tools, RouteOfAnotherPlan) {
  expectError(simulate("--plan small --route mcl_b --out " + file("o.bag").string()),
              "key 'start'");
}

TEST_F(Tools, GeneratedPlansBecomeMaps) {
  const std::string plan = file("plan.yaml").string();
  ASSERT_EQ(run("generate_plan", plan + " --seed 4 --furniture --rotation 10"), 0)
      << content(file("stderr"));
  ASSERT_EQ(run("plan_to_map", plan + " " + file("map.yaml").string()), 0)
      << content(file("stderr"));
  EXPECT_GT(hyselam::loadMap(file("map.yaml").string()).geometry.width, 100);
}

TEST_F(Tools, PlansThatCannotBeGeneratedAreRefused) {
  const std::string plan = file("plan.yaml").string();
  expectError(run("generate_plan", plan + " --min-door 0.2"), "min_door");
  expectError(run("generate_plan", plan + " --max-door 0.6"), "max_door");
  expectError(run("generate_plan", plan + " --layout castle"), "castle");
  expectError(run("generate_plan", plan + " --seed one"), "seed");
  expectError(run("generate_plan", file("missing/plan.yaml").string()), "missing");
  EXPECT_FALSE(fs::exists(plan));
}

}  // namespace
