// Filters over time, classifiers against libsvm, models on disk, place graphs.
#include <gtest/gtest.h>
#include <libsvm/svm.h>

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

/// a - b - c - d in a row, e joined to b, f alone.
PlaceGraph sixPlaces() {
  return {{"a", "b", "c", "d", "e", "f"}, {{0, 1}, {1, 2}, {2, 3}, {1, 4}}};
}

TEST(PlaceGraph, ShortestPathsTellDistanceAndFirstStep) {
  const PlaceDistances p = shortestPaths(sixPlaces());
  const auto d = [&](int i, int j) { return p.distance[static_cast<std::size_t>(i * 6 + j)]; };
  const auto a = [&](int i, int j) { return p.first_step[static_cast<std::size_t>(i * 6 + j)]; };
  EXPECT_EQ(d(3, 0), 3);
  EXPECT_EQ(a(3, 0), 1);  // from a towards d: b comes first
  EXPECT_EQ(a(0, 3), 2);
  EXPECT_EQ(a(4, 2), 1);
  EXPECT_EQ(d(5, 0), -1);
  EXPECT_EQ(a(5, 0), -1);
  EXPECT_EQ(d(2, 2), 0);
}

TEST(PlaceGraph, JsonAndEdgeListAreTheSame) {
  TemporaryDirectory folder;
  writeFile(folder / "g.json",
            R"({"places": ["a", "b", "c"], "transitions": [["a", "b"], ["c", "b"]]})");
  writeFile(folder / "g.csv", "from,to\na,b\r\n# note\n\nb,c\na,b\n");
  const PlaceGraph x = readPlaceGraph(folder / "g.json"), y = readPlaceGraph(folder / "g.csv");
  EXPECT_EQ(x.places, y.places);
  EXPECT_EQ(x.transitions, y.transitions);
  EXPECT_TRUE(x.connected(2, 1));
  EXPECT_FALSE(x.connected(0, 2));
}

TEST(PlaceGraph, BadFilesAreNamed) {
  TemporaryDirectory folder;
  const std::pair<const char*, const char*> cases[] = {
      {"", "no places"},
      {"a,b,c\n", "line 1"},
      {"a,b\n,c\n", "line 2"},
      {"{\"places\": [\"a\"]}", "transitions"},
      {"{\"places\": [\"a\", \"a\"], \"transitions\": []}", "twice"},
      {"{\"places\": [\"a\"], \"transitions\": [[\"a\", \"x\"]]}", "not listed"},
      {"{\"places\": 3", "is no place graph"}};
  for (const auto& c : cases) {
    writeFile(folder / "g", c.first);
    const std::string what = messageOf<InputError>([&] { readPlaceGraph(folder / "g"); });
    EXPECT_NE(what.find(c.second), std::string::npos) << c.first << ": " << what;
  }
  EXPECT_THROW(readPlaceGraph(folder / "none"), InputError);
}

TEST(PlaceFilter, LowPassIsEq615) {
  PlaceFilterParams p;
  p.kind = FilterKind::kLowPass;
  p.alpha = 2.0;
  PlaceFilter filter({{"a", "b"}, {}}, p);
  filter.update({0.6, 0.4});
  EXPECT_NEAR(filter.probabilities()[0], 0.6, 1e-12);
  filter.update({0.0, 1.0});
  EXPECT_NEAR(filter.probabilities()[0], 1.2 / 3.0, 1e-12);
}

/// Eq. 6.21 to 6.25 as they stand, with the row scaled as in the filter.
std::vector<double> plainMarkov(const PlaceGraph& g, const PlaceFilterParams& p,
                                const std::vector<double>& state,
                                const std::vector<double>& rating) {
  const int n = static_cast<int>(g.places.size());
  const PlaceDistances paths = shortestPaths(g);
  const double largest = *std::max_element(rating.begin(), rating.end());
  std::vector<std::vector<double>> t(n, std::vector<double>(n, 0.0));
  for (int j = 0; j < n; ++j) {
    double leaving = 0.0;
    for (int i = 0; i < n; ++i) {
      const int d = paths.distance[i * n + j];
      if (i == j || d < 0) continue;
      const double q = std::pow(p.rho1 / d, p.rho2) * rating[i] * largest;
      t[paths.first_step[i * n + j]][j] += q;
      leaving += q;
    }
    if (leaving > 1.0 - p.stay_min) {
      for (int i = 0; i < n; ++i) t[i][j] *= (1.0 - p.stay_min) / leaving;
      leaving = 1.0 - p.stay_min;
    }
    t[j][j] = 1.0 - leaving;
  }
  std::vector<double> next(n, 0.0);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) next[i] += t[i][j] * state[j];
  }
  return next;
}

