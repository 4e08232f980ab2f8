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
#include "hyselam_sim/pile.hpp"
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

/// Depth in millimetres of a camera as a Kinect's.
OrganizedCloud cloudOf(const hyselam_sim::CameraParams& camera,
                       const hyselam_sim::CameraFrame& frame) {
  OrganizedCloud out;
  out.width = camera.width;
  out.height = camera.height;
  const auto focal = static_cast<float>(camera.focalLength());
  for (int v = 0; v < out.height; ++v) {
    for (int u = 0; u < out.width; ++u) {
      const float mm = frame.depth.at<std::uint16_t>(v, u);
      const float z = mm > 0.0f ? 0.001f * mm : kNothing;
      out.points.emplace_back((static_cast<float>(u) - 319.5f) * z / focal,
                              (static_cast<float>(v) - 239.5f) * z / focal, z);
    }
  }
  return out;
}

Eigen::Isometry3f isometryOf(const hyselam_sim::Pose3& pose) {
  Eigen::Isometry3f out = Eigen::Isometry3f::Identity();
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) out(r, c) = static_cast<float>(pose.turn(r, c));
    out(r, 3) = static_cast<float>(pose.at[r]);
  }
  return out;
}

hyselam_sim::CameraParams kinect() {
  hyselam_sim::CameraParams camera;
  camera.view = 2.0 * std::atan(320.0 / 525.0);
  return camera;
}

std::vector<PlacedView> viewsAround(const hyselam_sim::PlacedArticle& thing, int count) {
  std::vector<PlacedView> out;
  hyselam::Rng rng(1);
  for (int i = 0; i < count; ++i) {
    const hyselam_sim::Pose3 pose =
        hyselam_sim::cameraAround(2.0 * hyselam::kPi * i / count, 0.7, 0.7);
    out.push_back({cloudOf(kinect(), viewOfPile(kinect(), {thing}, pose, rng)), isometryOf(pose)});
  }
  return out;
}

TEST(LearnModel, JoinsWhatStandsOnTheTable) {
  const auto thing = hyselam_sim::standing(hyselam_sim::householdThing("drill"));
  const SurfaceModel model = learnModel(viewsAround(thing, 3));
  ASSERT_GT(model.cloud.size(), 10000u);
  ASSERT_EQ(model.seen_from.size(), model.cloud.size());
  std::size_t near = 0;
  std::vector<Point> cameras;
  for (std::size_t i = 0; i < model.cloud.size(); ++i) {
    const Point& p = model.cloud.points[i];
    const cv::Vec3d at{p.x(), p.y(), p.z()};
    near += thing.article->distance(thing.pose.inverse() * at) < 0.005;
    if (cameras.empty() || cameras.back() != model.seen_from[i]) {
      cameras.push_back(model.seen_from[i]);
    }
  }
  EXPECT_GT(static_cast<double>(near), 0.98 * static_cast<double>(model.cloud.size()));
  EXPECT_EQ(cameras.size(), 3u);

  const TemporaryDirectory directory;
  writePcd(directory / "model.pcd", model.cloud, std::vector<std::uint32_t>(model.cloud.size(), 2),
           model.seen_from);
  EXPECT_EQ(readPcd(directory / "model.pcd").seen_from, model.seen_from);
}

TEST(LearnModel, RefusesViewsOfNothing) {
  EXPECT_THROW(learnModel({}), hyselam::InputError);
  hyselam::Rng rng(1);
  const hyselam_sim::Pose3 pose = hyselam_sim::cameraAround(0.0, 0.7, 0.7);
  const OrganizedCloud table = cloudOf(kinect(), viewOfPile(kinect(), {}, pose, rng));
  EXPECT_THROW(learnModel({{table, isometryOf(pose)}}), hyselam::InputError);
}

