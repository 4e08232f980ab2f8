// Regions with a meaning: equality with the transcription of chapter 6, streams, the score, and
// what is done with input that cannot be used.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <sstream>

#include "hyselam_common/checksum.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/rng.hpp"
#include "hyselam_common/testing/files.hpp"
#include "ngram_slam/semantics/semantic_examples.hpp"
#include "ngram_slam/semantics/semantic_forest.hpp"
#include "ngram_slam/semantics/semantic_regions_io.hpp"
#include "ngram_slam/semantics/semantic_score.hpp"
#include "transcription/semantics.hpp"

using namespace ngram_slam;  // NOLINT: a test, not a header
using hyselam::Rng;
using hyselam::testing::fileBytes;
using hyselam::testing::messageOf;
using hyselam::testing::TemporaryDirectory;
using hyselam::testing::writeFile;

namespace {

/// Levels, ramps and noise; stretches of frontiers; bends. Densities have the precision of floats.
std::vector<DensityObservation> randomRun(Rng& rng, std::size_t length) {
  std::vector<DensityObservation> out;
  double density = rng.uniform(0.2, 0.9), goal = density, slope = 0.01, heading = 0.0, bend = 0.0;
  int frontiers = 2;
  const double noise = rng.below(3) == 0 ? 0.02 : 0.004;
  hyselam::Pose2 at;
  while (out.size() < length) {
    if (rng.below(12) == 0) {
      goal = rng.uniform(0.1, 1.0);
      slope = rng.uniform(0.003, 0.05);
    }
    density += std::clamp(goal - density, -slope, slope);
    if (rng.below(9) == 0) frontiers = static_cast<int>(rng.below(5));
    if (rng.below(15) == 0) bend = rng.below(3) == 0 ? rng.uniform(-0.3, 0.3) : 0.0;
    heading += bend;
    at = at * hyselam::Pose2{0.1, 0.0, hyselam::normalizeAngle(heading - at.theta)};
    DensityObservation o;
    o.stamp = 0.1 * static_cast<double>(out.size());
    o.base_in_odom = at;
    o.soft = static_cast<float>(std::clamp(density + rng.gaussian(0.0, noise), 0.0, 1.0));
    o.frontiers = frontiers;
    out.push_back(o);
  }
  return out;
}

SemanticParams randomParams(Rng& rng) {
  SemanticParams p;
  p.cut.smoothing = static_cast<int>(rng.below(6));
  p.cut.change_threshold = rng.uniform(0.015, 0.08);
  p.cut.steady_tolerance = p.cut.change_threshold * rng.uniform(0.2, 1.0);
  p.cut.steady_length = 2 + static_cast<int>(rng.below(15));
  p.cut.border_share = rng.uniform(0.2, 0.8);
  p.min_gap = static_cast<int>(rng.below(12));
  p.max_bend = p.min_gap + static_cast<int>(rng.below(30));
  p.min_frontier_run = static_cast<int>(rng.below(8));
  p.max_rim = static_cast<int>(rng.below(15));
  return p;
}

std::vector<SemanticRegion> streamed(SemanticSegmenter& segmenter,
                                     const std::vector<DensityObservation>& run) {
  std::vector<SemanticRegion> out;
  const auto keep = [&](const std::vector<SemanticRegion>& more) {
    out.insert(out.end(), more.begin(), more.end());
  };
  for (const DensityObservation& o : run) keep(segmenter.add(o));
  keep(segmenter.finish());
  return out;
}

transcription::Run plain(const std::vector<DensityObservation>& run) {
  transcription::Run out;
  for (const DensityObservation& o : run) {
    out.soft.push_back(o.soft);
    out.frontiers.push_back(o.frontiers);
    const double theta = o.base_in_odom.theta;
    out.heading.push_back(
        out.heading.empty()
            ? theta
            : out.heading.back() +
                  hyselam::normalizeAngle(theta - run[out.heading.size() - 1].base_in_odom.theta));
  }
  return out;
}

}  // namespace