PlaceGraph randomGraph(hyselam::Rng& rng) {
  PlaceGraph g;
  const int n = 1 + static_cast<int>(rng.below(15));
  for (int i = 0; i < n; ++i) g.places.push_back("p" + std::to_string(i));
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < i; ++j) {
      if (rng.below(4) == 0) g.transitions.emplace_back(i, j);
    }
  }
  return g;
}

std::vector<double> randomRatings(hyselam::Rng& rng, std::size_t n) {
  std::vector<double> r(n);
  double sum = 0.0;
  for (double& v : r) sum += v = rng.below(3) == 0 ? 0.0 : std::pow(rng.uniform(), 4.0);
  if (sum == 0.0) return std::vector<double>(n, 1.0 / static_cast<double>(n));
  for (double& v : r) v /= sum;
  return r;
}

TEST(PlaceFilter, MarkovChainEqualsTheTranscription) {
  hyselam::Rng rng(21);
  for (int round = 0; round < 200; ++round) {
    const PlaceGraph g = randomGraph(rng);
    PlaceFilterParams p;
    p.rho1 = rng.uniform(0.2, 5.0);
    p.rho2 = rng.uniform(0.0, 4.0);
    PlaceFilter filter(g, p);
    std::vector<double> state = filter.probabilities();
    for (int k = 0; k < 20; ++k) {
      const auto rating = randomRatings(rng, state.size());
      state = plainMarkov(g, p, state, rating);
      filter.update(rating);
      for (std::size_t i = 0; i < state.size(); ++i)
        ASSERT_NEAR(filter.probabilities()[i], state[i], 1e-9);
    }
  }
}

TEST(PlaceFilter, EveryFilterKeepsADistributionAndEveryColumnOfTheChainIsOne) {
  hyselam::Rng rng(22);
  for (int round = 0; round < 300; ++round) {
    const PlaceGraph g = randomGraph(rng);
    const std::size_t n = g.places.size();
    for (const FilterKind kind :
         {FilterKind::kNone, FilterKind::kLowPass, FilterKind::kMarkov, FilterKind::kBayes}) {
      PlaceFilterParams p;
      p.kind = kind;
      p.rho1 = rng.uniform(0.01, 100.0);
      p.rho2 = rng.uniform(0.0, 10.0);
      p.alpha = rng.uniform(0.0, 50.0);
      p.trust = rng.uniform(0.1, 3.0);
      PlaceFilter filter(g, p);
      for (int k = 0; k < 30; ++k) {
        auto observed = randomRatings(rng, n);
        for (double& v : observed) v *= rng.uniform(0.5, 2.0);  // need not sum to 1
        filter.update(observed);
        double sum = 0.0;
        for (const double v : filter.probabilities()) {
          ASSERT_GE(v, 0.0);
          sum += v;
        }
        ASSERT_NEAR(sum, 1.0, 1e-9);
        for (std::size_t j = 0; kind == FilterKind::kMarkov && j < n; ++j) {
          double column = 0.0;
          for (std::size_t i = 0; i < n; ++i) {
            ASSERT_GE(filter.transition()[i * n + j], 0.0);
            column += filter.transition()[i * n + j];
          }
          ASSERT_NEAR(column, 1.0, 1e-9);
        }
      }
    }
  }
}

TEST(PlaceFilter, TheChainDoesNotJumpButComesRound) {
  PlaceFilter filter(sixPlaces(), {});
  for (int k = 0; k < 30; ++k) filter.update({0.9, 0.02, 0.02, 0.02, 0.02, 0.02});
  EXPECT_EQ(filter.estimate().place, 0);
  filter.update({0.02, 0.02, 0.02, 0.9, 0.02, 0.02});  // one outlier, three doors away
  EXPECT_NE(filter.estimate().place, 3);
  for (int k = 0; k < 30; ++k) filter.update({0.02, 0.02, 0.02, 0.9, 0.02, 0.02});
  EXPECT_EQ(filter.estimate().place, 3);
}

TEST(PlaceFilter, TwoLikelyNeighboursAreATransition) {
  PlaceFilterParams p;
  p.kind = FilterKind::kNone;
  PlaceFilter filter(sixPlaces(), p);
  filter.update({0.45, 0.4, 0.15, 0.0, 0.0, 0.0});
  EXPECT_EQ(filter.estimate().place, 0);
  EXPECT_EQ(filter.estimate().second, 1);
  filter.update({0.45, 0.0, 0.4, 0.15, 0.0, 0.0});  // likely both, but no door between them
  EXPECT_EQ(filter.estimate().second, -1);
  filter.update({0.6, 0.24, 0.1, 0.06, 0.0, 0.0});
  EXPECT_EQ(filter.estimate().second, -1);
}

