// Late fusion of the parts of a signature, and the parts that are indifferent to light.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "../src/core/classifiers/fusion_classifier.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/rng.hpp"
#include "hyselam_common/testing/files.hpp"
#include "selovis/recognition/image_recognizer.hpp"

namespace selovis {
namespace {

using hyselam::InputError;
using hyselam::testing::fileBytes;
using hyselam::testing::messageOf;
using hyselam::testing::TemporaryDirectory;
using hyselam::testing::writeFile;

constexpr int kPlaces = 6, kPartSize = 40;

ClassifierParams fusion() {
  ClassifierParams params;
  params.kernel = SvmKernel::kFusion;
  return params;
}

/// Signatures of two parts. "form" tells the places apart, "color" does, or is noise, and lies
/// elsewhere in another light.
class World {
 public:
  explicit World(std::uint64_t seed, bool color_tells) : rng_(seed), color_tells_(color_tells) {
    for (int c = 0; c < 2 * kPlaces; ++c) {
      centers_.emplace_back();
      for (int k = 0; k < kPartSize; ++k) centers_.back().push_back(rng_.uniform());
    }
  }

  std::vector<float> look(int place, double light = 0.0) {
    std::vector<float> signature;
    for (int part = 0; part < 2; ++part) {
      const bool color = part == 1;
      const auto& center = centers_[static_cast<std::size_t>(2 * place + part)];
      for (int k = 0; k < kPartSize; ++k) {
        double v = color && !color_tells_ ? rng_.uniform() : center[static_cast<std::size_t>(k)];
        v = std::abs(v + rng_.gaussian(0.0, color ? 0.1 : 0.3));
        // Another light moves all colors the same way, to where one place's colors are.
        if (color) v = (1.0 - light) * v + light * centers_[1][static_cast<std::size_t>(k)] * 3.0;
        signature.push_back(static_cast<float>(v * v));
      }
    }
    return signature;
  }

  /// `tours` times through all places, 10 frames in each, `views` of each frame.
  Samples learn(int tours, int views = 1, int frames = 10) {
    Samples s;
    s.size = 2 * kPartSize;
    s.parts = {{"form", kPartSize, 0.5, false}, {"color", kPartSize, 0.5, true}};
    for (int t = 0; t < tours; ++t) {
      for (int i = 0; i < frames * kPlaces; ++i) {
        for (int v = 0; v < views; ++v) {
          s.add(look(i / frames).data(), i / frames, t * 1000 + i);
        }
      }
    }
    return s;
  }