TEST(SemanticCutter, equalsItsTranscriptionOnTenThousandStreams) {
  for (std::uint64_t round = 0; round < 10000; ++round) {
    SCOPED_TRACE(round);
    Rng rng(round, 1);
    const SemanticCutParams params = randomParams(rng).cut;
    const auto run = randomRun(rng, 1 + rng.below(160));
    std::vector<double> densities;
    SemanticCutter cutter(params);
    std::vector<SemanticCut> cuts;
    for (const DensityObservation& o : run) {
      densities.push_back(o.soft);
      for (const SemanticCut& c : cutter.add(o.soft)) cuts.push_back(c);
      if (!cuts.empty()) {
        ASSERT_LE(cuts.back().last + cutter.minLength(), densities.size());
      }
    }
    for (const SemanticCut& c : cutter.finish()) cuts.push_back(c);
    const auto expected = transcription::cuts(densities, params);
    ASSERT_EQ(cuts.size(), expected.size());
    for (std::size_t k = 0; k < cuts.size(); ++k) {
      ASSERT_EQ(cuts[k].first, expected[k].first);
      ASSERT_EQ(cuts[k].last, expected[k].last);
      ASSERT_DOUBLE_EQ(cuts[k].level, expected[k].level);
      ASSERT_EQ(cuts[k].steady, expected[k].steady);
      ASSERT_EQ(cuts[k].before.has_value(), expected[k].has_before);
      ASSERT_EQ(cuts[k].after.has_value(), expected[k].has_after);
      ASSERT_DOUBLE_EQ(cuts[k].before.value_or(0.0), expected[k].before);
      ASSERT_DOUBLE_EQ(cuts[k].after.value_or(0.0), expected[k].after);
    }
  }
}

TEST(SemanticSegmenter, equalsItsTranscriptionOnTenThousandStreams) {
  std::array<std::size_t, kSemanticClasses> seen{};
  std::size_t regions = 0;
  for (std::uint64_t round = 0; round < 10000; ++round) {
    SCOPED_TRACE(round);
    Rng rng(round, 2);
    const SemanticParams params = randomParams(rng);
    const DecisionTreeParams tree;
    SemanticSegmenter segmenter(params);
    std::uint32_t begin = 0;
    for (int r = 0; r < 2; ++r) {  // the second run of the same segmenter starts anew
      const auto run = randomRun(rng, 1 + rng.below(120));
      const auto expected = transcription::regions(plain(run), params);
      const auto got = streamed(segmenter, run);
      ASSERT_EQ(got.size(), expected.size());
      std::uint32_t next = begin;
      for (std::size_t k = 0; k < got.size(); ++k) {
        ASSERT_EQ(got[k].first, begin + expected[k].first);
        ASSERT_EQ(got[k].last, begin + expected[k].last);
        ASSERT_EQ(got[k].first, next);
        next = got[k].last + 1;
        ASSERT_DOUBLE_EQ(got[k].features.level, expected[k].level);
        ASSERT_EQ(got[k].features.steady, expected[k].steady ? 1.0 : 0.0);
        ASSERT_EQ(got[k].semantic_class, transcription::tree(got[k].features, tree));
        ASSERT_GT(got[k].confidence, 0.49);
        ASSERT_LE(got[k].confidence, 1.0);
        ++seen[indexOf(got[k].semantic_class)];
        ++regions;
      }
      ASSERT_EQ(next, begin + run.size());
      begin = next;
    }
  }
  for (SemanticClass c : kAllSemanticClasses) {
    EXPECT_GT(seen[indexOf(c)], regions / 2000) << toString(c);
  }
}

TEST(DecisionTree, equalsItsTranscriptionOnTenThousandRegions) {
  Rng rng(5);
  for (int round = 0; round < 10000; ++round) {
    SemanticFeatures f;
    f.length = 1.0 + rng.below(120);
    f.variation = rng.uniform(0.0, 0.3);
    f.density_max = rng.uniform();
    f.frontiers = rng.uniform(0.5, 3.5);
    f.turn = rng.uniform(0.0, 3.5);
    DecisionTreeParams p;
    p.high_variation = rng.uniform(0.05, 0.2);
    p.many_frontiers = rng.uniform(1.8, 2.8);
    p.straight = rng.uniform(0.3, 1.5);
    ASSERT_EQ(DecisionTree(p).classify(f).semantic_class, transcription::tree(f, p));
  }
}