TEST(FindModel, FindsAModelOfSeveralViewsFromAnotherSide) {
  const auto thing = hyselam_sim::standing(hyselam_sim::householdThing("drill"));
  SurfaceModel model = learnModel(viewsAround(thing, 6));
  hyselam::Rng rng(2);
  const hyselam_sim::Pose3 pose = hyselam_sim::cameraAround(1.2, 0.85, 0.8);
  const OrganizedCloud scene = cloudOf(kinect(), viewOfPile(kinect(), {thing}, pose, rng));
  FindModelParams params;  // for a small thing
  params.scene_sampling = 0.01;
  params.descriptor_radius = 0.045;
  const auto found = findModel(model, scene, params);
  ASSERT_FALSE(found.empty());
  // The model's frame is the table's.
  const Eigen::Isometry3d table = isometryOf(pose.inverse()).cast<double>();
  const Eigen::Isometry3d off = table.inverse() * found[0].model_in_scene;
  EXPECT_LT(off.translation().norm(), 0.02);
  EXPECT_LT(Eigen::AngleAxisd(off.linear()).angle(), 0.1);
  // As if all of it had been seen from the middle of the table, its normals point inwards.
  model.seen_from.clear();
  EXPECT_TRUE(findModel(model, scene, params).empty());
}

/// A pile as a camera sees it from some sides, all poses of it in the table's frame.
std::vector<PlacedView> looksAt(const std::vector<hyselam_sim::PlacedArticle>& pile, int count) {
  std::vector<PlacedView> out;
  hyselam::Rng rng(7);
  for (int i = 0; i < count; ++i) {
    const hyselam_sim::Pose3 pose =
        hyselam_sim::cameraAround(0.3 + 2.0 * hyselam::kPi * i / count, 0.9, 0.85);
    out.push_back({cloudOf(kinect(), viewOfPile(kinect(), pile, pose, rng)), isometryOf(pose)});
  }
  return out;
}

TEST(FindModel, LooksFromSeveralSidesAreJudgedTogether) {
  const auto thing = hyselam_sim::standing(hyselam_sim::householdThing("drill"));
  const SurfaceModel model = learnModel(viewsAround(thing, 6));
  std::vector<PlacedView> looks = looksAt({thing}, 3);
  FindModelParams all;
  all.min_probability = 0.0;
  const auto found = findModel(model, looks, all);
  ASSERT_FALSE(found.empty());
  // The model's frame is the table's, and so is that of the looks.
  EXPECT_LT(found[0].model_in_scene.translation().norm(), 0.02);
  EXPECT_LT(Eigen::AngleAxisd(found[0].model_in_scene.linear()).angle(), 0.1);
  EXPECT_GE(found[0].looks, 2);
  EXPECT_LE(found[0].looks, 3);
  // One that sees nothing there speaks against it.
  hyselam::Rng rng(8);
  const hyselam_sim::Pose3 pose = hyselam_sim::cameraAround(2.0, 0.9, 0.85);
  looks.push_back({cloudOf(kinect(), viewOfPile(kinect(), {}, pose, rng)), isometryOf(pose)});
  const auto doubted = findModel(model, looks, all);
  ASSERT_FALSE(doubted.empty());
  EXPECT_LT(doubted[0].coverage, found[0].coverage - 0.1);
  EXPECT_LT(doubted[0].probability, found[0].probability);
}

TEST(FindModel, OneLookIsTheSceneInItsFrame) {
  const auto thing = hyselam_sim::standing(hyselam_sim::householdThing("drill"));
  const SurfaceModel model = learnModel(viewsAround(thing, 6));
  const PlacedView look = looksAt({thing}, 1)[0];
  FindModelParams all;
  all.min_probability = 0.0;
  const auto alone = findModel(model, look.cloud, all), placed = findModel(model, {look}, all);
  ASSERT_FALSE(alone.empty());
  ASSERT_EQ(placed.size(), alone.size());
  const Eigen::Isometry3d camera = look.camera.cast<double>();
  EXPECT_TRUE(placed[0].model_in_scene.isApprox(camera * alone[0].model_in_scene, 1e-4));
  EXPECT_EQ(placed[0].correspondences, alone[0].correspondences);
  EXPECT_NEAR(placed[0].coverage, alone[0].coverage, 0.01);
}