 private:
  hyselam::Rng rng_;
  bool color_tells_;
  std::vector<std::vector<double>> centers_;
};

double accuracy(Classifier& classifier, World& world, double light, int frames = 120) {
  std::vector<double> p(kPlaces);
  int right = 0;
  for (int i = 0; i < frames; ++i) {
    classifier.predict(world.look(i % kPlaces, light).data(), p.data());
    right += std::max_element(p.begin(), p.end()) - p.begin() == i % kPlaces;
  }
  return static_cast<double>(right) / frames;
}

TEST(Fusion, PartThatIsFarFromAllThatWasLearnedDrownsNoOther) {
  World world(1, true);
  const Samples samples = world.learn(2);
  FusionClassifier fused(samples, kPlaces, fusion());
  ClassifierParams joined_params;
  joined_params.kernel = SvmKernel::kExemplar;
  const auto joined = trainClassifier(samples, kPlaces, joined_params).classifier;
  EXPECT_GT(accuracy(fused, world, 0.0), 0.95);
  EXPECT_LT(accuracy(*joined, world, 0.9), 0.5) << "the test's light is harmless";
  EXPECT_GT(accuracy(fused, world, 0.9), 0.85);
  const std::vector<PartOpinion>& said = *fused.opinions();
  EXPECT_EQ(said[1].part, "color");
  EXPECT_TRUE(said[1].out_of_range);
  EXPECT_EQ(said[1].weight, 0.0);
  EXPECT_EQ(said[0].weight, 1.0);
  EXPECT_FALSE(said[0].out_of_range);
}

TEST(Fusion, WeightFollowsWhatAPartWasWorthOnFramesLeftOut) {
  World tells(2, true), noise(2, false);
  const FusionClassifier good(tells.learn(2), kPlaces, fusion());
  const FusionClassifier bad(noise.learn(2), kPlaces, fusion());
  EXPECT_EQ(good.calibration().left_out, "tours");
  EXPECT_GT(good.calibration().parts[1].accuracy, 0.95);
  EXPECT_LT(bad.calibration().parts[1].accuracy, 0.5);
  EXPECT_LT(bad.calibration().parts[1].weight, 0.3 * bad.calibration().parts[0].weight);
  EXPECT_GT(good.calibration().parts[1].weight, bad.calibration().parts[1].weight);
}

TEST(Fusion, WeightsFollowHowNearTheFrameIs) {
  FusionCalibration c;
  c.parts.resize(3);
  for (PartCalibration& part : c.parts) {
    part.near_median = 0.01;
    part.median = 1.0;
  }
  c.parts[0].weight = 0.4;
  c.parts[0].near_weight = 0.1;
  c.parts[1].weight = c.parts[1].near_weight = 0.2;
  std::vector<double> weights(3);
  const auto at = [&](std::vector<double> nearest) {
    weightsAt(c, nearest, weights);
    EXPECT_NEAR(weights[1], 0.2, 1e-12);
    return weights[0];
  };
  EXPECT_NEAR(at({0.001, 0.001, 0.001}), 0.1, 1e-12) << "nearer than the next frame";
  EXPECT_NEAR(at({0.1, 0.1, 0.1}), 0.2, 1e-12) << "halfway by logarithms";
  EXPECT_NEAR(at({3.0, 3.0, 3.0}), 0.4, 1e-12);
  EXPECT_NEAR(at({0.01, 0.01, 9.0}), 0.1, 1e-12) << "one part that is far does not decide";
  for (PartCalibration& part : c.parts) part.near_median = 0.0;
  EXPECT_NEAR(at({0.01, 0.01, 0.01}), 0.4, 1e-12) << "a model that knows no near frames";
}

TEST(Fusion, NearFramesAreToldByWhatTellsTheNextFrame) {
  // One tour that comes to each place twice, a minute apart. "form" tells the places, coarsely;
  // "color" drifts: it is that of the next frame, and tells nothing a minute later.
  hyselam::Rng rng(12);
  Samples samples;
  samples.size = 2 * kPartSize;
  samples.parts = {{"form", kPartSize, 1.0, false}, {"color", kPartSize, 1.0, true}};
  std::vector<float> drift(kPartSize, 0.0f);
  for (int i = 0; i < 20 * kPlaces; ++i) {
    const int place = i / 10 % kPlaces;
    if (i % 10 == 0) {
      for (float& v : drift) v = static_cast<float>(10.0 * rng.uniform());
    }
    std::vector<float> signature;
    for (int k = 0; k < kPartSize; ++k) {
      signature.push_back(static_cast<float>((k % kPlaces == place) + rng.gaussian(0.0, 0.8)));
    }
    for (const float v : drift) {
      signature.push_back(v + static_cast<float>(rng.gaussian(0.0, 0.02)));
    }
    samples.add(signature.data(), place, i);
  }
  const FusionClassifier fused(samples, kPlaces, fusion());
  EXPECT_EQ(fused.calibration().left_out, "stretches");
  const PartCalibration &form = fused.calibration().parts[0], &color = fused.calibration().parts[1];
  EXPECT_LT(color.near_median, 0.1 * color.median);
  EXPECT_GT(color.near_weight / form.near_weight, 2.0 * color.weight / form.weight);
  EXPECT_NEAR(form.near_weight + color.near_weight, form.weight + color.weight, 1e-9)
      << "only the shares of the parts differ";
}

TEST(Fusion, CalibrationOfSharpPartsIsReadBack) {
  World world(13, true);
  Samples samples = world.learn(2);
  const FusionClassifier fused(samples, kPlaces, fusion());
  auto sharp = nlohmann::json::parse(fused.state());
  for (auto& part : sharp["parts"]) part["weight"] = part["near_weight"] = 5.0;
  EXPECT_NO_THROW(FusionClassifier(samples, kPlaces, fusion(), sharp.dump()));
  for (const PartCalibration& part : fused.calibration().parts) {
    EXPECT_LE(part.near_weight, 5.0);
  }
}

TEST(Fusion, OneTourIsCalibratedByStretchesAndTooFewFramesByNothing) {
  World world(3, true);
  // One tour that comes to each place twice.
  Samples twice = world.learn(1);
  for (int i = 0; i < 60; ++i) twice.add(world.look(i / 10).data(), i / 10, 60 + i);
  EXPECT_EQ(FusionClassifier(twice, kPlaces, fusion()).calibration().left_out, "stretches");
  const FusionClassifier few(world.learn(1, 1, 3), kPlaces, fusion());
  EXPECT_EQ(few.calibration().left_out, "nothing");
  EXPECT_EQ(few.calibration().frames, 0u);
  EXPECT_GT(few.calibration().parts[0].weight, few.calibration().parts[1].weight)
      << "without evidence colors are trusted less";
  Samples learned_elsewhere = world.learn(1, 1, 3);
  learned_elsewhere.parts[0].learned_elsewhere = true;
  const FusionClassifier own(learned_elsewhere, kPlaces, fusion());
  EXPECT_EQ(own.calibration().parts[0].weight, 0.0) << "nor is what was learned elsewhere";
  EXPECT_GT(own.calibration().parts[1].weight, 0.0);
}

TEST(Fusion, StrangerIsNovelAlsoWhereTooLittleWasLearnedToLeaveAnythingOut) {
  World world(10, true), elsewhere(11, true);
  const Samples samples = world.learn(1, 1, 3);
  FusionClassifier few(samples, kPlaces, fusion());
  ASSERT_EQ(few.calibration().left_out, "nothing");
  std::vector<double> p(kPlaces);
  const auto noveltyOf = [&](std::vector<float> look) {
    few.predict(look.data(), p.data());
    return few.novelty();
  };
  for (int place = 0; place < kPlaces; ++place) {
    const double known = noveltyOf(world.look(place));
    EXPECT_GT(known, 0.5);
    EXPECT_LT(known, 1.5) << "the unit is what learned frames are apart";
    EXPECT_GT(noveltyOf(elsewhere.look(place)), 1.2 * known);
  }
  FusionClassifier again(samples, kPlaces, fusion(), few.state());
  const auto look = world.look(1);
  again.predict(look.data(), p.data());
  EXPECT_EQ(again.novelty(), noveltyOf(look)) << "it is saved with the model";
}

TEST(Fusion, ProbabilitiesAreCalibratedOnFramesThatWereNotLearned) {
  World world(4, false);
  FusionClassifier fused(world.learn(3), kPlaces, fusion());
  std::vector<double> p(kPlaces);
  double said = 0.0, right = 0.0;
  constexpr int kFrames = 400;
  for (int i = 0; i < kFrames; ++i) {
    fused.predict(world.look(i % kPlaces).data(), p.data());
    const auto most = std::max_element(p.begin(), p.end());
    said += *most / kFrames;
    right += (most - p.begin() == i % kPlaces) / static_cast<double>(kFrames);
    double sum = 0.0;
    for (const double x : p) sum += x;
    ASSERT_NEAR(sum, 1.0, 1e-9);
  }
  EXPECT_NEAR(said, right, 0.08);
}

/// Looks of a place that differ in few ways, as images from one place do: with little noise the
/// principal components tell what is near.
std::vector<float> smoothLook(hyselam::Rng& rng, int place) {
  std::vector<float> signature;
  double ways[3];
  for (double& way : ways) way = rng.uniform(-1.0, 1.0);
  for (int k = 0; k < 2 * kPartSize; ++k) {
    double v = 1.5 + std::sin(1.7 * place + 0.9 * k * (place + 1));
    for (int w = 0; w < 3; ++w) v += 0.4 * ways[w] * std::cos(k * (w + 1.3) + place);
    v = std::max(0.0, v + rng.gaussian(0.0, 0.03));
    signature.push_back(static_cast<float>(v * v));
  }
  return signature;
}

/// The full scan is the oracle of the index.
TEST(Fusion, IndexFindsWhatAFullScanFinds) {
  for (const std::uint64_t seed : {5, 6, 7}) {
    hyselam::Rng rng(seed);
    Samples samples = World(seed, true).learn(0);
    for (int frame = 0; frame < 600; ++frame) {
      const int place = frame / 10 % kPlaces;
      samples.add(smoothLook(rng, place).data(), place, frame / 300 * 1000 + frame);
    }
    FusionClassifier indexed(samples, kPlaces, fusion()),
        scanned(samples, kPlaces, fusion(), indexed.state(), true);
    std::vector<double> a(kPlaces), b(kPlaces);
    int same_nearest = 0;
    constexpr int kFrames = 100;
    for (int i = 0; i < kFrames; ++i) {
      const auto signature = smoothLook(rng, i % kPlaces);
      indexed.predict(signature.data(), a.data());
      scanned.predict(signature.data(), b.data());
      for (std::size_t k = 0; k < a.size(); ++k) ASSERT_NEAR(a[k], b[k], 0.01) << seed;
      same_nearest += std::abs(indexed.novelty() - scanned.novelty()) < 1e-6;
    }
    EXPECT_GE(same_nearest, 98) << seed;
  }
}

/// All parts of all views added up is the oracle.
TEST(Fusion, DistancesAreThoseOfThePartsOfAllViews) {
  hyselam::Rng rng(12);
  Samples samples = World(12, true).learn(0);
  for (int frame = 0; frame < 600; ++frame) {
    const int place = frame / 10 % kPlaces;
    for (int view = 0; view < 3; ++view) {
      samples.add(smoothLook(rng, place).data(), place, frame / 300 * 1000 + frame);
    }
  }
  for (const bool full_scan : {false, true}) {
    const std::string state = FusionClassifier(samples, kPlaces, fusion()).state();
    FusionClassifier fused(samples, kPlaces, fusion(), state, full_scan);
    const FrameIndex frames(samples);
    std::vector<double> p(kPlaces);
    for (int i = 0; i < 10; ++i) {
      const auto signature = smoothLook(rng, i % kPlaces);
      fused.predict(signature.data(), p.data());
      std::vector<float> expected(samples.count(), 1.0f);
      std::size_t offset = 0, estimated = 0;
      for (std::size_t part = 0; part < 2; ++part) {
        PartExemplars exemplars(samples, frames, offset, samples.parts[part], full_scan);
        const float least = exemplars.search(signature.data() + offset).front().distance,
                    weight = static_cast<float>((*fused.opinions())[part].weight);
        std::vector<float> d(samples.count());
        for (std::size_t f = 0; f < frames.count(); ++f) {
          for (auto k = frames.begin[f]; k < frames.begin[f + 1]; ++k) {
            d[k] = exemplars.frameDistances()[f];
          }
        }
        for (const Neighbor& n : exemplars.compared()) d[n.sample] = n.distance;
        estimated += samples.count() - exemplars.compared().size();
        for (std::size_t k = 0; k < d.size(); ++k) {
          expected[k] += 5.3f * weight * std::clamp((d[k] - least) / least, 0.0f, 1.0f);
        }
        offset += static_cast<std::size_t>(samples.parts[part].size);
      }
      EXPECT_EQ(estimated > 0, !full_scan);
      const std::vector<float>& distances = *fused.distances();
      ASSERT_EQ(distances.size(), expected.size());
      for (std::size_t k = 0; k < expected.size(); ++k) {
        ASSERT_NEAR(distances[k], expected[k], 1e-5f) << k;
      }
    }
  }
}

/// Ordering all frames by the estimate is the oracle.
TEST(Fusion, FramesThatAreComparedAreTheNearestByTheEstimate) {
  hyselam::Rng rng(13);
  Samples samples = World(13, true).learn(0);
  for (int frame = 0; frame < 3000; ++frame) {
    const int place = frame % kPlaces;
    // Many frames are there several times: equally far.
    if (frame % 3 == 0 || samples.count() == 0) {
      samples.add(smoothLook(rng, place).data(), place, frame);
    } else {
      const std::vector<float> again(samples.row(samples.count() - 1),
                                     samples.row(samples.count() - 1) + samples.size);
      samples.add(again.data(), samples.places.back(), frame);
    }
  }
  const FrameIndex frames(samples);
  PartExemplars exemplars(samples, frames, 0, samples.parts[0], false);
  for (int i = 0; i < 40; ++i) {
    std::vector<char> blocked(frames.count(), 0);
    for (char& b : blocked) b = i % 2 == 1 && rng.below(20) != 0;
    exemplars.search(smoothLook(rng, i % kPlaces).data(), &blocked);
    const std::vector<float>& d = exemplars.frameDistances();
    std::vector<std::uint32_t> order;
    for (std::uint32_t f = 0; f < frames.count(); ++f) {
      if (blocked[f] == 0) order.push_back(f);
    }
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return d[a] < d[b]; });
    order.resize(80);
    std::sort(order.begin(), order.end());
    ASSERT_EQ(exemplars.comparedFrames(), order) << i;
  }
}