TEST(DecisionTree, followsTable64) {
  const DecisionTree tree;
  SemanticFeatures f;
  const auto classOf = [&] { return tree.classify(f).semantic_class; };
  f.length = 30;
  f.variation = 0.05;
  EXPECT_EQ(classOf(), SemanticClass::kCorridor);  // low variation, straight
  f.variation = 0.2;
  f.frontiers = 2.6;
  EXPECT_EQ(classOf(), SemanticClass::kBifurcation);
  f.frontiers = 2.0;
  f.turn = hyselam::radians(90);
  EXPECT_EQ(classOf(), SemanticClass::kCorner);
  f.turn = hyselam::radians(170);
  EXPECT_EQ(classOf(), SemanticClass::kDeadEnd);
  f.turn = hyselam::radians(10);
  EXPECT_EQ(classOf(), SemanticClass::kCorridor);
  f.frontiers = 1.2;
  f.density_max = 0.95;
  EXPECT_EQ(classOf(), SemanticClass::kHall);
  f.density_max = 0.7;
  EXPECT_EQ(classOf(), SemanticClass::kCorridor);
  f.frontiers = 2.6;
  f.length = 101;
  EXPECT_EQ(classOf(), SemanticClass::kCorridor);  // very long
}

TEST(SemanticSegmenter, returnsARegionBeforeTheNextOneEnds) {
  // A corridor, a bifurcation, a corridor that goes on and on.
  SemanticSegmenter segmenter;
  std::vector<SemanticRegion> told;
  for (int i = 0; i < 180; ++i) {
    DensityObservation o;
    o.base_in_odom.x = 0.1 * i;
    const double away = std::abs(i - 80);
    o.soft = 0.5 + 0.3 * std::max(0.0, 1.0 - away / 20.0);
    o.frontiers = away < 12 ? 3 : 2;
    for (const SemanticRegion& r : segmenter.add(o)) told.push_back(r);
  }
  ASSERT_EQ(told.size(), 2u);
  EXPECT_EQ(told[0].semantic_class, SemanticClass::kCorridor);
  EXPECT_EQ(told[1].semantic_class, SemanticClass::kBifurcation);
  EXPECT_NEAR(told[1].first, 72, 2);  // 0.6 of the way up
  EXPECT_NEAR(told[1].last, 88, 2);
}

TEST(SemanticSegmenter, refusesInvalidObservationsAndContinues) {
  Rng rng(3);
  const auto run = randomRun(rng, 300);
  SemanticSegmenter clean, disturbed;
  const auto expected = streamed(clean, run);
  std::vector<SemanticRegion> got;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const DensityObservation& o : run) {
    for (int kind = 0; kind < 5; ++kind) {
      DensityObservation bad = o;
      if (kind == 0) bad.soft = nan;
      if (kind == 1) bad.soft = 1.5;
      if (kind == 2) bad.frontiers = -1;
      if (kind == 3) bad.base_in_odom.theta = nan;
      if (kind == 4) bad.base_in_odom.x = std::numeric_limits<double>::infinity();
      EXPECT_NE(messageOf<hyselam::InputError>([&] { disturbed.add(bad); }), "");
    }
    for (const SemanticRegion& r : disturbed.add(o)) got.push_back(r);
  }
  for (const SemanticRegion& r : disturbed.finish()) got.push_back(r);
  ASSERT_EQ(got.size(), expected.size());
  for (std::size_t k = 0; k < got.size(); ++k) EXPECT_EQ(got[k].last, expected[k].last);
  EXPECT_TRUE(disturbed.finish().empty());  // an empty run
}

TEST(SemanticSegmenter, refusesParametersOutOfRange) {
  const auto refused = [](auto change) {
    SemanticParams p;
    change(p);
    return !messageOf<hyselam::ParameterError>([&] { SemanticSegmenter s(p); }).empty();
  };
  EXPECT_TRUE(refused([](SemanticParams& p) { p.cut.smoothing = -1; }));
  EXPECT_TRUE(refused([](SemanticParams& p) { p.cut.change_threshold = 0.0; }));
  EXPECT_TRUE(
      refused([](SemanticParams& p) { p.cut.steady_tolerance = 2 * p.cut.change_threshold; }));
  EXPECT_TRUE(refused([](SemanticParams& p) { p.cut.steady_length = 1; }));
  EXPECT_TRUE(refused([](SemanticParams& p) { p.cut.border_share = 1.0; }));
  EXPECT_TRUE(refused([](SemanticParams& p) { p.min_gap = -1; }));
  EXPECT_TRUE(refused([](SemanticParams& p) { p.max_bend = p.min_gap - 1; }));
  EXPECT_TRUE(refused([](SemanticParams& p) { p.min_turn = std::nan(""); }));
  EXPECT_TRUE(refused([](SemanticParams& p) { p.bend_angle = 0.0; }));
  EXPECT_TRUE(refused([](SemanticParams& p) { p.min_frontier_run = -1; }));
  EXPECT_TRUE(refused([](SemanticParams& p) { p.max_rim = -1; }));
  EXPECT_FALSE(refused([](SemanticParams&) {}));
  DecisionTreeParams t;
  t.small_turn = 2 * t.huge_turn;
  EXPECT_NE(messageOf<hyselam::ParameterError>([&] { DecisionTree tree(t); }), "");
}

