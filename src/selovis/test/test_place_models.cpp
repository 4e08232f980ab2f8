// Classifiers against libsvm, models on disk, recognition of a stream of images.
#include <gtest/gtest.h>
#include <libsvm/svm.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "hyselam_common/checksum.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/rng.hpp"
#include "hyselam_common/testing/files.hpp"
#include "selovis/descriptors/descriptive_filter.hpp"
#include "selovis/learning/learner.hpp"
#include "selovis/recognition/image_recognizer.hpp"

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
    for (const SvmKernel kernel : {SvmKernel::kLinear, SvmKernel::kPoly, SvmKernel::kRbf}) {
      ClassifierParams p;
      p.kernel = kernel;
      p.power = 1.0;
      const auto [ours, state] = trainClassifier(s, classes, p, folder / "model");
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
              << toString(kernel);
        }
      }
      svm_free_and_destroy_model(&theirs);
    }
  }
}

TEST(ExemplarClassifier, NearestClusterIsMostLikelyAndOutliersAreNovel) {
  const Samples s = clusters(32, 4, 40, 30);
  Samples test;  // the same centres, other noise
  test.size = s.size;
  const Samples more = clusters(32, 4, 60, 30);
  for (std::size_t i = 45; i < more.count(); i += 60) test.add(more.row(i), more.places[i], 0);
  ClassifierParams p;
  p.kernel = SvmKernel::kExemplar;
  const auto c = trainClassifier(s, 4, p).classifier;
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

TEST(Classifier, GridSearchFindsAWorkingCostAndReportsProgress) {
  const Samples s = clusters(33, 3, 30, 20);
  ClassifierParams p;
  p.kernel = SvmKernel::kRbf;
  p.cost = 1e-5;
  std::size_t last = 0;
  GridSearchParams grid;
  grid.costs = {1e-5, 10.0};
  grid.gammas = {1e-6, 1.0};
  const GridSearchResult found =
      searchGrid(s, 3, grid, p, [&](std::size_t done, std::size_t) { last = done; });
  EXPECT_GT(found.accuracy, 0.7);
  EXPECT_EQ(last, 4u);
  EXPECT_EQ(found.params.cost, 10.0);
  Samples one = clusters(33, 1, 5, 20);
  EXPECT_THROW(trainClassifier(one, 1, p), InputError);
  EXPECT_THROW(trainClassifier(Samples{}, 2, p), InputError);
}

/// Walls of one colour with a stripe pattern of their own.
TrainingFrame frameOf(int place, int i) {
  cv::Mat image(60, 80, CV_8UC3, cv::Scalar(90 + 30 * place, 120, 200 - 40 * place));
  for (int x = i % 5; x < 80; x += 4 + 3 * place) image.col(x).setTo(cv::Scalar(20, 20, 20));
  return {image, {}, "room " + std::to_string(place)};
}

PlaceModel smallModel(SvmKernel kernel, int places = 3) {
  TrainingOptions o;
  o.descriptor = "LBPbyHSV-U8N";
  o.classifier.kernel = kernel;
  return trainPlaceModel(
      {static_cast<std::size_t>(10 * places)},
      [](std::size_t, std::size_t i) { return frameOf(int(i) / 10, int(i)); }, o);
}

TEST(PlaceModel, IsReadBackBitForBit) {
  TemporaryDirectory folder;
  for (const SvmKernel kernel :
       {SvmKernel::kLinear, SvmKernel::kPoly, SvmKernel::kRbf, SvmKernel::kExemplar}) {
    const PlaceModel model = smallModel(kernel);
    savePlaceModel(model, folder / "m");
    const PlaceModel again = loadPlaceModel(folder / "m");
    EXPECT_EQ(again.descriptor, model.descriptor);
    EXPECT_EQ(again.transitions.places, model.transitions.places);
    EXPECT_EQ(again.transitions.pairs, model.transitions.pairs);
    ImageRecognizer a(model, model.transitions, {}), b(again, again.transitions, {});
    for (int i = 0; i < 12; ++i) {
      const cv::Mat image = frameOf(i / 4, i + 1).image;
      EXPECT_EQ(a.update(image).estimate.place, b.update(image).estimate.place);
      EXPECT_EQ(a.probabilities(), b.probabilities());
    }
    // One manifest, one file of signatures, at most one machine: what an earlier model left is
    // gone.
    const auto files = std::distance(std::filesystem::directory_iterator(folder / "m"), {});
    EXPECT_EQ(files, kernel == SvmKernel::kExemplar ? 2 : 3);
  }
}

TEST(PlaceModel, PosesAreSavedAndUsedByThePoseFilter) {
  TemporaryDirectory folder;
  TrainingOptions o;
  o.descriptor = "LGOP";
  o.classifier.kernel = SvmKernel::kExemplar;
  o.views = {0.0, 0.1};
  o.horizontal_fov = 1.0;
  const auto withPose = [](std::size_t, std::size_t i) {
    TrainingFrame f = frameOf(int(i) / 10, int(i));
    if (i != 3) f.pose = {0.3 * double(i), 1.0, 0.2};
    return f;
  };
  const PlaceModel model = trainPlaceModel({30}, withPose, o);
  savePlaceModel(model, folder / "m");
  const PlaceModel again = loadPlaceModel(folder / "m");
  EXPECT_EQ(again.horizontal_fov, 1.0);
  ASSERT_EQ(again.samples.poses.size(), 60u);
  EXPECT_FALSE(again.samples.poses[6].isFinite()) << "one frame has no pose";
  EXPECT_EQ(again.samples.poses[9].x, 0.3 * 4.0);
  EXPECT_NEAR(again.samples.poses[9].theta, 0.3, 1e-12) << "the second view is turned by 0.1 rad";
  ImageRecognizerParams params;
  params.filter.kind = PlaceFilterKind::kPoses;
  ImageRecognizer r(again, again.transitions, params);
  int right = 0;
  for (int i = 0; i < 30; ++i) {
    SensorReadings readings;
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
  EXPECT_NE(messageOf<InputError>([&] { loadPlaceModel(folder / "m"); }).find("cut short"),
            std::string::npos);
  const PlaceModel without = smallModel(SvmKernel::kExemplar), svm = smallModel(SvmKernel::kLinear);
  EXPECT_THROW(ImageRecognizer(without, without.transitions, params), InputError);
  EXPECT_THROW(ImageRecognizer(svm, svm.transitions, params), InputError);
}

TEST(PlaceModel, PlacesAreAddedToATrainedModel) {
  for (const SvmKernel kernel : {SvmKernel::kLinear, SvmKernel::kExemplar}) {
    PlaceModel model = smallModel(kernel, 2);
    TrainingOptions o;
    model = extendPlaceModel(
        model, {10}, [](std::size_t, std::size_t i) { return frameOf(2, int(i)); }, o);
    ASSERT_EQ(model.transitions.places.size(), 3u);
    PlaceFilterParams none;
    none.kind = PlaceFilterKind::kNone;
    ImageRecognizerParams params;
    params.filter = none;
    ImageRecognizer r(model, model.transitions, params);
    for (int place = 0; place < 3; ++place) {
      EXPECT_EQ(r.update(frameOf(place, 3).image).estimate.place, place) << toString(kernel);
    }
  }
}

TEST(PlaceModel, TrainingIsDeterministic) {
  EXPECT_EQ(smallModel(SvmKernel::kRbf).svm, smallModel(SvmKernel::kRbf).svm);
}

TEST(PlaceModel, ChangedFilesAreRefusedWithTheirName) {
  TemporaryDirectory folder;
  savePlaceModel(smallModel(SvmKernel::kLinear), folder / "m");
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
    const std::string what = messageOf<InputError>([&] { loadPlaceModel(folder / "m"); });
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
  // A complete file of another kind.
  const std::string content = hyselam::testing::fileBytes(svm), crc = hyselam::crc32Text(content);
  const std::string name = "signatures-" + crc + ".bin";
  writeFile(folder / ("m/" + name), content);
  refused(manifest, with("signatures", {{"file", name}, {"bytes", content.size()}, {"crc32", crc}}),
          "does not begin with 'selovis signatures 2'");
  EXPECT_THROW(loadPlaceModel(folder / "none"), InputError);
  EXPECT_NO_THROW(loadPlaceModel(folder / "m"));
}

/// Format 1 had neither headers nor a byte order; it was written on little-endian machines.
TEST(PlaceModel, FormerFormatIsReadAndWrittenAsTheNewOne) {
  const PlaceModel model = loadPlaceModel(HYSELAM_PACKAGE_DIR "/test/data/model_format_1");
  EXPECT_EQ(model.transitions.places, (std::vector<std::string>{"hall", "lab"}));
  EXPECT_EQ(model.samples.values, (std::vector<float>{0.1f, 0.2f, 0.8f, 0.9f}));
  EXPECT_EQ(model.samples.places, (std::vector<int>{0, 0, 1, 1}));
  ASSERT_EQ(model.samples.poses.size(), 4u);
  EXPECT_EQ(model.samples.poses[1].x, 0.5);
  EXPECT_EQ(model.samples.poses[1].theta, 0.25);
  TemporaryDirectory folder;
  savePlaceModel(model, folder / "m");
  EXPECT_NE(hyselam::testing::fileBytes(folder / "m/model.json").find("selovis model 2"),
            std::string::npos);
  const PlaceModel again = loadPlaceModel(folder / "m");
  EXPECT_EQ(again.samples.values, model.samples.values);
  EXPECT_EQ(again.svm, model.svm);
  EXPECT_EQ(again.samples.poses[1].x, 0.5);
}

TEST(PlaceModel, WhereTheCameraErrsIsSavedBesideTheModelItBelongsTo) {
  const PlaceModel former = loadPlaceModel(HYSELAM_PACKAGE_DIR "/test/data/model_format_1");
  EXPECT_EQ(former.reliability.size(), 0u) << "older models have none";
  TemporaryDirectory folder;
  savePlaceModel(former, folder / "m");
  const std::string before = hyselam::testing::fileBytes(folder / "m/model.json");
  EXPECT_EQ(before.find("reliability"), std::string::npos);
  ReliabilityMemory memory;
  const hyselam::Pose2 door{3.0, 1.0, 0.0}, away{7.0, 1.0, 0.0};
  const auto visit = [&] {
    memory.add(door, {1}, 1.0);
    memory.add(away, {}, 1.0);
  };
  visit();
  saveReliability(former, memory, folder / "m");
  visit();
  saveReliability(former, memory, folder / "m");
  const PlaceModel again = loadPlaceModel(folder / "m");
  EXPECT_EQ(again.samples.values, former.samples.values);
  EXPECT_EQ(again.reliability.toBytes(), memory.toBytes());
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "m")) {
    files += entry.path().filename().string().compare(0, 11, "reliability") == 0;
  }
  EXPECT_EQ(files, 1) << "that of the first saving is gone";
  // It goes where the model goes, and belongs to no other.
  savePlaceModel(again, folder / "copy");
  EXPECT_EQ(loadPlaceModel(folder / "copy").reliability.toBytes(), memory.toBytes());
  PlaceModel other = former;
  other.samples.values[0] += 0.1f;
  EXPECT_NE(messageOf<InputError>([&] {
              saveReliability(other, memory, folder / "m");
            }).find("another model"),
            std::string::npos);
  saveReliability(former, {}, folder / "m");
  EXPECT_EQ(hyselam::testing::fileBytes(folder / "m/model.json"), before);
}