TEST(Fusion, LearnedSignatureIsItsOwnNearestNeighbor) {
  World world(8, true);
  const Samples samples = world.learn(6, 2, 15);  // so many that the index is used
  const FrameIndex frames(samples);
  PartExemplars exemplars(samples, frames, 0, samples.parts[0], false);
  for (std::size_t i = 0; i < samples.count(); i += 2) {  // the first views
    const auto& nearest = exemplars.search(samples.row(i));
    ASSERT_EQ(nearest.front().sample, i);
    ASSERT_LT(nearest.front().distance, 1e-4f);
    ASSERT_TRUE(std::is_sorted(nearest.begin(), nearest.end(), [](const auto& a, const auto& b) {
      return a.distance < b.distance;
    }));
  }
  std::vector<char> all(frames.count(), 1);
  EXPECT_TRUE(exemplars.search(samples.row(0), &all).empty());
}

TEST(Fusion, CalibrationIsReadBackAndOthersAreRefused) {
  World world(9, true);
  const Samples samples = world.learn(2);
  FusionClassifier fused(samples, kPlaces, fusion());
  FusionClassifier again(samples, kPlaces, fusion(), fused.state());
  EXPECT_EQ(again.state(), fused.state());
  const auto signature = world.look(2, 0.3);
  std::vector<double> a(kPlaces), b(kPlaces);
  fused.predict(signature.data(), a.data());
  again.predict(signature.data(), b.data());
  EXPECT_EQ(a, b);
  const auto good = nlohmann::json::parse(fused.state());
  const auto refused = [&](nlohmann::json j) {
    EXPECT_THROW(FusionClassifier(samples, kPlaces, fusion(), j.dump()), InputError) << j;
  };
  for (const char* key : {"left_out", "temperature", "parts", "frames", "unknown_novelty"}) {
    auto j = good;
    j.erase(key);
    refused(j);
  }
  auto j = good;
  j["temperature"] = 0.0;
  refused(j);
  j = good;
  j["parts"][1]["name"] = "texture";
  refused(j);
  j = good;
  j["parts"].erase(1);
  refused(j);
  j = good;
  j["parts"][0]["weight"] = -1.0;
  refused(j);
  j = good;
  j["parts"][0]["near_weight"] = -1.0;
  refused(j);
  j = good;
  j["parts"][0].erase("near_median");
  refused(j);
  j = good;
  j["parts"][0]["largest"] = j["parts"][0]["median"];
  refused(j);
  j = good;
  for (auto& part : j["parts"]) {  // as older models are
    part.erase("near_weight");
    part.erase("near_median");
  }
  const FusionClassifier older(samples, kPlaces, fusion(), j.dump());
  EXPECT_EQ(older.calibration().parts[0].near_weight, older.calibration().parts[0].weight);
  EXPECT_THROW(FusionClassifier(samples, kPlaces, fusion(), "no json"), InputError);
  Samples without = samples;
  without.parts.clear();
  EXPECT_THROW(FusionClassifier(without, kPlaces, fusion()), InputError);
}