TEST(SemanticScore, bordersWithinToleranceAreForgiven) {
  constexpr auto kWay = SemanticClass::kCorridor, kMeet = SemanticClass::kBifurcation,
                 kBend = SemanticClass::kCorner;
  std::vector<std::optional<SemanticClass>> truth(100, kWay);
  std::fill(truth.begin() + 40, truth.begin() + 60, kMeet);
  std::vector<SemanticClass> predicted(100, kWay);
  std::fill(predicted.begin() + 35, predicted.begin() + 75, kMeet);
  // 5 too early are forgiven, of 15 too late 10.
  SemanticConfusion c = compareClasses(truth, predicted, 10);
  EXPECT_EQ(c.counts[indexOf(kWay)][indexOf(kMeet)], 5u);
  EXPECT_EQ(c.counts[indexOf(kMeet)][indexOf(kMeet)], 20u);
  EXPECT_EQ(c.total(), 100u);
  EXPECT_DOUBLE_EQ(*c.precision(kMeet), 20.0 / 25.0);
  EXPECT_DOUBLE_EQ(*c.recall(kWay), 75.0 / 80.0);
  EXPECT_DOUBLE_EQ(c.averagePrecision(), 0.5 * (20.0 / 25.0 + 1.0));
  EXPECT_FALSE(c.precision(kBend));
  EXPECT_FALSE(c.recall(kBend));

  // A place that nobody found is no shifted border; the rule of the thesis does not see it.
  std::fill(predicted.begin(), predicted.end(), kWay);
  EXPECT_EQ(compareClasses(truth, predicted, 10).counts[indexOf(kMeet)][indexOf(kMeet)], 20u);
  c = compareClasses(truth, predicted, 10, BorderRule::kStrict);
  EXPECT_EQ(c.counts[indexOf(kMeet)][indexOf(kWay)], 20u);
  EXPECT_DOUBLE_EQ(c.averageRecall(), 0.5);

  // What is neither here nor near stays wrong; without truth nothing is counted.
  std::fill(predicted.begin() + 40, predicted.begin() + 60, kBend);
  EXPECT_EQ(compareClasses(truth, predicted, 10).counts[indexOf(kMeet)][indexOf(kBend)], 20u);
  std::fill(truth.begin(), truth.begin() + 40, std::nullopt);
  EXPECT_EQ(compareClasses(truth, predicted, 10).total(), 60u);
  EXPECT_EQ(compareClasses({}, {}, 10).averageRecall(), 0.0);
  predicted.pop_back();
  EXPECT_NE(messageOf<hyselam::ParameterError>([&] { compareClasses(truth, predicted, 10); }), "");
}

namespace {

/// Corridors are long, bifurcations have many frontiers, the others turn.
std::vector<SemanticExample> examples(int n) {
  Rng rng(9);
  std::vector<SemanticExample> out;
  for (int i = 0; i < n; ++i) {
    SemanticExample e;
    e.semantic_class = kAllSemanticClasses[rng.below(4)];
    const auto is = [&](SemanticClass c) { return e.semantic_class == c; };
    e.features.length = rng.uniform(20, 40) + (is(SemanticClass::kCorridor) ? 60 : 0);
    e.features.frontiers = rng.uniform(1.9, 2.2) + (is(SemanticClass::kBifurcation) ? 0.8 : 0.0);
    e.features.turn = is(SemanticClass::kCorner)    ? rng.uniform(1.2, 1.8)
                      : is(SemanticClass::kDeadEnd) ? rng.uniform(2.8, 3.2)
                                                    : rng.uniform(0.0, 0.5);
    out.push_back(e);
  }
  return out;
}

}  // namespace

