// Kinds of regions along ways: features that do not depend on how the robot stands, the decision
// against all sequences, the forest and its file.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/rng.hpp"
#include "hyselam_common/testing/files.hpp"
#include "ngram_slam/semantics/way_forest.hpp"

namespace ngram_slam {
namespace {

using hyselam::Rng;
using hyselam::testing::fileBytes;
using hyselam::testing::TemporaryDirectory;
using hyselam::testing::writeFile;

template <typename Error, typename Run>
std::string messageOf(Run run) {
  try {
    run();
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

/// Distances in cells of a map, as they are, with ties.
PlaceFeatures somePlace(Rng& rng) {
  PlaceFeatures f;
  double distance = rng.uniform(0.5, 8.0);
  for (float& d : f.distances) {
    if (rng.uniform() < 0.2) distance = rng.uniform(0.4, 18.0);
    d = 0.2F * static_cast<float>(std::lround(distance / 0.2));
  }
  for (float& d : f.densities) d = static_cast<float>(rng.uniform());
  for (auto& sector : f.context) {
    for (auto& cells : sector) cells = static_cast<std::uint16_t>(rng.below(4));
  }
  return f;
}

/// Turned by so many twelfths of a circle.
PlaceFeatures turned(const PlaceFeatures& f, std::size_t twelfths) {
  PlaceFeatures out = f;
  const std::size_t beams = f.distances.size() / 12, sectors = f.context.size() / 12;
  for (std::size_t b = 0; b < f.distances.size(); ++b) {
    out.distances[(b + twelfths * beams) % f.distances.size()] = f.distances[b];
  }
  for (std::size_t s = 0; s < f.context.size(); ++s) {
    out.context[(s + twelfths * sectors) % f.context.size()] = f.context[s];
  }
  return out;
}

PlaceFeatures mirrored(const PlaceFeatures& f) {
  PlaceFeatures out = f;
  for (std::size_t b = 0; b < f.distances.size(); ++b) {
    out.distances[(f.distances.size() - b) % f.distances.size()] = f.distances[b];
  }
  std::reverse(out.context.begin(), out.context.end());
  return out;
}

std::vector<WayPlace> someRun(Rng& rng, std::size_t size) {
  std::vector<WayPlace> run;
  hyselam::Pose2 pose{1.0, -2.0, 0.3};
  for (std::size_t i = 0; i < size; ++i) {
    run.push_back({0.25 * static_cast<double>(i), pose, wayShapeOf(somePlace(rng))});
    pose = pose * hyselam::Pose2{0.25, 0.0, rng.uniform(-0.5, 0.5)};
  }
  return run;
}

std::size_t indexOfFeature(const std::string& name) {
  const auto& names = wayFeatureNames();
  const auto at = std::find(names.begin(), names.end(), name);
  EXPECT_NE(at, names.end()) << name;
  return static_cast<std::size_t>(at - names.begin());
}

void expectNear(const std::vector<float>& a, const std::vector<float>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t k = 0; k < a.size(); ++k) {
    EXPECT_NEAR(a[k], b[k], 1e-3) << wayFeatureNames()[k];
  }
}

TEST(WayShape, isTheSameWhicheverWayTheRobotFaces) {
  Rng rng(1);
  for (int i = 0; i < 300; ++i) {
    const PlaceFeatures f = somePlace(rng);
    const WayShape shape = wayShapeOf(f);
    for (const WayShape& other :
         {wayShapeOf(turned(f, 1 + rng.below(11))), wayShapeOf(mirrored(f))}) {
      for (std::size_t k = 0; k < kWayShape; ++k) {
        EXPECT_NEAR(shape[k], other[k], 1e-4) << i << " " << wayFeatureNames()[k];
      }
    }
  }
}

TEST(WayShape, tellsACorridorFromAPlaceWhereThreeWaysMeet) {
  PlaceFeatures corridor, meeting;
  for (std::size_t b = 0; b < PlaceFeatures::kBeams; ++b) {
    const double angle = 2.0 * hyselam::kPi * static_cast<double>(b) / PlaceFeatures::kBeams;
    const double to_wall = 1.0 / std::max(1e-9, std::abs(std::sin(angle)));
    corridor.distances[b] = static_cast<float>(std::min(15.0, to_wall));
    const double to_end = 1.0 / std::max(1e-9, std::abs(std::cos(angle)));
    meeting.distances[b] = std::sin(angle) > 0.0
                               ? static_cast<float>(std::min(15.0, std::max(to_wall, to_end)))
                               : corridor.distances[b];
  }
  const WayShape c = wayShapeOf(corridor), m = wayShapeOf(meeting);
  EXPECT_FLOAT_EQ(c[indexOfFeature("openings_3")], 2.0F);
  EXPECT_FLOAT_EQ(m[indexOfFeature("openings_3")], 3.0F);
  EXPECT_FLOAT_EQ(c[indexOfFeature("angle_3")], 180.0F);
  EXPECT_NEAR(c[indexOfFeature("across_shortest")], 2.0F, 0.01F);
  EXPECT_NEAR(c[indexOfFeature("across_longest")], 24.0F, 0.01F);  // 12 m are far
  EXPECT_NEAR(c[indexOfFeature("across_longest's_side")], 2.0F, 0.1F);
}

TEST(WayFeatures, areTheSameOnTheWayBack) {
  Rng rng(2);
  for (const std::size_t size : {1U, 2U, 7U, 90U}) {
    const std::vector<WayPlace> run = someRun(rng, size);
    std::vector<WayPlace> back(run.rbegin(), run.rend());
    for (WayPlace& p : back) {
      p.way = run.back().way - p.way;
      p.pose.theta = hyselam::normalizeAngle(p.pose.theta + hyselam::kPi);
    }
    const auto there = wayFeaturesOf(run), again = wayFeaturesOf(back);
    ASSERT_EQ(there.size(), size);
    for (std::size_t i = 0; i < size; ++i) expectNear(there[i], again[size - 1 - i]);
  }
}

TEST(WayFeatures, equalTheirPlainTranscription) {
  Rng rng(3);
  const std::vector<WayPlace> run = someRun(rng, 120);
  const auto features = wayFeaturesOf(run);
  const std::size_t at = indexOfFeature("distance_50");
  const auto last = static_cast<int>(run.size()) - 1;
  for (int i = 0; i <= last; ++i) {
    const auto shape = [&](int k) {
      return static_cast<double>(run[static_cast<std::size_t>(std::clamp(k, 0, last))].shape[at]);
    };
    double sum = 0.0;
    int count = 0;
    for (int k = std::max(0, i - 20); k <= std::min(last, i + 20); ++k, ++count) sum += shape(k);
    const std::vector<float>& f = features[static_cast<std::size_t>(i)];
    EXPECT_NEAR(f[indexOfFeature("mean_within_5:_distance_50")], sum / count, 1e-4);
    EXPECT_NEAR(f[indexOfFeature("lower_side:_distance_50")],
                std::min(shape(i - 12), shape(i + 12)), 1e-6);
    EXPECT_NEAR(f[indexOfFeature("higher_side:_distance_50")],
                std::max(shape(i - 12), shape(i + 12)), 1e-6);
  }
  // A straight way, and one that turns back.
  std::vector<WayPlace> way(65);
  for (std::size_t i = 0; i < way.size(); ++i) {
    way[i].way = 0.25 * static_cast<double>(i);
    way[i].pose = {0.25 * (i < 32 ? static_cast<double>(i) : 64.0 - static_cast<double>(i)), 0.0,
                   i < 32 ? 0.0 : hyselam::kPi};
  }
  const auto f = wayFeaturesOf(way);
  EXPECT_NEAR(f[32][indexOfFeature("straight_4")], 0.0, 1e-6);
  EXPECT_NEAR(f[32][indexOfFeature("ahead_4")], -1.0, 1e-6);
  EXPECT_NEAR(f[32][indexOfFeature("turn_1")], hyselam::kPi, 1e-6);
  EXPECT_NEAR(f[10][indexOfFeature("straight_4")], 1.0, 1e-6);
  EXPECT_NEAR(f[10][indexOfFeature("ahead_4")], 1.0, 1e-6);
}

TEST(WayFeatures, refuseStepsThatAreNotEqual) {
  Rng rng(4);
  std::vector<WayPlace> run = someRun(rng, 5);
  run[3].way += 0.1;
  EXPECT_NE(messageOf<hyselam::ParameterError>([&] { wayFeaturesOf(run); }), "");
  run[3].way = run[2].way;
  EXPECT_NE(messageOf<hyselam::ParameterError>([&] { wayFeaturesOf(run); }), "");
  run[3].way = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(messageOf<hyselam::ParameterError>([&] { wayFeaturesOf(run); }), "");
  EXPECT_TRUE(wayFeaturesOf({}).empty());
}

double scoreOf(const std::vector<ClassShares>& shares, const std::vector<SemanticClass>& classes,
               const WayDecisionParams& params) {
  double score = 0.0;
  for (std::size_t i = 0; i < shares.size(); ++i) {
    score += std::log(shares[i][indexOf(classes[i])] + params.doubt);
    if (i > 0 && classes[i] != classes[i - 1]) score -= params.change_cost;
  }
  return score;
}

TEST(WayDecision, isTheBestOfAllSequences) {
  Rng rng(5);
  for (int round = 0; round < 200; ++round) {
    std::vector<ClassShares> shares(1 + rng.below(5));
    for (ClassShares& s : shares) {
      for (double& x : s) x = rng.uniform() < 0.3 ? 0.0 : rng.uniform();
    }
    WayDecisionParams params;
    params.change_cost = rng.below(3) == 0 ? 0.0 : rng.uniform(0.0, 3.0);
    double best = -1e300;
    std::size_t sequences = 1;
    for (std::size_t i = 0; i < shares.size(); ++i) sequences *= kSemanticClasses;
    for (std::size_t number = 0; number < sequences; ++number) {
      std::vector<SemanticClass> classes;
      for (std::size_t i = 0, rest = number; i < shares.size(); ++i, rest /= kSemanticClasses) {
        classes.push_back(kAllSemanticClasses[rest % kSemanticClasses]);
      }
      best = std::max(best, scoreOf(shares, classes, params));
    }
    EXPECT_NEAR(scoreOf(shares, mostLikelyClasses(shares, params), params), best, 1e-9) << round;
  }
  EXPECT_TRUE(mostLikelyClasses({}).empty());
  WayDecisionParams bad;
  bad.change_cost = -1.0;
  EXPECT_NE(messageOf<hyselam::ParameterError>([&] { mostLikelyClasses({}, bad); }), "");
  bad.change_cost = 1.0;
  bad.doubt = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(messageOf<hyselam::ParameterError>([&] { mostLikelyClasses({}, bad); }), "");
}

/// Halls are wide, corridors narrow; the rest is noise.
std::vector<WayExample> examples(int n) {
  Rng rng(6);
  std::vector<WayExample> out;
  const std::size_t across = indexOfFeature("across_shortest");
  for (int i = 0; i < n; ++i) {
    WayExample e;
    for (std::size_t k = 0; k < wayFeatureNames().size(); ++k) {
      e.features.push_back(static_cast<float>(rng.uniform()));
    }
    e.semantic_class = rng.below(2) == 0 ? SemanticClass::kHall : SemanticClass::kCorridor;
    e.features[across] = static_cast<float>(rng.uniform(1.0, 2.0)) *
                         (e.semantic_class == SemanticClass::kHall ? 4 : 1);
    out.push_back(e);
  }
  return out;
}

WayForestParams smallForest() {
  WayForestParams params;
  params.forest.trees = 10;
  params.draws = 400;
  return params;
}

TEST(WayForest, learnsAndIsTheSameAfterLoading) {
  const auto lesson = examples(300);
  const WayForest forest = WayForest::train(lesson, smallForest());
  int right = 0;
  for (const WayExample& e : lesson) {
    right += forest.sharesOf(e.features)[indexOf(e.semantic_class)] > 0.5 ? 1 : 0;
  }
  EXPECT_GE(right, 295);
  TemporaryDirectory dir;
  forest.save(dir / "a");
  WayForest::train(lesson, smallForest()).save(dir / "b");
  EXPECT_EQ(fileBytes(dir / "a"), fileBytes(dir / "b"));
  WayForest::load(dir / "a").save(dir / "c");
  EXPECT_EQ(fileBytes(dir / "a"), fileBytes(dir / "c"));
  WayForestParams other = smallForest();
  other.forest.seed = 2;
  EXPECT_NE(WayForest::train(lesson, other).text(), forest.text());
}

TEST(WayForest, drawsByWeightAndBalance) {
  // All the weight on examples that call wide places corridors.
  auto lesson = examples(300);
  for (WayExample& e : lesson) e.weight = 1e-9;
  auto turned_round = examples(300);
  for (WayExample& e : turned_round) {
    e.semantic_class =
        e.semantic_class == SemanticClass::kHall ? SemanticClass::kCorridor : SemanticClass::kHall;
    lesson.push_back(e);
  }
  const WayForest forest = WayForest::train(lesson, smallForest());
  int right = 0;
  for (const WayExample& e : turned_round) {
    right += forest.sharesOf(e.features)[indexOf(e.semantic_class)] > 0.5 ? 1 : 0;
  }
  EXPECT_GE(right, 290);
}

TEST(WayForest, refusesUnusableExamples) {
  const auto refused = [](const std::vector<WayExample>& lesson) {
    return messageOf<hyselam::ParameterError>([&] { WayForest::train(lesson, smallForest()); }) !=
           "";
  };
  EXPECT_TRUE(refused({}));
  auto lesson = examples(20);
  lesson[7].weight = 0.0;
  EXPECT_TRUE(refused(lesson));
  lesson[7].weight = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(refused(lesson));
  lesson[7].weight = 1.0;
  EXPECT_FALSE(refused(lesson));
  lesson[7].features.pop_back();
  EXPECT_TRUE(refused(lesson));
  WayForestParams params = smallForest();
  params.draws = 0;
  EXPECT_NE(messageOf<hyselam::ParameterError>([&] { WayForest::train(examples(20), params); }),
            "");
  const WayForest forest = WayForest::train(examples(20), smallForest());
  EXPECT_NE(messageOf<hyselam::ParameterError>([&] { forest.sharesOf({1.0F}); }), "");
  WayForest named = WayForest::train(examples(20), smallForest());
  EXPECT_NE(messageOf<hyselam::ParameterError>([&] { named.setOrigin({"a\nb", "", "", ""}); }), "");
}

TEST(WayForest, refusesInvalidFiles) {
  TemporaryDirectory dir;
  WayForest::train(examples(100), smallForest()).save(dir / "good");
  const std::string good = fileBytes(dir / "good");
  const auto refused = [&](const std::string& bytes) {
    writeFile(dir / "bad", bytes);
    return messageOf<hyselam::InputError>([&] {
             WayForest::load(dir / "bad");
           }).find(dir / "bad") == 0;
  };
  EXPECT_FALSE(refused(good));
  EXPECT_TRUE(refused(""));
  for (std::size_t n = 1; n < good.size(); n += good.size() / 60 + 1) {
    EXPECT_TRUE(refused(good.substr(0, n))) << n;
  }
  Rng rng(7);
  for (int i = 0; i < 200; ++i) {
    std::string bytes = good;
    bytes[rng.below(static_cast<std::uint32_t>(bytes.size()))] ^=
        static_cast<char>(1 + rng.below(255));
    EXPECT_TRUE(refused(bytes)) << i;
  }
  // A forest of the other sort, whole as it is.
  SemanticForest::shipped().save(dir / "other");
  EXPECT_TRUE(refused(fileBytes(dir / "other")));
  EXPECT_NE(messageOf<hyselam::InputError>([&] { SemanticForest::load(dir / "good"); }), "");
  EXPECT_NE(messageOf<hyselam::InputError>([&] { WayForest::load(dir / "none"); }), "");
}

TEST(WayForest, theShippedOneSaysWhereItComesFromAndKnowsAWay) {
  const WayForest forest = WayForest::shipped();
  EXPECT_EQ(forest.origin().command.rfind("train_way_regions", 0), 0U);
  EXPECT_NE(forest.origin().data.find("crc32"), std::string::npos);
  // An endless corridor two metres wide, without anything in it.
  PlaceFeatures f;
  for (std::size_t b = 0; b < PlaceFeatures::kBeams; ++b) {
    const double angle = 2.0 * hyselam::kPi * static_cast<double>(b) / PlaceFeatures::kBeams;
    f.distances[b] =
        static_cast<float>(std::min(20.0, 1.0 / std::max(1e-9, std::abs(std::sin(angle)))));
    const std::size_t ring = static_cast<std::size_t>(f.distances[b]);
    if (ring < PlaceFeatures::kRings) {
      f.context[b * PlaceFeatures::kSectors / PlaceFeatures::kBeams][ring] = 1;
    }
  }
  f.densities = {1.0F, 0.78F, 0.5F, 0.31F};  // 2 m of a disc
  std::vector<WayPlace> run;
  for (int i = 0; i < 120; ++i) run.push_back({0.25 * i, {0.25 * i, 0.0, 0.0}, wayShapeOf(f)});
  for (const SemanticPrediction& p : forest.classify(run)) {
    EXPECT_EQ(p.semantic_class, SemanticClass::kCorridor);
    EXPECT_GT(p.confidence, 0.3);
    EXPECT_LE(p.confidence, 1.0);
  }
}

}  // namespace
}  // namespace ngram_slam
