// findModel and its program on drawn tables: no data of others.
#include <gtest/gtest.h>

#include <fstream>
#include <limits>
#include <string>

#include "../bench/table_scenes.hpp"
#include "hyselam_common/testing/files.hpp"
#include "hyselam_common/testing/program_run.hpp"
#include "hyselam_objects/pcl/cloud_io.hpp"
#include "hyselam_objects/pcl/find_model.hpp"
#include "hyselam_objects/segmentation/segment_cloud.hpp"
#include "nlohmann/json.hpp"

using namespace hyselam_objects;  // NOLINT: a test, not a header
using hyselam::testing::fileBytes;
using hyselam::testing::TemporaryDirectory;

namespace {

constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();

/// What is nearer than `distance` along the optical axis.
OrganizedCloud within(OrganizedCloud cloud, float distance) {
  for (Point& p : cloud.points) {
    if (!(p.z() < distance)) p.setConstant(kNothing);
  }
  return cloud;
}

/// The thing with most points on a table.
OrganizedCloud largestThing(const OrganizedCloud& scene) {
  const CloudSegmentation found = segmentCloud(scene);
  std::vector<int> sizes(1000, 0);
  for (const auto label : found.labels) {
    if (label > 1 && label < 1000) ++sizes[static_cast<std::size_t>(label)];
  }
  const auto largest = std::max_element(sizes.begin(), sizes.end()) - sizes.begin();
  OrganizedCloud thing = scene;
  for (std::size_t i = 0; i < thing.size(); ++i) {
    if (found.labels[i] != static_cast<decltype(found.labels[i])>(largest)) {
      thing.points[i].setConstant(kNothing);
    }
  }
  return thing;
}

int shell(const std::string& arguments, const TemporaryDirectory& directory) {
  return hyselam::testing::runProgram(HYSELAM_TOOLS "/find_model " + arguments, directory).status;
}

TEST(FindModel, FarPointsThatAreTooFewToBeDescribedChangeNothing) {
  // A wall 5 m behind the table, where the noise of a depth is several centimetres.
  const OrganizedCloud scene = drawTable(2), table = within(scene, 2.2f);
  const OrganizedCloud model = largestThing(table);
  FindModelParams all;
  all.min_probability = 0.0;
  const auto with = findModel(model, scene, all), without = findModel(model, table, all);
  ASSERT_FALSE(with.empty());
  ASSERT_FALSE(without.empty());
  EXPECT_EQ(with[0].correspondences, without[0].correspondences);
  EXPECT_TRUE(with[0].model_in_scene.isApprox(without[0].model_in_scene, 1e-6));
  // Of these there are poses that fit: where the thing is.
  EXPECT_LT(with[0].model_in_scene.translation().norm(), 0.01);
}

TEST(FindModel, FindsNothingWhereThereAreOnlyScatteredPoints) {
  const OrganizedCloud model = largestThing(within(drawTable(2), 2.2f));
  OrganizedCloud scattered;
  hyselam::Rng rng(3);
  for (int i = 0; i < 2000; ++i) {
    scattered.points.emplace_back(static_cast<float>(rng.uniform(-3.0, 3.0)),
                                  static_cast<float>(rng.uniform(-3.0, 3.0)),
                                  static_cast<float>(rng.uniform(2.0, 8.0)));
  }
  scattered.width = 2000;
  scattered.height = 1;
  EXPECT_TRUE(findModel(model, scattered).empty());
}

TEST(FindModelTool, TellsPosesAndWritesJson) {
  const TemporaryDirectory directory;
  const OrganizedCloud scene = within(drawTable(2), 2.2f);
  const std::vector<std::uint32_t> labels(scene.size(), 0);
  writePcd(directory / "scene.pcd", scene, labels);
  writePcd(directory / "model.pcd", largestThing(scene), labels);
  ASSERT_EQ(shell((directory / "model.pcd") + " " + (directory / "scene.pcd") +
                      " --min-probability 0 --json " + (directory / "j.json"),
                  directory),
            0)
      << fileBytes(directory / "stderr");
  EXPECT_EQ(fileBytes(directory / "stdout").substr(0, 6), "found ");
  std::ifstream file(directory / "j.json");
  const nlohmann::json json = nlohmann::json::parse(file);
  ASSERT_FALSE(json.at("found").empty());
  for (const auto& found : json.at("found")) {
    EXPECT_EQ(found.at("model_in_scene").size(), 4u);
    EXPECT_GE(found.at("probability").get<double>(), 0.0);
    EXPECT_LE(found.at("probability").get<double>(), 1.0);
  }
}

TEST(FindModelTool, SaysWhatIsWrongWithItsFiles) {
  const TemporaryDirectory directory;
  std::ofstream(directory / "broken.pcd") << "not a cloud\n";
  EXPECT_EQ(shell((directory / "broken.pcd") + " " + (directory / "none.pcd"), directory), 2);
  EXPECT_NE(fileBytes(directory / "stderr").find("broken.pcd"), std::string::npos)
      << fileBytes(directory / "stderr");
}

}  // namespace
