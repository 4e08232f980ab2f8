// What is true and how much of it is recognised: against hand-made cases and against looking at
// every pair; the evaluator's tables against single runs.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/rng.hpp"
#include "hyselam_common/ros/bag_io.hpp"
#include "hyselam_common/testing/files.hpp"
#include "hyselam_sim/data.hpp"
#include "hyselam_sim/simulation.hpp"
#include "ngram_slam/matching/match_evaluation.hpp"
#include "tool_test.hpp"

using namespace ngram_slam;  // NOLINT: a test, not a header
using hyselam::Pose2;
using hyselam::testing::fileBytes;
using hyselam::testing::messageOf;

namespace {

using Poses = std::vector<std::optional<Pose2>>;

RecognitionScore scoreOf(const Poses& poses, const std::vector<std::uint32_t>& runs,
                         const ScoreParams& params) {
  return RecognitionScore(std::make_shared<const RecognitionTruth>(poses, runs, params));
}

/// Along a corridor of 10 m: there, back, there again, one observation for every metre.
Poses toAndFro() {
  Poses poses;
  for (int i = 0; i < 10; ++i) poses.push_back(Pose2{1.0 * i, 0.0, 0.0});
  for (int i = 9; i >= 0; --i) poses.push_back(Pose2{1.0 * i, 0.3, hyselam::kPi});
  for (int i = 0; i < 10; ++i) poses.push_back(Pose2{1.0 * i, -0.3, 0.0});
  return poses;
}

ScoreParams narrow() {
  ScoreParams params;
  params.distance = 0.7;
  params.separation = 5;
  return params;
}

}  // namespace

TEST(RecognitionTruth, findsThePassesOfACorridorInBothDirections) {
  const RecognitionTruth truth(toAndFro(), std::vector<std::uint32_t>(30, 0), narrow());
  // Where the robot turns the last five observations do not count: 10..12 repeat 9..7.
  for (std::uint32_t i = 0; i < 30; ++i) {
    EXPECT_EQ(truth.revisit(i), i >= 20) << i;
    EXPECT_EQ(truth.revisitAnyDirection(i), i >= 12) << i;
  }
  EXPECT_EQ(truth.isTrue(25, 5, Direction::kSame), true);
  EXPECT_EQ(truth.isTrue(5, 25, Direction::kSame), true);  // in whichever order
  EXPECT_EQ(truth.isTrue(25, 5, Direction::kReverse), false);
  EXPECT_EQ(truth.isTrue(25, 14, Direction::kReverse), true);
  EXPECT_EQ(truth.isTrue(25, 14, Direction::kSame), false);
  EXPECT_EQ(truth.isTrue(25, 6, Direction::kSame), false);  // 1 m off
  EXPECT_EQ(truth.isTrue(25, 21, Direction::kSame), std::nullopt);
  // Observation 25 was there twice: once this way, once the other.
  ASSERT_EQ(truth.passesEnd(25) - truth.passesBegin(25), 2u);
  const auto& same = truth.passes()[truth.passesBegin(25)];
  const auto& reverse = truth.passes()[truth.passesBegin(25) + 1];
  EXPECT_EQ(same.direction, Direction::kSame);
  EXPECT_EQ(same.first, 5u);
  EXPECT_EQ(same.last, 5u);
  EXPECT_EQ(reverse.direction, Direction::kReverse);
  EXPECT_EQ(reverse.first, 14u);
}