cv::Mat scene(std::uint64_t seed) {
  hyselam::Rng rng(seed);
  cv::Mat image(120, 160, CV_8UC3, cv::Scalar(90, 110, 130));
  for (int i = 0; i < 25; ++i) {
    const cv::Rect box(static_cast<int>(rng.below(130)), static_cast<int>(rng.below(90)), 30, 30);
    image(box).setTo(cv::Scalar(30 + rng.below(90), 30 + rng.below(90), 30 + rng.below(90)));
  }
  return image;
}

cv::Mat inLight(const cv::Mat& image, double blue, double green, double red) {
  cv::Mat lit;
  cv::multiply(image, cv::Scalar(blue, green, red), lit);
  return lit;
}

double distance(const std::string& descriptor, const cv::Mat& a, const cv::Mat& b) {
  const auto d = makeDescriptor(descriptor);
  const auto u = d->compute(a), v = d->compute(b);
  double sum = 0.0;
  for (std::size_t i = 0; i < u.size(); ++i) sum += (u[i] - v[i]) * (u[i] - v[i]);
  return std::sqrt(sum);
}

TEST(ColorLayout, LogChromaAndRanksAreIndifferentToTheColorOfLight) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const cv::Mat a = scene(seed), other = scene(seed + 100), warm = inLight(a, 0.6, 1.0, 1.4);
    EXPECT_LT(distance("LOGCHROMA", a, warm), 0.3 * distance("LOGCHROMA", a, other));
    EXPECT_LT(distance("RANKS", a, warm), 0.1 * distance("RANKS", a, other));
    EXPECT_GT(distance("HSV-HIST", a, warm), 0.5 * distance("HSV-HIST", a, other))
        << "a histogram of colors as they are does hang on it";
  }
}