TEST(PlaceFilter, UnknownBelowTheLimitAndBadProbabilitiesAreRefused) {
  PlaceFilterParams p;
  p.kind = FilterKind::kNone;
  p.unknown_below = 0.5;
  PlaceFilter filter(sixPlaces(), p);
  EXPECT_EQ(filter.estimate().place, -1);  // nothing seen yet
  filter.update({0.4, 0.3, 0.3, 0, 0, 0});
  EXPECT_EQ(filter.estimate().place, -1);
  filter.update({0.6, 0.2, 0.2, 0, 0, 0});
  EXPECT_EQ(filter.estimate().place, 0);
  EXPECT_THROW(filter.update({0.5, 0.5}), std::invalid_argument);
  EXPECT_THROW(filter.update({0.5, -0.1, 0.6, 0, 0, 0}), std::invalid_argument);
  EXPECT_THROW(filter.update({NAN, 0, 0, 0, 0, 0}), std::invalid_argument);
  filter.update({0, 0, 0, 0, 0, 0});  // tells nothing
  EXPECT_EQ(filter.estimate().place, 0);
  p.alpha = -1.0;
  EXPECT_THROW(PlaceFilter(sixPlaces(), p), hyselam::ParameterError);
  EXPECT_THROW(filterKind("median"), std::invalid_argument);
}

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

/// A ring road of radius 5 m with four places, learnt by driving round it twice. Opposite places
/// look alike, each its own half way round.
struct Ring {
  Ring() {
    samples.size = 2;
    for (int i = 0; i < 200; ++i) {
      const float at[2] = {look(angle(i), 0), look(angle(i), 1)};
      samples.add(at, placeAt(angle(i)), i, pose(i));
    }
  }
  static double angle(double i) { return 2.0 * hyselam::kPi * i / 100.0; }
  static int placeAt(double angle) {
    return static_cast<int>(std::fmod(angle, 2.0 * hyselam::kPi) / (0.5 * hyselam::kPi));
  }
  static float look(double angle, int axis) {
    // Twice the angle: the far side of the ring looks the same, but for a quarter of it.
    if (std::fmod(angle, 2.0 * hyselam::kPi) < 0.5 * hyselam::kPi) return axis == 0 ? 3.0f : 3.0f;
    return static_cast<float>(1.0 +
                              0.5 * (axis == 0 ? std::cos(2.0 * angle) : std::sin(2.0 * angle)));
  }
  static hyselam::Pose2 pose(double i) {
    return {5.0 * std::cos(angle(i)), 5.0 * std::sin(angle(i)), angle(i) + 0.5 * hyselam::kPi};
  }
  /// Drives round once from step 5 and tells the share of frames in the right place after the first
  /// quarter; `drift` of the odometry's frame against the map.
  double drive(PoseFilter& filter, bool odometry) const {
    ClassifierParams params;
    params.kernel = Kernel::kExemplar;
    params.power = 1.0;
    const auto classifier = trainClassifier(samples, 4, params, nullptr);
    const hyselam::Pose2 frame{3.0, -7.0, 1.0};
    std::vector<double> p(4);
    int right = 0;
    for (int i = 5; i < 105; ++i) {
      const float at[2] = {look(angle(i), 0), look(angle(i), 1)};
      classifier->predict(at, p.data());
      filter.update(*classifier->distances(),
                    odometry ? std::optional<hyselam::Pose2>(frame * pose(i)) : std::nullopt);
      const auto& state = filter.probabilities();
      const int place =
          static_cast<int>(std::max_element(state.begin(), state.end()) - state.begin());
      if (i >= 30) right += place == placeAt(angle(i));
    }
    return right / 75.0;
  }
  Samples samples;
};

TEST(PoseFilter, OdometryTellsPlacesThatLookAlikeApart) {
  const Ring ring;
  PoseFilterParams params;
  params.jump = 0.0;
  PoseFilter filter(ring.samples, 4, params);
  EXPECT_GT(ring.drive(filter, true), 0.9);
  double sum = 0.0;
  for (const double p : filter.probabilities()) sum += p;
  EXPECT_NEAR(sum, 1.0, 1e-9);
}

TEST(PoseFilter, IsTheSameEveryTimeAndAfterReset) {
  const Ring ring;
  PoseFilter a(ring.samples, 4, {}), b(ring.samples, 4, {});
  ring.drive(a, true);
  ring.drive(b, true);
  EXPECT_EQ(a.probabilities(), b.probabilities());
  const std::vector<double> first = a.probabilities();
  a.reset();
  EXPECT_EQ(a.probabilities(), std::vector<double>(4, 0.25));
  ring.drive(a, true);
  EXPECT_EQ(a.probabilities(), first);
  ring.drive(a, false);  // without odometry it only has to live on
  for (const double p : a.probabilities()) EXPECT_TRUE(p >= 0.0 && p <= 1.0);
}