TEST(SemanticForest, trainsAndIsTheSameAfterLoading) {
  const auto lesson = examples(400);
  const SemanticForest forest = SemanticForest::train(lesson);
  int right = 0;
  for (const SemanticExample& e : lesson) {
    const SemanticPrediction v = forest.classify(e.features);
    right += v.semantic_class == e.semantic_class;
    EXPECT_GT(v.confidence, 0.2);
    EXPECT_LE(v.confidence, 1.0);
  }
  EXPECT_GE(right, 390);
  TemporaryDirectory dir;
  forest.save(dir / "a");
  SemanticForest::train(lesson).save(dir / "b");
  EXPECT_EQ(fileBytes(dir / "a"), fileBytes(dir / "b"));
  SemanticForest::load(dir / "a").save(dir / "c");
  EXPECT_EQ(fileBytes(dir / "a"), fileBytes(dir / "c"));
  const SemanticForest loaded = SemanticForest::load(dir / "a");
  for (const SemanticExample& e : lesson) {
    EXPECT_EQ(loaded.classify(e.features).semantic_class,
              forest.classify(e.features).semantic_class);
    EXPECT_EQ(loaded.classify(e.features).confidence, forest.classify(e.features).confidence);
  }
  EXPECT_NE(messageOf<hyselam::ParameterError>([] { SemanticForest::train({}); }), "");
  EXPECT_NE(messageOf<hyselam::InputError>([&] { forest.save(dir / "none/a"); }), "");
}

TEST(SemanticForest, refusesInvalidFiles) {
  TemporaryDirectory dir;
  SemanticForest::train(examples(100)).save(dir / "good");
  const std::string good = fileBytes(dir / "good");
  const auto refused = [&](const std::string& bytes) {
    writeFile(dir / "bad", bytes);
    const auto message = messageOf<hyselam::InputError>([&] { SemanticForest::load(dir / "bad"); });
    return message.find(dir / "bad") == 0;
  };
  EXPECT_TRUE(refused(""));
  EXPECT_TRUE(refused("%YAML:1.0\n---\nmap: 1\n"));
  for (std::size_t n = 1; n < good.size(); n += good.size() / 60 + 1) {
    EXPECT_TRUE(refused(good.substr(0, n))) << n;
  }
  Rng rng(4);
  for (int i = 0; i < 300; ++i) {
    std::string bytes = good;
    bytes[rng.below(static_cast<std::uint32_t>(bytes.size()))] ^=
        static_cast<char>(1 + rng.below(255));
    EXPECT_TRUE(refused(bytes)) << i;
  }
  // A right checksum over something else.
  const auto sealed = [](const std::string& text) {
    return text + "crc32 " + hyselam::crc32Text(text) + "\n";
  };
  const std::string unsealed = good.substr(0, good.rfind("crc32 "));
  EXPECT_FALSE(refused(sealed(unsealed)));
  EXPECT_TRUE(refused(sealed("ngram_slam semantic forest 3\n")));
  for (const auto& [from, to] :
       std::vector<std::pair<std::string, std::string>>{{"forest 3", "forest 2"},
                                                        {"\ncommand: ", "\ncommands: "},
                                                        {"\nin sample: ", "\n"},
                                                        {" turn", ""},
                                                        {" turn", " turns"},
                                                        {"level rise_before", "rise_before level"},
                                                        {"features:", "features: height"}}) {
    std::string other = unsealed;
    other.replace(other.find(from), from.size(), to);
    EXPECT_TRUE(refused(sealed(other))) << to;
  }
  EXPECT_NE(messageOf<hyselam::InputError>([&] { SemanticForest::load(dir / "none"); }), "");
  EXPECT_NE(messageOf<hyselam::InputError>([&] { SemanticForest::load(dir.path()); }), "");
}

TEST(SemanticForest, refusesIncompleteTrees) {
  TemporaryDirectory dir;
  SemanticForest::train(examples(100)).save(dir / "good");
  const std::string good = fileBytes(dir / "good");
  const std::size_t trees = good.find("tree\n");
  // A right checksum over `to` in place of the first `from`.
  const auto messageWith = [&](const std::string& from, const std::string& to) {
    std::string text = good.substr(0, good.rfind("crc32 "));
    const std::size_t at = text.find(from, trees);
    if (at == std::string::npos) return "no " + from;
    text.replace(at, from.size(), to);
    writeFile(dir / "bad", text + "crc32 " + hyselam::crc32Text(text) + "\n");
    return messageOf<hyselam::InputError>([&] { SemanticForest::load(dir / "bad"); });
  };
  EXPECT_EQ(messageWith("", ""), "");
  const std::size_t root = trees + std::string("tree\n").size();
  const std::string first = good.substr(root, good.find('\n', root) + 1 - root);
  const std::string all_trees = good.substr(trees, good.rfind("crc32 ") - trees);
  for (const auto& [from, to] :
       std::vector<std::pair<std::string, std::string>>{{first, "height 0.5\n"},
                                                        {first, "1 0.5\n"},
                                                        {first, "Level 0.5\n"},
                                                        {first, "level nan\n"},
                                                        {first, "level 1e99\n"},
                                                        {first, "level 2 3\n"},
                                                        {first, "\n"},
                                                        {"tree\n", ""},
                                                        {"tree\n", "tree\ntree\n"},
                                                        {first, first + first},
                                                        {first, first + "corridor\n"},
                                                        {"corridor\n", "corridors\n"},
                                                        {all_trees, ""},
                                                        {all_trees, first}}) {
    EXPECT_EQ(messageWith(from, to).find(dir / "bad"), 0u) << to;
  }
}

