// ObjectRecognition: descriptors of views of simulated things, and a real model found in a real
// scene.
#include <gtest/gtest.h>

#include <iostream>
#include <limits>

#include "../bench/model_scenes.hpp"
#include "../src/pcl/model_evidence.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/rng.hpp"
#include "hyselam_common/testing/files.hpp"
#include "hyselam_objects/pcl/cloud_io.hpp"
#include "hyselam_objects/pcl/find_model.hpp"
#include "hyselam_objects/recognition/object_descriptor.hpp"

using namespace hyselam_objects;  // NOLINT: a test, not a header

namespace {

/// The two sides of a box that somebody sees who looks at one of its edges.
std::vector<Eigen::Vector3f> boxView(Eigen::Vector3f size, double turn, hyselam::Rng& rng) {
  std::vector<Eigen::Vector3f> points;
  const Eigen::AngleAxisf rotation(static_cast<float>(turn), Eigen::Vector3f::UnitZ());
  for (int i = 0; i < 600; ++i) {
    const auto u = static_cast<float>(rng.uniform()), v = static_cast<float>(rng.uniform());
    Eigen::Vector3f p = i % 2 == 0 ? Eigen::Vector3f(u * size.x(), 0.0f, v * size.z())
                                   : Eigen::Vector3f(0.0f, u * size.y(), v * size.z());
    p += 0.002f * Eigen::Vector3f(static_cast<float>(rng.gaussian()),
                                  static_cast<float>(rng.gaussian()),
                                  static_cast<float>(rng.gaussian()));
    points.push_back(rotation * p);
  }
  return points;
}

std::vector<float> view(Eigen::Vector3f size, std::uint32_t color, double turn,
                        std::uint64_t seed) {
  hyselam::Rng rng(seed);
  const auto points = boxView(size, turn, rng);
  return describeView(points, std::vector<std::uint32_t>(points.size(), color));
}

ObjectDictionary twoBoxes() {
  ObjectDictionary dictionary;
  std::vector<std::vector<float>> carton, brick;
  for (std::uint64_t i = 0; i < 12; ++i) {
    carton.push_back(view({0.2f, 0.08f, 0.3f}, 0xd0c020, 0.5 * static_cast<double>(i), i));
    brick.push_back(view({0.24f, 0.11f, 0.07f}, 0xb03020, 0.5 * static_cast<double>(i), 100 + i));
  }
  dictionary.put(learnObject("carton", carton, {{0.08, 0.2, 0.3}}));
  dictionary.put(learnObject("brick", brick, {}));
  return dictionary;
}

}  // namespace

TEST(ObjectRecognition, RecognizesNewViewsAndRejectsOtherObjects) {
  const ObjectDictionary dictionary = twoBoxes();
  checkDictionary(dictionary, "learnt");
  EXPECT_DOUBLE_EQ(dictionary.find("carton")->shape.size[0], 0.2) << "the longer side first";
  int right = 0;
  for (std::uint64_t i = 0; i < 20; ++i) {
    const double turn = 0.3 * static_cast<double>(i) + 0.1;
    const auto a = recognizeObject(view({0.2f, 0.08f, 0.3f}, 0xd0c020, turn, 500 + i), dictionary);
    const auto b =
        recognizeObject(view({0.24f, 0.11f, 0.07f}, 0xb03020, turn, 600 + i), dictionary);
    right += (a && a->name == "carton") + (b && b->name == "brick");
    EXPECT_FALSE(recognizeObject(view({0.5f, 0.5f, 0.6f}, 0x2040c0, turn, 700 + i), dictionary));
  }
  EXPECT_GE(right, 38);
}

TEST(ObjectRecognition, WorksWithADictionaryFromAFile) {
  const ObjectDictionary other = dictionaryFromXml(toXml(twoBoxes()));
  const auto found = recognizeObject(view({0.2f, 0.08f, 0.3f}, 0xd0c020, 0.7, 900), other);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->name, "carton");
}

TEST(ObjectRecognition, RefusesViewsThatCannotBeLearned) {
  EXPECT_THROW(learnObject("cup", {}, {}), hyselam::InputError);
  EXPECT_THROW(learnObject("cup", {{1.0f, 2.0f}}, {}), hyselam::InputError);
  EXPECT_TRUE(describeView({}, {}).empty());
  EXPECT_FALSE(recognizeObject({}, twoBoxes()));
  EXPECT_FALSE(recognizeObject(view({0.2f, 0.1f, 0.3f}, 0, 0.0, 1), {}));
}