TEST(PlaceModel, WithoutTrainingIsNotSaved) {
  TemporaryDirectory folder;
  for (const SvmKernel kernel : {SvmKernel::kFusion, SvmKernel::kExemplar, SvmKernel::kLinear}) {
    TrainingOptions options;
    options.descriptor = "LGOP";
    options.classifier.kernel = kernel;
    PlaceModel model = untrainedPlaceModel(options);
    EXPECT_NE(messageOf<InputError>([&] { savePlaceModel(model, folder / "m"); }).find("learned"),
              std::string::npos);
    if (kernel == SvmKernel::kExemplar) continue;
    const std::vector<float> signature(model.samples.size, 0.5f);
    model.samples.add(signature.data(), 0, 0);
    EXPECT_NE(messageOf<InputError>([&] { savePlaceModel(model, folder / "m"); }).find("trained"),
              std::string::npos);
  }
  EXPECT_FALSE(holdsPlaceModel(folder / "m"));
}

/// With a right checksum, so that the parser itself must refuse.
TEST(PlaceModel, RandomDamageIsRefusedWithoutACrash) {
  TemporaryDirectory folder;
  hyselam::Rng rng(41);
  PlaceModel good = smallModel(SvmKernel::kRbf, 2);
  int refused = 0;
  for (int round = 0; round < 150; ++round) {
    PlaceModel bad = good;
    const std::size_t at = rng.below(static_cast<std::uint32_t>(bad.svm.size()));
    if (round % 3 == 0)
      bad.svm.resize(at);
    else if (round % 3 == 1)
      bad.svm[at] = static_cast<char>(rng.below(256));
    else
      bad.svm.replace(rng.below(64), 8, "\xff\xff\xff\xff\xff\xff\xff\x7f");
    savePlaceModel(bad, folder / "m");
    try {
      const PlaceModel m = loadPlaceModel(folder / "m");
      ImageRecognizer(m, m.transitions, {}).update(frameOf(0, 1).image);
    } catch (const InputError&) {  // by the reader, or for probabilities that are not finite
      ++refused;
    }
  }
  EXPECT_GT(refused, 60);
}