// The data beside it are regions of one simulated building.
TEST(SemanticForest, trainingAnewGivesTheStoredBytes) {
  const std::string data = std::string(HYSELAM_PACKAGE_DIR) + "/test/data/semantic_forest/";
  const std::vector<SemanticExample> lesson = readExamples(data + "examples.csv");
  EXPECT_EQ(textOf(lesson), fileBytes(data + "examples.csv"));
  const SemanticForest stored = SemanticForest::load(data + "five_trees.txt");
  ForestParams params;
  params.trees = 5;
  SemanticForest forest = SemanticForest::train(lesson, params);
  forest.setOrigin(stored.origin());
  EXPECT_EQ(forest.text(), fileBytes(data + "five_trees.txt"));
  EXPECT_NE(stored.origin().data.find(hyselam::crc32Text(textOf(lesson))), std::string::npos);
  EXPECT_NE(messageOf<hyselam::ParameterError>([&] {
              forest.setOrigin({"two\nlines", "", "", ""});
            }),
            "");
}

TEST(SemanticForest, theShippedOneSaysWhereItComesFrom) {
  const SemanticForest shipped = SemanticForest::shipped();
  EXPECT_EQ(shipped.text(),
            fileBytes(std::string(HYSELAM_PACKAGE_DIR) + "/models/semantic_forest.txt"));
  EXPECT_EQ(shipped.origin().command, "train_semantic");
  EXPECT_NE(shipped.origin().data.find("crc32"), std::string::npos);
  EXPECT_NE(shipped.origin().in_sample.find("regions right"), std::string::npos);
  EXPECT_NE(shipped.origin().out_of_sample.find("other simulated buildings"), std::string::npos);
}

TEST(SemanticExamples, refusesTablesOfOtherFeatures) {
  TemporaryDirectory dir;
  const std::string good = textOf(examples(3));
  const auto messageWith = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    writeFile(dir / "t.csv", text);
    return messageOf<hyselam::InputError>([&] { readExamples(dir / "t.csv"); });
  };
  EXPECT_EQ(messageWith("", ""), "");
  EXPECT_NE(messageWith("turn,", "").find("line 1"), std::string::npos);
  EXPECT_NE(messageWith("level,rise_before", "rise_before,level").find("line 1"),
            std::string::npos);
  EXPECT_NE(messageWith("class\n", "class\nx,").find("line 2"), std::string::npos);
  EXPECT_NE(messageWith("class\n", "class\n1,2\n").find("line 2"), std::string::npos);
  const std::string last = good.substr(good.rfind(','));
  EXPECT_NE(messageWith(last, ",bridge\n").find("bridge"), std::string::npos);
  EXPECT_NE(messageOf<hyselam::InputError>([&] { readExamples(dir / "none"); }), "");
}

TEST(SemanticRegions, areWrittenAsATable) {
  TemporaryDirectory dir;
  SemanticRegion a, b;
  a.last = 1;
  b.first = b.last = 2;
  b.semantic_class = SemanticClass::kDeadEnd;
  b.confidence = 0.75;
  writeRegions(dir / "regions.csv", {a, b}, {10.5, 11.0, 11.25});
  EXPECT_EQ(fileBytes(dir / "regions.csv"),
            "first,last,stamp_begin,stamp_end,class,confidence\n"
            "0,1,10.5,11,corridor,1\n2,2,11.25,11.25,dead-end,0.75\n");
  EXPECT_NE(messageOf<hyselam::ParameterError>([&] { writeRegions(dir / "x", {b}, {1.0}); }), "");
  EXPECT_NE(messageOf<hyselam::InputError>([&] { writeRegions(dir / "none/x", {}, {}); }), "");
  EXPECT_EQ(dir.fileCount(), 1u);
}