// Of a closed box the camera sees the front; its own back is hidden by it, and tells nothing.
TEST(ObjectRecognition, HidesTheBackOfAModelByItsFront) {
  constexpr float kFocal = 525.0f, kFront = 0.8f, kBack = 0.95f, kHalf = 0.1f, kWall = 1.5f;
  OrganizedCloud scene;
  scene.width = 640;
  scene.height = 480;
  for (int v = 0; v < 480; ++v) {
    for (int u = 0; u < 640; ++u) {
      const float x = (static_cast<float>(u) - 319.5f) / kFocal;
      const float y = (static_cast<float>(v) - 239.5f) / kFocal;
      const bool on_box = std::abs(x) * kFront < kHalf && std::abs(y) * kFront < kHalf;
      const float z = on_box ? kFront : kWall;
      scene.points.emplace_back(x * z, y * z, z);
    }
  }
  std::vector<Point> box;
  constexpr int kSteps = 50;  // of 4 mm
  for (int i = 0; i <= kSteps; ++i) {
    for (int k = 0; k <= kSteps; ++k) {
      const auto at = [](int n) { return kHalf * (2.0f * static_cast<float>(n) / kSteps - 1.0f); };
      const float depth = kFront + (kBack - kFront) * static_cast<float>(k) / kSteps;
      box.emplace_back(at(i), at(k), kFront);
      box.emplace_back(at(i), at(k), kBack);
      for (const float side : {-kHalf, kHalf}) {
        box.emplace_back(side, at(i), depth);
        box.emplace_back(at(i), side, depth);
      }
    }
  }
  const SceneView view(scene);
  ASSERT_TRUE(view.isOne());
  const ModelEvidence evidence = view.judge(box, 0.01);
  EXPECT_GT(evidence.visible(), 0.85);  // of a side the first 1.5 cm are taken for its front
  EXPECT_GT(evidence.coverage(), 0.95);
  EXPECT_LT(evidence.flushShare(), 0.05);
}

TEST(ObjectRecognition, RefusesModelsThatAreOnePlace) {
  OrganizedCloud cloud;
  for (int i = 0; i < 200; ++i) cloud.points.emplace_back(0.001f, 0.001f, 0.801f);
  cloud.width = 200;
  cloud.height = 1;
  EXPECT_THROW(findModel(cloud, cloud), hyselam::InputError);
  // Nor if one of them is so far away that no 32 bits number the cubes between.
  cloud.points.back() = Point(1e6f, 1e6f, 1e6f);
  EXPECT_THROW(findModel(cloud, cloud), hyselam::InputError);
}

TEST(ObjectRecognition, FindsTheMilkCartonInTheScene) {
  HYSELAM_NEED_DATA(data);
  const std::string folder = data + "/objects/pcl_tutorials/";
  const CloudFile model = readPcd(folder + "milk.pcd");
  const CloudFile scene = readPcd(folder + "milk_cartoon_all_small_clorox.pcd");
  const auto found = findModel(model.cloud, scene.cloud);
  ASSERT_FALSE(found.empty());
  std::cout << found.size() << " found; best: " << found.front().correspondences
            << " correspondences, " << 100.0 * found.front().coverage
            << " % of the model covered\n";
  EXPECT_GE(found.front().coverage, 0.8);
  // It is not found where it is not: the scene without it.
  OrganizedCloud rest = scene.cloud;
  const Eigen::Isometry3f pose = found.front().model_in_scene.cast<float>();
  Point low = pose * model.cloud.points.front(), high = low;
  for (const Point& p : model.cloud.points) {
    low = low.cwiseMin(pose * p);
    high = high.cwiseMax(pose * p);
  }
  for (Point& p : rest.points) {
    const bool inside = ((p - low).array() > -0.02f).all() && ((high - p).array() > -0.02f).all();
    if (inside) p.setConstant(std::numeric_limits<float>::quiet_NaN());
  }
  EXPECT_TRUE(findModel(model.cloud, rest).empty());
  EXPECT_EQ(found.size(), 1u);  // and once
}

// Scenes that the probability was not fitted on; bench/run FindModel has all.
TEST(ObjectRecognition, FindsAModelOnceWhereItIsAndNowhereElse) {
  HYSELAM_NEED_DATA(data);
  const std::string folder = data + "/objects/";
  const CloudFile model = readPcd(folder + "pcl_tutorials/milk.pcd");
  const CloudFile own = readPcd(folder + "pcl_tutorials/milk_cartoon_all_small_clorox.pcd");
  const auto table = segmentCloud(own.cloud).support;
  ASSERT_TRUE(table);
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Point& p : model.cloud.points) middle += p.cast<double>();
  middle /= static_cast<double>(model.cloud.size());
  for (const std::uint64_t number : {34, 45, 55}) {
    const CloudFile scene = readPcd(folder + "mosd_piles/test" + std::to_string(number) + ".pcd");
    EXPECT_TRUE(findModel(model.cloud, scene.cloud).empty()) << number;
    hyselam::Rng rng(number);
    const auto put = putIntoScene(model.cloud, table->normal, scene.cloud, rng);
    ASSERT_TRUE(put) << number;
    const auto found = findModel(model.cloud, put->cloud);
    ASSERT_EQ(found.size(), 1u) << number;
    EXPECT_LT((found[0].model_in_scene * middle - put->model_in_scene * middle).norm(), 0.03);
  }
}