TEST(ColorLayout, HistogramCountsEveryPixelOnce) {
  const auto h = makeDescriptor("HSV-HIST")->compute(scene(3));
  double sum = 0.0;
  for (const float v : h) sum += v;
  EXPECT_NEAR(sum, 1.0, 1e-3);
  const auto red = makeDescriptor("HSV-HIST")->compute(cv::Mat(50, 70, CV_8UC3, {0, 0, 255}));
  EXPECT_NEAR(red[15], 1.0f, 1e-3f) << "hue 0, the highest saturation, the highest value";
}

/// Three rooms, 30 frames in each: something moves through each, and no two tours are the same.
TrainingFrame frameOf(std::size_t tour, std::size_t i) {
  const int place = static_cast<int>(i / 30 % 3);
  cv::Mat image = scene(static_cast<std::uint64_t>(place) + 1);
  const int x = static_cast<int>(20 + 4 * (i % 30) + 2 * tour);
  cv::circle(image, {x, 55 + 5 * static_cast<int>(tour)}, 8, cv::Scalar(20, 200, 90), -1);
  hyselam::Rng rng(1000 * tour + i);
  for (int y = 0; y < image.rows; ++y) {
    for (int k = 0; k < 3 * image.cols; ++k) {
      std::uint8_t& v = image.ptr(y)[k];
      v = cv::saturate_cast<std::uint8_t>(v + rng.gaussian(0.0, 3.0));
    }
  }
  return {image, {}, "room " + std::to_string(place), {0.3 * static_cast<double>(i), 0.0, 0.0}};
}