TEST(RecognitionScore, countsHandMadePairs) {
  RecognitionScore score = scoreOf(toAndFro(), std::vector<std::uint32_t>(30, 0), narrow());
  EXPECT_EQ(score.figures().precision(), 1.0);
  EXPECT_EQ(score.figures().recall(), 0.0);
  EXPECT_EQ(score.add(20, 0), true);
  EXPECT_EQ(score.add(21, 1), true);
  EXPECT_EQ(score.add(1, 21), true);  // the same again
  EXPECT_EQ(score.add(22, 4), false);
  EXPECT_EQ(score.add(23, 16, Direction::kReverse), true);
  EXPECT_EQ(score.add(24, 4, Direction::kReverse), false);  // true only as same way
  EXPECT_EQ(score.add(24, 22), std::nullopt);
  const RecognitionFigures f = score.figures();
  EXPECT_EQ(f.pairs, 5u);
  EXPECT_DOUBLE_EQ(f.precision(), 3.0 / 5.0);
  EXPECT_DOUBLE_EQ(f.recall(), 2.0 / 10.0);              // 20, 21 of 20..29
  EXPECT_DOUBLE_EQ(f.recallAnyDirection(), 3.0 / 18.0);  // 20, 21, 23 of 12..29
  EXPECT_DOUBLE_EQ(f.passRecall(), 2.0 / 10.0);
  EXPECT_DOUBLE_EQ(f.passRecallAnyDirection(), 3.0 / 26.0);  // 22..29 were there twice
  const RecognitionFigures early = score.figures(22);
  EXPECT_EQ(early.pairs, 2u);
  EXPECT_DOUBLE_EQ(early.precision(), 1.0);
  EXPECT_DOUBLE_EQ(early.recall(), 1.0);
}

// A pass ends with the run, even where the next one begins at the same spot.
TEST(RecognitionTruth, passesDoNotReachAcrossRuns) {
  Poses poses(12, Pose2{});
  const RecognitionTruth truth(poses, {0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2}, narrow());
  ASSERT_EQ(truth.passesEnd(11) - truth.passesBegin(11), 2u);
  EXPECT_EQ(truth.passes()[truth.passesBegin(11)].last, 3u);
  EXPECT_EQ(truth.passes()[truth.passesBegin(11) + 1].first, 4u);
  EXPECT_EQ(truth.passes()[truth.passesBegin(11) + 1].last, 7u);
}

TEST(RecognitionTruth, refusesInvalidParametersAndLists) {
  ScoreParams params;
  params.distance = 0.0;
  EXPECT_NE(messageOf<hyselam::ParameterError>([&] { RecognitionTruth({}, {}, params); }), "");
  params = {};
  params.heading = 2.0;  // same and opposite would be one
  EXPECT_NE(messageOf<hyselam::ParameterError>([&] { RecognitionTruth({}, {}, params); }), "");
  EXPECT_THROW(RecognitionTruth({Pose2{}}, {}), hyselam::ParameterError);
}