TEST(ImageRecognizer, BlackFramesDoNotChangeThePlace) {
  const PlaceModel model = smallModel(SvmKernel::kLinear);
  ImageRecognizerParams p;
  p.descriptive.kind = DescriptiveFilterKind::kCorners;
  p.descriptive.min_features = 1;
  ImageRecognizer r(model, model.transitions, p);
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

TEST(ImageRecognizer, AcceptsAnotherResolutionAndRefusesAGrayImage) {
  const PlaceModel model = smallModel(SvmKernel::kLinear);
  ImageRecognizer r(model, model.transitions, {});
  r.update(frameOf(0, 0).image);
  cv::Mat larger(480, 640, CV_8UC3, cv::Scalar(90, 120, 200));
  EXPECT_NO_THROW(r.update(larger));
  const auto before = r.probabilities();
  EXPECT_THROW(r.update(cv::Mat(60, 80, CV_8UC1, cv::Scalar(3))), InputError);
  EXPECT_EQ(r.probabilities(), before);
  EXPECT_NO_THROW(r.update(frameOf(0, 1).image));
}

TEST(ImageRecognizer, PlaceRemovedFromTheMapKeepsItsClassWithoutTransitions) {
  const PlaceModel model = smallModel(SvmKernel::kLinear);
  const PlaceTransitions left{{"room 2", "room 0"}, {{0, 1}}};
  const PlaceTransitions g = reordered(left, model.transitions.places);
  EXPECT_EQ(missingPlaces(left, model.transitions.places), std::vector<std::string>{"room 1"});
  EXPECT_TRUE(g.connected(0, 2));
  ImageRecognizer r(model, g, {});
  for (int i = 0; i < 20; ++i) r.update(frameOf(2, i).image);
  EXPECT_EQ(r.update(frameOf(2, 1).image).estimate.place, 2);
  EXPECT_THROW(ImageRecognizer(model, left, {}), InputError);
}

TEST(ImageRecognizer, PosesThatAreNotOfOneMapAreToldAndLeftToTheFilterOverPlaces) {
  PlaceModel model = smallModel(SvmKernel::kExemplar);
  for (std::size_t i = 0; i < model.samples.count(); ++i) {
    model.samples.poses[i] = {i % 2 == 0 ? 0.0 : 6000.0, 0.0, 0.0};
  }
  ImageRecognizer automatic(model, model.transitions, {});
  EXPECT_NE(automatic.posesProblem().find("5 km"), std::string::npos);
  SensorReadings readings;
  readings.odometry = hyselam::Pose2{};
  EXPECT_GE(automatic.update(frameOf(0, 1).image, readings).estimate.place, 0);
  ImageRecognizerParams poses;
  poses.filter.kind = PlaceFilterKind::kPoses;
  EXPECT_THROW(ImageRecognizer(model, model.transitions, poses), InputError);
  for (auto& pose : model.samples.poses) pose.x *= 0.5;
  EXPECT_EQ(ImageRecognizer(model, model.transitions, {}).posesProblem(), "");
}

TEST(ImageRecognizer, TimeThatGoesBackResetsThePoseFilter) {
  TrainingOptions options;
  options.descriptor = "LGOP";
  options.classifier.kernel = SvmKernel::kExemplar;
  const PlaceModel model = trainPlaceModel(
      {24},
      [&](std::size_t, std::size_t i) {
        TrainingFrame f = frameOf(static_cast<int>(i / 8), static_cast<int>(i));
        f.pose = {0.5 * static_cast<double>(i), 0.0, 0.0};
        return f;
      },
      options);
  ImageRecognizerParams params;
  params.filter.kind = PlaceFilterKind::kPoses;
  const auto at = [&](ImageRecognizer& r, int i, double stamp) {
    SensorReadings readings;
    readings.stamp = stamp;
    readings.odometry = hyselam::Pose2{0.5 * i, 0.0, 0.0};
    r.updateWithSignature(model.samples.row(static_cast<std::size_t>(i)), readings);
    return r.probabilities();
  };
  ImageRecognizer again(model, model.transitions, params), fresh(model, model.transitions, params);
  for (int i = 0; i < 12; ++i) at(again, i, 100.0 + i);
  for (int i = 0; i < 6; ++i) EXPECT_EQ(at(again, i, 50.0 + i), at(fresh, i, 50.0 + i)) << i;
  // Late by less: the same drive, not one of its own.
  ImageRecognizer other(model, model.transitions, params);
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
  for (const DescriptiveFilterKind kind :
       {DescriptiveFilterKind::kSift, DescriptiveFilterKind::kCorners}) {
    DescriptiveFilter filter({kind, 5});
    EXPECT_TRUE(filter.accepts(busy));
    EXPECT_FALSE(filter.accepts(bare));
  }
  EXPECT_TRUE(DescriptiveFilter({DescriptiveFilterKind::kNone, 10}).accepts(bare));
  EXPECT_THROW(DescriptiveFilter({DescriptiveFilterKind::kNone, -1}), hyselam::ParameterError);
}

}  // namespace
}  // namespace selovis