/// Distances of step i of the ring to all samples, as the exemplar kernel gives them.
std::vector<float> distancesAt(const Ring& ring, double i) {
  std::vector<float> d;
  for (std::size_t s = 0; s < ring.samples.count(); ++s) {
    const float x = ring.samples.row(s)[0] - Ring::look(Ring::angle(i), 0),
                y = ring.samples.row(s)[1] - Ring::look(Ring::angle(i), 1);
    d.push_back(x * x + y * y + 0.01f);
  }
  return d;
}

/// Drives a quarter round; `odometry(i)` is told at step i, one step a second unless said.
template <typename F>
std::vector<double> quarterRound(const Ring& ring, F odometry, double seconds = 1.0) {
  PoseFilterParams params;
  params.jump = 0.0;
  PoseFilter filter(ring.samples, 4, params);
  for (int i = 5; i < 45; ++i) filter.update(distancesAt(ring, i), odometry(i), seconds);
  return filter.probabilities();
}

TEST(PoseFilter, OdometryThatIsNoNumberOrJumpsIsNoOdometry) {
  const Ring ring;
  const double nan = std::nan("");
  using Odometry = std::optional<hyselam::Pose2>;
  const auto with = [&](const Odometry& odd) {
    return quarterRound(ring, [&](int i) { return i == 30 ? odd : Odometry(Ring::pose(i)); });
  };
  const auto without = with({});
  EXPECT_GT(without[1], 0.9);
  EXPECT_EQ(with(hyselam::Pose2{nan, 0.0, 0.0}), without);
  EXPECT_EQ(with(hyselam::Pose2{0.0, 0.0, nan}), without);
  // To the other end of the world, and begun again from elsewhere: the places before are kept.
  for (const double x : {1e300, -1e9, 100.0}) {
    const auto p = quarterRound(ring, [&](int i) {
      hyselam::Pose2 pose = Ring::pose(i);
      if (i >= 30) pose.x += x;
      return Odometry(pose);
    });
    EXPECT_GT(p[1], 0.9) << x;
  }
}

TEST(PoseFilter, LivesOnWhenTimeGoesBackOrIsNoNumber) {
  const Ring ring;
  for (const double seconds : {-100.0, std::nan(""), 0.0, 1e12}) {
    for (const bool odometry : {false, true}) {
      const auto p = quarterRound(
          ring,
          [&](int i) {
            return odometry ? std::optional<hyselam::Pose2>(Ring::pose(i)) : std::nullopt;
          },
          seconds);
      EXPECT_NEAR(p[0] + p[1] + p[2] + p[3], 1.0, 1e-9) << seconds;
    }
  }
}

TEST(PoseFilter, DrivenOutOfAllThatWasLearntItBeginsAgainWithThatFrame) {
  const Ring ring;
  PoseFilterParams params;
  params.jump = 0.0;
  PoseFilter filter(ring.samples, 4, params), fresh(ring.samples, 4, params);
  filter.update(distancesAt(ring, 10), hyselam::Pose2{0.0, 0.0, 0.0});
  filter.update(distancesAt(ring, 10), hyselam::Pose2{900.0, 0.0, 0.0}, 1000.0);
  fresh.update(distancesAt(ring, 10), {});
  EXPECT_EQ(filter.probabilities(), fresh.probabilities());
  EXPECT_GT(filter.probabilities()[0], 0.9);
}

TEST(PoseFilter, ARobotThatWasCarriedIsFoundAgainAtThirtyFramesASecond) {
  const Ring ring;
  PoseFilterParams params;
  params.particles = 200;  // 0.13 of a particle is set anew in each frame
  PoseFilter filter(ring.samples, 4, params);
  const hyselam::Pose2 still;
  for (int i = 0; i < 300; ++i) filter.update(distancesAt(ring, 60), still, 1.0 / 30.0);
  for (int i = 0; i < 1800; ++i) filter.update(distancesAt(ring, 12), still, 1.0 / 30.0);
  EXPECT_GT(filter.probabilities()[0], 0.9);
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

TEST(PoseFilter, RefusesWhatItCannotUse) {
  Ring ring;
  PoseFilterParams params;
  params.particles = 1;
  EXPECT_THROW(PoseFilter(ring.samples, 4, params), hyselam::ParameterError);
  PoseFilter filter(ring.samples, 4, {});
  EXPECT_THROW(filter.update(std::vector<float>(3, 1.0f), {}), std::invalid_argument);
  ring.samples.poses.back().x = 1e9;
  EXPECT_NE(messageOf<std::invalid_argument>([&] { PoseFilter(ring.samples, 4, {}); }).find("5 km"),
            std::string::npos);
  std::fill(ring.samples.poses.begin(), ring.samples.poses.end(), kNoPose);
  EXPECT_NE(messageOf<std::invalid_argument>([&] { PoseFilter(ring.samples, 4, {}); }).find("pose"),
            std::string::npos);
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