PlaceModel learnedModel() {
  return trainPlaceModel({90, 90}, frameOf, {});
}

TEST(Fusion, DefaultModelTellsItsPartsInTheManifestAndIsReadBack) {
  TemporaryDirectory folder;
  const PlaceModel model = learnedModel();
  EXPECT_EQ(model.descriptor, "FUSION-LEARNT");
  EXPECT_EQ(model.classifier.kernel, SvmKernel::kFusion);
  EXPECT_EQ(model.views.size(), 5u);
  savePlaceModel(model, folder / "m");
  const std::string manifest = folder / "m/model.json";
  const auto j = nlohmann::json::parse(fileBytes(manifest));
  EXPECT_EQ(j["fusion"]["left_out"], "tours");
  std::vector<std::string> parts;
  for (const auto& part : j["fusion"]["parts"]) parts.push_back(part["name"]);
  EXPECT_EQ(parts, (std::vector<std::string>{"LGOP", "H-GIST", "SV-GIST", "LBPbyHSV-U8N", "SLBP",
                                             "HSV-HIST", "LOGCHROMA", "RANKS", "LEARNT"}));
  const PlaceModel again = loadPlaceModel(folder / "m");
  EXPECT_EQ(again.svm, model.svm);
  EXPECT_EQ(again.samples.parts.size(), 9u);
  auto bad = j;
  bad["fusion"]["parts"][0]["weight"] = "much";
  writeFile(manifest, bad.dump());
  EXPECT_NE(messageOf<InputError>([&] { loadPlaceModel(folder / "m"); }).find("fusion"),
            std::string::npos);
  bad.erase("fusion");
  writeFile(manifest, bad.dump());
  EXPECT_THROW(loadPlaceModel(folder / "m"), InputError);
}