TEST(FindModel, RefusesLooksThatAreNone) {
  const OrganizedCloud scene = drawTable(2);
  const SurfaceModel model{largestThing(within(scene, 2.2f)), {}};
  EXPECT_THROW(findModel(model, std::vector<PlacedView>{}), hyselam::InputError);
  OrganizedCloud around;  // behind the origin and before it
  hyselam::Rng rng(3);
  for (int i = 0; i < 2000; ++i) {
    around.points.emplace_back(static_cast<float>(rng.uniform(-3.0, 3.0)),
                               static_cast<float>(rng.uniform(-3.0, 3.0)),
                               static_cast<float>(rng.uniform(-3.0, 3.0)));
  }
  around.width = 2000;
  around.height = 1;
  const Eigen::Isometry3f here = Eigen::Isometry3f::Identity();
  EXPECT_THROW(findModel(model, {{scene, here}, {around, here}}), hyselam::InputError);
}

/// scene.pcd, which it returns, and model.pcd: a thing of it.
OrganizedCloud writeSceneAndModel(const TemporaryDirectory& directory) {
  OrganizedCloud scene = within(drawTable(2), 2.2f);
  const std::vector<std::uint32_t> labels(scene.size(), 0);
  writePcd(directory / "scene.pcd", scene, labels);
  writePcd(directory / "model.pcd", largestThing(scene), labels);
  return scene;
}

TEST(FindModelTool, TellsPosesAndWritesJson) {
  const TemporaryDirectory directory;
  const OrganizedCloud scene = writeSceneAndModel(directory);
  ASSERT_EQ(shell((directory / "model.pcd") + " " + (directory / "scene.pcd") +
                      " --min-probability 0 --json " + (directory / "j.json"),
                  directory),
            0)
      << fileBytes(directory / "stderr");
  EXPECT_EQ(fileBytes(directory / "stdout").substr(0, 6), "found ");
  EXPECT_NE(fileBytes(directory / "stdout").find(": centre at "), std::string::npos);
  std::ifstream file(directory / "j.json");
  const nlohmann::json json = nlohmann::json::parse(file);
  ASSERT_FALSE(json.at("found").empty());
  // The model is a part of the scene, left where it was: so its centre is the mean of its points.
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  const OrganizedCloud model = largestThing(scene);
  std::size_t count = 0;
  for (std::size_t i = 0; i < model.size(); ++i) {
    if (!model.isValid(i)) continue;
    mean += model.points[i].cast<double>();
    ++count;
  }
  mean /= static_cast<double>(count);
  const auto centre = json.at("found")[0].at("centre_in_scene").get<std::vector<double>>();
  ASSERT_EQ(centre.size(), 3u);
  EXPECT_LT((Eigen::Vector3d(centre.data()) - mean).norm(), 0.01);
  for (const auto& found : json.at("found")) {
    EXPECT_EQ(found.at("model_in_scene").size(), 4u);
    EXPECT_GE(found.at("probability").get<double>(), 0.0);
    EXPECT_LE(found.at("probability").get<double>(), 1.0);
  }
}

TEST(FindModelTool, SeveralLooksNeedTheirPoses) {
  const TemporaryDirectory directory;
  writeSceneAndModel(directory);
  const std::string call =
      (directory / "model.pcd") + " " + (directory / "scene.pcd") + " " + (directory / "scene.pcd");
  EXPECT_EQ(shell(call, directory), 2);
  EXPECT_NE(fileBytes(directory / "stderr").find("--poses"), std::string::npos);
  std::ofstream(directory / "one.tum") << "0 0 0 0 0 0 0 1\n";
  EXPECT_EQ(shell(call + " --poses " + (directory / "one.tum"), directory), 2);
  EXPECT_NE(fileBytes(directory / "stderr").find("1 poses for 2 views"), std::string::npos);
  std::ofstream(directory / "two.tum") << "0 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n";
  EXPECT_EQ(shell(call + " --poses " + (directory / "two.tum"), directory), 0)
      << fileBytes(directory / "stderr");
}

TEST(FindModelTool, SaysWhatIsWrongWithItsFiles) {
  const TemporaryDirectory directory;
  std::ofstream(directory / "broken.pcd") << "not a cloud\n";
  EXPECT_EQ(shell((directory / "broken.pcd") + " " + (directory / "none.pcd"), directory), 2);
  EXPECT_NE(fileBytes(directory / "stderr").find("broken.pcd"), std::string::npos)
      << fileBytes(directory / "stderr");
}

}  // namespace