TEST(RecognitionScore, equalsTheCountOverAllPairs) {
  for (int round = 0; round < 50; ++round) {
    SCOPED_TRACE(round);
    hyselam::Rng rng(77, static_cast<std::uint64_t>(round));
    Poses poses;
    std::vector<std::uint32_t> runs;
    Pose2 at;
    const std::uint32_t n = 150;
    for (std::uint32_t i = 0; i < n; ++i) {
      at = at * Pose2{0.5, 0.0, rng.uniform(-0.4, 0.6)};
      poses.push_back(rng.below(10) == 0 ? std::nullopt : std::optional<Pose2>(at));
      runs.push_back(i / 60);
    }
    ScoreParams params;
    params.distance = 1.0;
    params.separation = 20;
    RecognitionScore score = scoreOf(poses, runs, params);
    const auto counts = [&](std::uint32_t a, std::uint32_t b) {
      return poses[a] && poses[b] && (runs[a] != runs[b] || a - b >= 20);
    };
    const auto isNear = [&](std::uint32_t a, std::uint32_t b) {
      return std::hypot(poses[a]->x - poses[b]->x, poses[a]->y - poses[b]->y) <= 1.0;
    };
    const auto isTrue = [&](std::uint32_t a, std::uint32_t b, Direction direction) {
      const double turn = std::abs(hyselam::normalizeAngle(poses[a]->theta - poses[b]->theta));
      return isNear(a, b) && (direction == Direction::kSame ? turn <= hyselam::radians(45)
                                                            : turn >= hyselam::radians(135));
    };
    // Every older observation of a true pair, by pass: a gap of 20 or another run parts two.
    using Visit = std::tuple<std::uint32_t, Direction, int>;
    std::map<std::tuple<std::uint32_t, std::uint32_t, Direction>, int> pass_of;
    std::set<Visit> visits, found;
    std::set<std::uint32_t> any, found_any, found_same;
    for (std::uint32_t a = 0; a < n; ++a) {
      for (const Direction direction : {Direction::kSame, Direction::kReverse}) {
        int pass = 0;
        std::optional<std::uint32_t> last;
        for (std::uint32_t b = 0; b < a; ++b) {
          if (!counts(a, b)) continue;
          if (isNear(a, b)) any.insert(a);
          if (!isTrue(a, b, direction)) continue;
          if (last && (b - *last >= 20 || runs[b] != runs[*last])) ++pass;
          last = b;
          visits.insert({a, direction, pass});
          pass_of[{a, b, direction}] = pass;
        }
      }
    }
    std::set<std::tuple<std::uint32_t, std::uint32_t, Direction>> added;
    std::size_t right = 0;
    for (int k = 0; k < 4000; ++k) {
      const std::uint32_t a = rng.below(n), b = rng.below(n);
      const std::uint32_t newer = std::max(a, b), older = std::min(a, b);
      const Direction direction = rng.below(2) == 0 ? Direction::kSame : Direction::kReverse;
      const auto verdict = score.add(a, b, direction);
      ASSERT_EQ(verdict.has_value(), counts(newer, older));
      if (!verdict) continue;
      ASSERT_EQ(*verdict, isTrue(newer, older, direction));
      if (!added.insert({newer, older, direction}).second || !*verdict) continue;
      ++right;
      found_any.insert(newer);
      if (direction == Direction::kSame) found_same.insert(newer);
      found.insert({newer, direction, pass_of.at({newer, older, direction})});
    }
    const auto same = [](const std::set<Visit>& list) {
      return static_cast<std::size_t>(std::count_if(list.begin(), list.end(), [](const Visit& v) {
        return std::get<1>(v) == Direction::kSame;
      }));
    };
    std::set<std::uint32_t> revisits;
    for (const Visit& v : visits) {
      if (std::get<1>(v) == Direction::kSame) revisits.insert(std::get<0>(v));
    }
    const RecognitionFigures f = score.figures();
    ASSERT_EQ(f.pairs, added.size());
    ASSERT_EQ(f.true_pairs, right);
    ASSERT_EQ(f.revisits, revisits.size());
    ASSERT_EQ(f.recognized, found_same.size());
    ASSERT_EQ(f.revisits_any, any.size());
    ASSERT_EQ(f.recognized_any, found_any.size());
    ASSERT_EQ(f.passes_any, visits.size());
    ASSERT_EQ(f.recognized_passes_any, found.size());
    ASSERT_EQ(f.passes, same(visits));
    ASSERT_EQ(f.recognized_passes, same(found));
    std::size_t told = 0;
    score.forEachPair([&](std::uint32_t newer, std::uint32_t older, Direction direction) {
      told += added.count({newer, older, direction});
    });
    ASSERT_EQ(told, added.size());
  }
}

/// A run through the university: a loop of 60 m two and a half times, with doors open.
class Evaluator : public ToolTest {
 protected:
  static void SetUpTestSuite() {
    ToolTest::SetUpTestSuite();
    const hyselam_sim::FloorPlan plan =
        hyselam_sim::loadFloorPlan(hyselam_sim::planFile("university"));
    const auto route = hyselam_sim::parseRoute(
        "route: test\nstart: D\ndoors: E_R\ndirect: true\nsteps: [E, A, D, E, A, D, E]\n", "test");
    hyselam::writeBag(*directory / "1.bag", hyselam_sim::simulate(plan, route, 1).log);
  }
  int run(const std::string& options) {
    return ToolTest::run("evaluate_recognition " + d / "1.bag" + " --bandwidth 4 " + options);
  }
  nlohmann::json json(const std::string& options) {
    EXPECT_EQ(run(options + " --json " + d / "j.json"), 0) << errors;
    return nlohmann::json::parse(fileBytes(d / "j.json"));
  }
};