TEST(Fusion, FrameInAnUnlearnedLightIsToldAndRecognized) {
  const PlaceModel model = learnedModel();
  ImageRecognizerParams params;
  params.filter.kind = PlaceFilterKind::kNone;
  ImageRecognizer r(model, model.transitions, params);
  for (int place = 0; place < 3; ++place) {
    const cv::Mat image = frameOf(2, static_cast<std::size_t>(30 * place + 7)).image;
    EXPECT_EQ(r.update(image).frame_place, place);
    EXPECT_FALSE(r.lightIsUnlearned());
    EXPECT_EQ(r.update(inLight(image, 0.45, 0.8, 1.0)).frame_place, place);
    EXPECT_TRUE(r.lightIsUnlearned());
  }
}

TEST(ImageRecognizer, AutoFollowsPosesWithOdometryAndPlacesWithout) {
  const PlaceModel model = learnedModel();
  ImageRecognizerParams automatic, poses, bayes;
  poses.filter.kind = PlaceFilterKind::kPoses;
  bayes.filter.kind = PlaceFilterKind::kBayes;
  EXPECT_EQ(automatic.filter.kind, PlaceFilterKind::kAuto);
  const auto at = [&](ImageRecognizer& r, std::size_t i, bool odometry) {
    SensorReadings readings;
    readings.stamp = static_cast<double>(i);
    if (odometry) readings.odometry = hyselam::Pose2{0.3 * static_cast<double>(i), 0.0, 0.0};
    r.updateWithSignature(model.samples.row(5 * i), readings);
    return r.probabilities();
  };
  ImageRecognizer a(model, model.transitions, automatic), b(model, model.transitions, poses),
      c(model, model.transitions, automatic), d(model, model.transitions, bayes);
  for (std::size_t i = 0; i < 20; ++i) {
    EXPECT_EQ(at(a, i, true), at(b, i, true));
    EXPECT_EQ(at(c, i, false), at(d, i, false));
  }
}

}  // namespace
}  // namespace selovis
