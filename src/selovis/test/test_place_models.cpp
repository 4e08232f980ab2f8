// Classifiers against libsvm, models on disk, and what a recogniser makes of a stream of images.
#include <gtest/gtest.h>
#include <libsvm/svm.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/rng.hpp"
#include "hyselam_common/testing/files.hpp"
#include "selovis/descriptive.hpp"
#include "selovis/recogniser.hpp"

namespace selovis {
namespace {

using hyselam::InputError;
using hyselam::testing::messageOf;
using hyselam::testing::TemporaryDirectory;
using hyselam::testing::writeFile;

/// Noisy clusters, one per class.
Samples clusters(std::uint64_t seed, int classes, int per_class, std::size_t size) {
  hyselam::Rng rng(seed);
  std::vector<std::vector<double>> centres(static_cast<std::size_t>(classes));
  for (auto& c : centres) {
    for (std::size_t k = 0; k < size; ++k) c.push_back(rng.below(3) == 0 ? rng.uniform() : 0.0);
  }
  Samples s;
  s.size = size;
  std::vector<float> row(size);
  for (int i = 0; i < classes * per_class; ++i) {
    const int c = i / per_class;
    for (std::size_t k = 0; k < size; ++k) {
      row[k] = static_cast<float>(
          std::abs(centres[static_cast<std::size_t>(c)][k] + rng.gaussian(0.0, 0.3)));
    }
    s.add(row.data(), c, i);
  }
  return s;
}

TEST(Svm, ProbabilitiesEqualLibsvmsOwn) {
  TemporaryDirectory folder;
  for (const int classes : {2, 5}) {
    const Samples s = clusters(31, classes, 25, 40), test = clusters(31, classes, 6, 40);
    for (const Kernel kernel : {Kernel::kLinear, Kernel::kPoly, Kernel::kRbf}) {
      ClassifierParams p;
      p.kernel = kernel;
      p.power = 1.0;
      std::string state;
      const auto ours = trainClassifier(s, classes, p, &state, folder / "model");
      svm_model* theirs = svm_load_model((folder / "model").c_str());
      ASSERT_NE(theirs, nullptr);
      double squares = 0.0;
      for (const float v : s.values) squares += double(v) * v;
      const double scale = 1.0 / std::sqrt(squares / static_cast<double>(s.count()));
      const auto restored = restoreClassifier(s, classes, p, state);
      for (std::size_t i = 0; i < test.count(); ++i) {
        std::vector<svm_node> x;
        for (std::size_t k = 0; k < s.size; ++k) x.push_back({int(k) + 1, scale * test.row(i)[k]});
        x.push_back({-1, 0.0});
        std::vector<double> a(static_cast<std::size_t>(classes)), b(a), c(a);
        svm_predict_probability(theirs, x.data(), a.data());
        ours->predict(test.row(i), b.data());
        restored->predict(test.row(i), c.data());
        EXPECT_EQ(b, c);
        for (int k = 0; k < classes; ++k) {
          EXPECT_NEAR(b[static_cast<std::size_t>(theirs->label[k])], a[static_cast<std::size_t>(k)],
                      2e-3)
              << nameOf(kernel);
        }
      }
      svm_free_and_destroy_model(&theirs);
    }
  }
}

TEST(Exemplars, TheNearestClusterWinsAndStrangersAreNovel) {
  const Samples s = clusters(32, 4, 40, 30);
  Samples test;  // the same centres, other noise
  test.size = s.size;
  const Samples more = clusters(32, 4, 60, 30);
  for (std::size_t i = 45; i < more.count(); i += 60) test.add(more.row(i), more.places[i], 0);
  ClassifierParams p;
  p.kernel = Kernel::kExemplar;
  const auto c = trainClassifier(s, 4, p, nullptr);
  std::vector<double> q(4);
  int right = 0;
  double usual = 0.0;
  for (std::size_t i = 0; i < test.count(); ++i) {
    c->predict(test.row(i), q.data());
    EXPECT_NEAR(q[0] + q[1] + q[2] + q[3], 1.0, 1e-9);
    right += std::max_element(q.begin(), q.end()) - q.begin() == test.places[i];
    usual = std::max(usual, c->novelty());
  }
  EXPECT_GE(right, 3);
  const std::vector<float> stranger(30, 5.0f);
  c->predict(stranger.data(), q.data());
  EXPECT_GT(c->novelty(), 2.0 * usual);
}

TEST(Classifier, GridSearchFindsAWorkableCostAndTellsProgress) {
  const Samples s = clusters(33, 3, 30, 20);
  ClassifierParams p;
  p.kernel = Kernel::kRbf;
  p.cost = 1e-5;
  std::size_t last = 0;
  GridSearch grid;
  grid.costs = {1e-5, 10.0};
  grid.gammas = {1e-6, 1.0};
  EXPECT_GT(searchGrid(s, 3, grid, p, [&](std::size_t done, std::size_t) { last = done; }), 0.7);
  EXPECT_EQ(last, 4u);
  EXPECT_EQ(p.cost, 10.0);
  Samples one = clusters(33, 1, 5, 20);
  EXPECT_THROW(trainClassifier(one, 1, p, nullptr), std::invalid_argument);
  EXPECT_THROW(trainClassifier(Samples{}, 2, p, nullptr), std::invalid_argument);
}

/// Walls of one colour with a stripe pattern of their own.
TrainingFrame frameOf(int place, int i) {
  cv::Mat image(60, 80, CV_8UC3, cv::Scalar(90 + 30 * place, 120, 200 - 40 * place));
  for (int x = i % 5; x < 80; x += 4 + 3 * place) image.col(x).setTo(cv::Scalar(20, 20, 20));
  return {image, {}, "room " + std::to_string(place)};
}

Model smallModel(Kernel kernel, int places = 3) {
  TrainingOptions o;
  o.descriptor = "LBPbyHSV-U8N";
  o.classifier.kernel = kernel;
  return train(
      {static_cast<std::size_t>(10 * places)},
      [](std::size_t, std::size_t i) { return frameOf(int(i) / 10, int(i)); }, o);
}

TEST(Models, SurviveTheDiskBitForBit) {
  TemporaryDirectory folder;
  for (const Kernel kernel : {Kernel::kLinear, Kernel::kPoly, Kernel::kRbf, Kernel::kExemplar}) {
    const Model model = smallModel(kernel);
    saveModel(model, folder / "m");
    const Model again = loadModel(folder / "m");
    EXPECT_EQ(again.descriptor, model.descriptor);
    EXPECT_EQ(again.graph.places, model.graph.places);
    EXPECT_EQ(again.graph.transitions, model.graph.transitions);
    Recogniser a(model, model.graph, {}), b(again, again.graph, {});
    for (int i = 0; i < 12; ++i) {
      const cv::Mat image = frameOf(i / 4, i + 1).image;
      EXPECT_EQ(a.update(image).estimate.place, b.update(image).estimate.place);
      EXPECT_EQ(a.probabilities(), b.probabilities());
    }
    // One manifest, one file of signatures, at most one machine: what an earlier model left is
    // gone.
    const auto files = std::distance(std::filesystem::directory_iterator(folder / "m"), {});
    EXPECT_EQ(files, kernel == Kernel::kExemplar ? 2 : 3);
  }
}

TEST(Models, PosesSurviveTheDiskAndServeTheFilter) {
  TemporaryDirectory folder;
  TrainingOptions o;
  o.descriptor = "LGOP";
  o.classifier.kernel = Kernel::kExemplar;
  o.views = {0.0, 0.1};
  o.aperture = 1.0;
  const auto withPose = [](std::size_t, std::size_t i) {
    TrainingFrame f = frameOf(int(i) / 10, int(i));
    if (i != 3) f.pose = {0.3 * double(i), 1.0, 0.2};
    return f;
  };
  const Model model = train({30}, withPose, o);
  saveModel(model, folder / "m");
  const Model again = loadModel(folder / "m");
  EXPECT_EQ(again.aperture, 1.0);
  ASSERT_EQ(again.samples.poses.size(), 60u);
  EXPECT_FALSE(again.samples.poses[6].isFinite()) << "one frame had no pose";
  EXPECT_EQ(again.samples.poses[9].x, 0.3 * 4.0);
  EXPECT_NEAR(again.samples.poses[9].theta, 0.3, 1e-12) << "the second view is turned by 0.1 rad";
  RecogniserParams params;
  params.filter.kind = FilterKind::kPoses;
  Recogniser r(again, again.graph, params);
  int right = 0;
  for (int i = 0; i < 30; ++i) {
    Readings readings;
    readings.stamp = i;
    readings.odometry = hyselam::Pose2{0.3 * i, 0.0, 0.0};
    right += r.update(frameOf(i / 10, i).image, readings).estimate.place == i / 10;
  }
  EXPECT_GE(right, 24);
  std::string poses;
  for (const auto& f : std::filesystem::directory_iterator(folder / "m")) {
    if (f.path().filename().string().compare(0, 6, "poses-") == 0) poses = f.path().string();
  }
  writeFile(poses, hyselam::testing::fileBytes(poses).substr(0, 50));
  EXPECT_NE(messageOf<InputError>([&] { loadModel(folder / "m"); }).find("cut short"),
            std::string::npos);
  const Model without = smallModel(Kernel::kExemplar), svm = smallModel(Kernel::kLinear);
  EXPECT_THROW(Recogniser(without, without.graph, params), std::invalid_argument);
  EXPECT_THROW(Recogniser(svm, svm.graph, params), std::invalid_argument);
}

TEST(Models, PlacesCanBeAdded) {
  for (const Kernel kernel : {Kernel::kLinear, Kernel::kExemplar}) {
    Model model = smallModel(kernel, 2);
    TrainingOptions o;
    addTo(
        model, {10}, [](std::size_t, std::size_t i) { return frameOf(2, int(i)); }, o);
    ASSERT_EQ(model.graph.places.size(), 3u);
    PlaceFilterParams none;
    none.kind = FilterKind::kNone;
    RecogniserParams params;
    params.filter = none;
    Recogniser r(model, model.graph, params);
    for (int place = 0; place < 3; ++place) {
      EXPECT_EQ(r.update(frameOf(place, 3).image).estimate.place, place) << nameOf(kernel);
    }
  }
}

TEST(Models, TrainingIsTheSameEveryTime) {
  EXPECT_EQ(smallModel(Kernel::kRbf).state, smallModel(Kernel::kRbf).state);
}

TEST(Models, ChangedFilesAreRefusedByName) {
  TemporaryDirectory folder;
  saveModel(smallModel(Kernel::kLinear), folder / "m");
  std::string signatures, svm;
  for (const auto& f : std::filesystem::directory_iterator(folder / "m")) {
    const std::string name = f.path().filename().string();
    if (name.compare(0, 10, "signatures") == 0) signatures = f.path().string();
    if (name.compare(0, 3, "svm") == 0) svm = f.path().string();
  }
  const std::string manifest = folder / "m/model.json";
  const auto refused = [&](const std::string& file, const std::string& content,
                           const std::string& says) {
    const std::string good = hyselam::testing::fileBytes(file);
    writeFile(file, content);
    const std::string what = messageOf<InputError>([&] { loadModel(folder / "m"); });
    EXPECT_NE(what.find(says), std::string::npos) << what;
    EXPECT_NE(what.find(folder.path()), std::string::npos) << what;
    writeFile(file, good);
  };
  for (const std::string& file : {signatures, svm}) {
    const std::string good = hyselam::testing::fileBytes(file);
    refused(file, good.substr(0, good.size() / 2), "cut short");
    refused(file, "", "cut short");
    std::string flipped = good;
    flipped[good.size() / 2] ^= 1;
    refused(file, flipped, "checksum");
  }
  refused(manifest, "{}", "format");
  refused(manifest, "not json", "is no model");
  refused(manifest, "", "is no model");
  const auto j = nlohmann::json::parse(hyselam::testing::fileBytes(manifest));
  const auto with = [&](const char* key, const nlohmann::json& value) {
    auto changed = j;
    changed[key] = value;
    return changed.dump();
  };
  refused(manifest, with("format", "selovis model 9"), "format");
  refused(manifest, with("descriptor", "LBPbyHSV-U16N"), "944");  // a model of another descriptor
  refused(manifest, with("descriptor", "nonsense"), "nonsense");
  auto fewer = j;
  fewer["places"] = {"room 0"};
  fewer["transitions"] = nlohmann::json::array();
  refused(manifest, fewer.dump(), "not listed");
  refused(manifest, with("places", {"room 0", "room 0", "room 2"}), "twice");
  refused(manifest, with("transitions", {{0, 7}}), "joins no places");
  auto elsewhere = j["svm"];
  elsewhere["file"] = "../../etc/passwd";
  refused(manifest, with("svm", elsewhere), "no name of a data file");
  EXPECT_THROW(loadModel(folder / "none"), InputError);
  EXPECT_NO_THROW(loadModel(folder / "m"));
}

/// With a right checksum, so that the parser itself must refuse.
TEST(Models, RandomDamageNeverCrashes) {
  TemporaryDirectory folder;
  hyselam::Rng rng(41);
  Model good = smallModel(Kernel::kRbf, 2);
  int refused = 0;
  for (int round = 0; round < 150; ++round) {
    Model bad = good;
    const std::size_t at = rng.below(static_cast<std::uint32_t>(bad.state.size()));
    if (round % 3 == 0)
      bad.state.resize(at);
    else if (round % 3 == 1)
      bad.state[at] = static_cast<char>(rng.below(256));
    else
      bad.state.replace(rng.below(64), 8, "\xff\xff\xff\xff\xff\xff\xff\x7f");
    saveModel(bad, folder / "m");
    try {
      const Model m = loadModel(folder / "m");
      Recogniser(m, m.graph, {}).update(frameOf(0, 1).image);
    } catch (const InputError&) {
      ++refused;
    } catch (const std::invalid_argument&) {  // probabilities that are none
      ++refused;
    }
  }
  EXPECT_GT(refused, 60);
}

TEST(Recogniser, BlackFramesLeaveThePlaceAsItWas) {
  const Model model = smallModel(Kernel::kLinear);
  RecogniserParams p;
  p.descriptive.kind = DescriptiveKind::kCorners;
  p.descriptive.min_features = 1;
  Recogniser r(model, model.graph, p);
  for (int i = 0; i < 5; ++i) {
    cv::Mat image = frameOf(1, i).image;
    cv::circle(image, {40, 30}, 6, cv::Scalar(255, 255, 255),
               cv::FILLED);  // something with corners
    r.update(image);
  }
  const auto before = r.probabilities();
  const Recognition dark = r.update(cv::Mat(60, 80, CV_8UC3, cv::Scalar::all(0)));
  EXPECT_FALSE(dark.descriptive);
  EXPECT_EQ(dark.frame_place, -1);
  EXPECT_EQ(r.probabilities(), before);
}

TEST(Recogniser, AChangedResolutionAndAGreyImageInMidStream) {
  const Model model = smallModel(Kernel::kLinear);
  Recogniser r(model, model.graph, {});
  r.update(frameOf(0, 0).image);
  cv::Mat larger(480, 640, CV_8UC3, cv::Scalar(90, 120, 200));
  EXPECT_NO_THROW(r.update(larger));
  const auto before = r.probabilities();
  EXPECT_THROW(r.update(cv::Mat(60, 80, CV_8UC1, cv::Scalar(3))), std::invalid_argument);
  EXPECT_EQ(r.probabilities(), before);
  EXPECT_NO_THROW(r.update(frameOf(0, 1).image));
}

TEST(Recogniser, APlaceTakenOffTheMapKeepsItsClassWithoutTransitions) {
  const Model model = smallModel(Kernel::kLinear);
  std::vector<std::string> missing;
  const PlaceGraph left{{"room 2", "room 0"}, {{0, 1}}};
  const PlaceGraph g = reordered(left, model.graph.places, &missing);
  EXPECT_EQ(missing, std::vector<std::string>{"room 1"});
  EXPECT_TRUE(g.connected(0, 2));
  Recogniser r(model, g, {});
  for (int i = 0; i < 20; ++i) r.update(frameOf(2, i).image);
  EXPECT_EQ(r.update(frameOf(2, 1).image).estimate.place, 2);
  EXPECT_THROW(Recogniser(model, left, {}), std::invalid_argument);
}

TEST(Recogniser, TimeThatGoesBackBeginsThePosesAnew) {
  TrainingOptions options;
  options.descriptor = "LGOP";
  options.classifier.kernel = Kernel::kExemplar;
  const Model model = train(
      {24},
      [&](std::size_t, std::size_t i) {
        TrainingFrame f = frameOf(static_cast<int>(i / 8), static_cast<int>(i));
        f.pose = {0.5 * static_cast<double>(i), 0.0, 0.0};
        return f;
      },
      options);
  RecogniserParams params;
  params.filter.kind = FilterKind::kPoses;
  const auto at = [&](Recogniser& r, int i, double stamp) {
    Readings readings;
    readings.stamp = stamp;
    readings.odometry = hyselam::Pose2{0.5 * i, 0.0, 0.0};
    r.updateWithSignature(model.samples.row(static_cast<std::size_t>(i)), readings);
    return r.probabilities();
  };
  Recogniser again(model, model.graph, params), fresh(model, model.graph, params);
  for (int i = 0; i < 12; ++i) at(again, i, 100.0 + i);
  for (int i = 0; i < 6; ++i) EXPECT_EQ(at(again, i, 50.0 + i), at(fresh, i, 50.0 + i)) << i;
  // Late by less: the same drive, not one of its own.
  Recogniser other(model, model.graph, params);
  EXPECT_NE(at(again, 5, 54.8), at(other, 5, 54.8));
}

TEST(DescriptiveFilter, CountsCornersAndSift) {
  cv::Mat busy(240, 320, CV_8UC1, cv::Scalar(100));
  hyselam::Rng rng(51);
  for (int i = 0; i < 80; ++i) {
    const cv::Rect box(static_cast<int>(rng.below(290)), static_cast<int>(rng.below(210)),
                       8 + static_cast<int>(rng.below(20)), 8 + static_cast<int>(rng.below(20)));
    busy(box).setTo(cv::Scalar(rng.below(256)));
  }
  const cv::Mat bare(240, 320, CV_8UC1, cv::Scalar(100));
  for (const DescriptiveKind kind : {DescriptiveKind::kSift, DescriptiveKind::kCorners}) {
    DescriptiveFilter filter({kind, 5});
    EXPECT_TRUE(filter.accepts(busy));
    EXPECT_FALSE(filter.accepts(bare));
  }
  EXPECT_TRUE(DescriptiveFilter({DescriptiveKind::kNone, 10}).accepts(bare));
  EXPECT_THROW(DescriptiveFilter({DescriptiveKind::kNone, -1}), hyselam::ParameterError);
}

}  // namespace
}  // namespace selovis
