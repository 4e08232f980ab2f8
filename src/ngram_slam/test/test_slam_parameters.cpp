// The parameters of NgramSlam: each loadable with the default of the engine, refused out of range;
// README.md holds those of no group with their defaults, config/slam.yaml all.
#include <gtest/gtest.h>

#include <regex>
#include <set>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/testing/files.hpp"
#include "ngram_slam/ros/slam_parameters.hpp"
#include "written_parameters.hpp"

using namespace ngram_slam;  // NOLINT: a test, not a header

namespace {

SlamServerParams load(const Values& values) {
  return loadFrom(loadSlamParams, values);
}

std::map<std::string, std::string> defaults() {
  return defaultsOf(loadSlamParams);
}

}  // namespace

TEST(SlamParameters, readmeHasThemAll) {
  const std::string readme = written("README.md");
  const std::string section = readme.substr(readme.find("## NgramSlam"));
  const auto all = defaults();
  EXPECT_GT(all.size(), 25U);
  for (const auto& [name, value] : all) {
    if (name.find('/') != std::string::npos) continue;  // in docs/parameters.md
    EXPECT_NE(section.find("| `" + name + "` | " + (value.empty() ? "(empty)" : value) + " |"),
              std::string::npos)
        << name << " = " << value;
  }
}

TEST(SlamParameters, fileHasThemAllAndNoOther) {
  const std::string yaml = written("config/slam.yaml");
  const auto all = defaults();
  std::set<std::string> found;
  // Commented out: arguments of the launch file, or without a default.
  const std::regex line("\n(?:# )?([a-z_/]+):(?: +([^ \n]+))?(?=\n)");
  for (std::sregex_iterator i(yaml.begin(), yaml.end(), line), end; i != end; ++i) {
    const std::string name = (*i)[1], value = (*i)[2];
    ASSERT_EQ(all.count(name), 1u) << name;
    found.insert(name);
    if (!value.empty() && std::isdigit(static_cast<unsigned char>(value[0])) != 0) {
      EXPECT_NEAR(std::stod(value), std::stod(all.at(name)), 1e-5 * std::stod(value)) << name;
    }
  }
  for (const auto& [name, value] : all) EXPECT_EQ(found.count(name), 1u) << name << " " << value;
}

TEST(SlamParameters, defaultsAreThoseOfTheEngine) {
  const SlamParams engine, loaded = load({}).slam;
  EXPECT_EQ(loaded.keyframe_step, engine.keyframe_step);
  EXPECT_EQ(loaded.loops, engine.loops);
  EXPECT_EQ(loaded.surface.max_range, engine.surface.max_range);
  SlamParams described = engine, described_loaded = loaded;
  const auto rows = hyselam::parameterRows(described);
  const auto loaded_rows = hyselam::parameterRows(described_loaded);
  ASSERT_EQ(rows.size(), loaded_rows.size());
  EXPECT_GT(rows.size(), 80U);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(rows[i].default_yaml, loaded_rows[i].default_yaml) << rows[i].name;
  }
}

TEST(SlamParameters, everyThresholdOfTheEngineCanBeSet) {
  Values values;
  values["loop/min_consistent_loops"] = 3;
  values["loop/near_min_score"] = 0.7;
  values["relocalization/min_points"] = 50;
  values["run_start/map_radius"] = 20.0;
  values["jump_information"] = 0.5;
  values["odometry/position_base"] = 0.02;
  const SlamParams p = load(values).slam;
  EXPECT_EQ(p.loop.min_consistent_loops, 3);
  EXPECT_EQ(p.loop.near_min_score, 0.7);
  EXPECT_EQ(p.relocalization.min_points, 50);
  EXPECT_EQ(p.run_start.map_radius, 20.0);
  EXPECT_EQ(p.jump_information, 0.5);
  EXPECT_EQ(p.odometry.position_base, 0.02);
}

TEST(SlamParameters, formerNamesStillWork) {
  Values values;
  values["longest_step"] = 3.0;
  values["optimise_every"] = 10;
  values["start_turn"] = 0.25;
  const SlamServerParams p = load(values);
  EXPECT_EQ(p.slam.max_odometry_step, 3.0);
  EXPECT_EQ(p.slam.optimize_interval, 10);
  EXPECT_EQ(p.start_angle, 0.25);
}

TEST(SlamParameters, initialPoseIsTakenAsAWhole) {
  EXPECT_FALSE(load({}).initialPose());
  Values values;
  values["initial_pose_x"] = 2.5;
  const auto pose = load(values).initialPose();
  ASSERT_TRUE(pose);
  EXPECT_EQ(pose->base_in_map.x, 2.5);
  EXPECT_EQ(pose->base_in_map.theta, 0.0);
}

TEST(SlamParameters, outOfRangeNamesParameterAndValue) {
  const auto refusal = [](const std::string& name, const XmlRpc::XmlRpcValue& value) {
    Values values;
    values[name] = value;
    return hyselam::testing::messageOf<hyselam::ParameterError>([&] { load(values); });
  };
  for (const char* name : {"resolution", "keyframe_step", "max_range", "max_odometry_step"})
    EXPECT_NE(refusal(name, -1.0).find(name), std::string::npos) << name;
  for (const double window : {0.0, 51.0})
    EXPECT_NE(refusal("start_window", window).find("start_window"), std::string::npos) << window;
  EXPECT_NE(refusal("loops", "maybe").find("maybe"), std::string::npos);
  EXPECT_NE(refusal("global_frame_id", "odom").find("global_frame_id"), std::string::npos);
  for (const char* part : {"existing folder", "/no/such/folder is none", "work_dir"})
    EXPECT_NE(refusal("state", "/no/such/folder/x").find(part), std::string::npos) << part;
}