TEST_F(Evaluator, tableHasTheFiguresOfSingleRuns) {
  const auto table = json("--levels 2 --min-n 4,6 --n 2..3,5 --size-tolerances 0.2,0.3 --table " +
                          d / "t.csv")["sweep"];
  ASSERT_EQ(table.size(), 6u);
  const std::string csv = fileBytes(d / "t.csv");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 7);
  EXPECT_EQ(csv.rfind("n,size_tolerance,matches,", 0), 0u);
  std::set<int> matches;
  for (const auto& row : table) {
    SCOPED_TRACE(row.dump());
    const int n = row["n"];
    std::ostringstream options;
    options << "--levels 2 --min-n " << n << ',' << n + 2 << " --size-tolerance "
            << row["size_tolerance"];
    const auto single = json(options.str());
    for (const char* figure :
         {"matches", "match_precision", "pairs", "precision", "recall", "pass_recall",
          "recall_any_direction", "pass_recall_any_direction"}) {
      EXPECT_EQ(row[figure], single[figure]) << figure;
    }
    EXPECT_EQ(row["over_time"].back()[0], single["precision"]);
    EXPECT_EQ(row["over_time"].back()[1], single["recall"]);
    matches.insert(row["matches"].get<int>());
  }
  EXPECT_GT(matches.size(), 3u);  // the thresholds matter
}

// A curve over the number of words passes through the single runs of one level.
TEST_F(Evaluator, curveGoesThroughSingleRuns) {
  const auto curve = json("--levels 1 --min-n 2 --curve " + d / "c.csv")["curve"];
  ASSERT_GT(curve.size(), 4u);
  for (const auto& point : {curve[1], curve[curve.size() / 2], curve.back()}) {
    const auto single =
        json("--levels 1 --min-n " + std::to_string(static_cast<int>(point["threshold"])));
    for (const char* figure : {"matches", "precision", "recall", "pass_recall"}) {
      EXPECT_EQ(point[figure], single[figure]) << figure << ' ' << point["threshold"];
    }
  }
}

TEST_F(Evaluator, writesASimilarityMatrix) {
  ASSERT_EQ(run("--levels 1 --min-n 4 --similarity " + d / "s.json"), 0) << errors;
  const auto matrix = nlohmann::json::parse(fileBytes(d / "s.json"));
  const int cells = matrix["observations"].get<int>() / matrix["step"].get<int>() + 1;
  EXPECT_LE(cells, 1001);
  const auto& kinds = matrix["cells"];
  EXPECT_GT(kinds["recognized_same"].size(), 300u);
  EXPECT_GT(kinds["true_same"].size(), 700u);
  std::set<nlohmann::json> marked;
  for (const auto& kind : kinds) {
    for (const auto& cell : kind) {
      EXPECT_LE(cell[1], cell[0]);  // earlier observations only
      EXPECT_LT(cell[0], cells);
      EXPECT_TRUE(marked.insert(cell).second);  // one kind each
    }
  }
  ASSERT_EQ(std::system(("/usr/bin/python3 " HYSELAM_PACKAGE_DIR "/../../scripts/plot_similarity " +
                         d / "s.json " + d / "s.png")
                            .c_str()),
            0);
  EXPECT_EQ(fileBytes(d / "s.png").substr(1, 3), "PNG");
}

TEST_F(Evaluator, refusesInvalidLists) {
  for (const char* bad : {"x", "0..3", "5..2", "1..", "1,,2", "1..3x"}) {
    EXPECT_EQ(run("--n " + std::string(bad)), 2) << bad;
    EXPECT_NE(errors.find("--n"), std::string::npos) << errors;
    EXPECT_EQ(std::count(errors.begin(), errors.end(), '\n'), 1) << errors;
  }
  EXPECT_EQ(run("--table /nowhere/t.csv"), 2);
  EXPECT_EQ(run("--similarity /nowhere/s.json"), 2);
}
