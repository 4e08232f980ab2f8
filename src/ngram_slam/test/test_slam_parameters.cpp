// What is written about parameters of NgramSlam is what the code does: README.md and
// config/slam.yaml hold every one with its default.
#include <gtest/gtest.h>

#include <regex>
#include <set>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/testing/files.hpp"
#include "ngram_slam/ros/slam_parameters.hpp"
#include "written_parameters.hpp"

using namespace ngram_slam;  // NOLINT: a test, not a header
using hyselam::MapParamSource;
using hyselam::ParamLoader;
using Values = std::map<std::string, XmlRpc::XmlRpcValue>;

namespace {

SlamServerParams load(const Values& values, std::string* table = nullptr) {
  ParamLoader loader(std::make_shared<MapParamSource>(values));
  const SlamServerParams p = loadSlamParams(loader);
  if (table != nullptr) *table = loader.table();
  return p;
}

/// Names and defaults.
std::map<std::string, std::string> defaults() {
  std::string table;
  load({}, &table);
  return valuesOf(table);
}

}  // namespace

TEST(SlamParameters, ReadmeHasThemAll) {
  const std::string readme = written("README.md");
  const std::string section = readme.substr(readme.find("## NgramSlam"));
  const auto all = defaults();
  EXPECT_GT(all.size(), 25U);
  for (const auto& [name, value] : all)
    EXPECT_NE(section.find("| `" + name + "` | " + (value.empty() ? "(empty)" : value) + " |"),
              std::string::npos)
        << name << " = " << value;
}

TEST(SlamParameters, FileHasThemAllAndNoOther) {
  const std::string yaml = written("config/slam.yaml");
  const auto all = defaults();
  // These are arguments of the launch file.
  std::set<std::string> found = {"global_frame_id", "odom_frame_id", "base_frame_id",
                                 "state",           "resolution",    "loops"};
  const std::regex line("\n([a-z_]+): +([^ \n]+)");
  for (std::sregex_iterator i(yaml.begin(), yaml.end(), line), end; i != end; ++i) {
    const std::string name = (*i)[1], value = (*i)[2];
    ASSERT_EQ(all.count(name), 1u) << name;
    found.insert(name);
    if (std::isdigit(static_cast<unsigned char>(value[0])) != 0)
      EXPECT_EQ(std::stod(value), std::stod(all.at(name))) << name;
    else
      EXPECT_EQ(value, all.at(name)) << name;
  }
  for (const auto& [name, value] : all) EXPECT_EQ(found.count(name), 1u) << name << " " << value;
}

TEST(SlamParameters, DefaultsAreThoseOfTheEngine) {
  const SlamParams engine, loaded = load({}).slam;
  EXPECT_EQ(loaded.keyframe_step, engine.keyframe_step);
  EXPECT_EQ(loaded.loops, engine.loops);
  EXPECT_EQ(loaded.surface.max_range, engine.surface.max_range);
}

TEST(SlamParameters, InitialPoseIsTakenAsAWhole) {
  EXPECT_FALSE(load({}).initial_pose);
  Values values;
  values["initial_pose_x"] = 2.5;
  const auto pose = load(values).initial_pose;
  ASSERT_TRUE(pose);
  EXPECT_EQ(pose->base_in_map.x, 2.5);
  EXPECT_EQ(pose->base_in_map.theta, 0.0);
}

TEST(SlamParameters, OutOfRangeNamesParameterAndValue) {
  const auto refusal = [](const std::string& name, const XmlRpc::XmlRpcValue& value) {
    Values values;
    values[name] = value;
    return hyselam::testing::messageOf<hyselam::ParameterError>([&] { load(values); });
  };
  for (const char* name : {"resolution", "keyframe_step", "max_range", "longest_step"})
    EXPECT_NE(refusal(name, -1.0).find(name), std::string::npos) << name;
  for (const double window : {0.0, 51.0})
    EXPECT_NE(refusal("start_window", window).find("start_window"), std::string::npos) << window;
  EXPECT_NE(refusal("loops", "maybe").find("maybe"), std::string::npos);
  EXPECT_NE(refusal("global_frame_id", "odom").find("global_frame_id"), std::string::npos);
  EXPECT_NE(refusal("state", "/no/such/folder/x").find("existing folder"), std::string::npos);
}
