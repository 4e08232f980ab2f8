// From logs to scores: observations of a log, and the tools as a shell sees them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "fsd_localization/models/grid_ray_caster.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/rng.hpp"
#include "hyselam_common/ros/bag_io.hpp"
#include "hyselam_common/testing/files.hpp"
#include "ngram_slam/words/corpus.hpp"
#include "ngram_slam/words/log_observations.hpp"
#include "tool_test.hpp"

using namespace ngram_slam;  // NOLINT: a test, not a header
using hyselam::Pose2;
using hyselam::testing::fileBytes;
using hyselam::testing::messageOf;
using hyselam::testing::writeFile;

namespace {

/// A corridor of 2 m around a block of 16 x 12 m, with niches that make it asymmetric.
const hyselam::OccupancyGrid& building() {
  static const hyselam::OccupancyGrid map = [] {
    hyselam::GridGeometry g;
    g.width = 280;
    g.height = 240;
    g.resolution = 0.1;
    hyselam::OccupancyGrid m(g, 100);
    const auto open = [&](double x0, double y0, double x1, double y1) {
      for (int y = static_cast<int>(y0 * 10); y < static_cast<int>(y1 * 10); ++y) {
        for (int x = static_cast<int>(x0 * 10); x < static_cast<int>(x1 * 10); ++x) {
          m.at({x, y}) = 0;
        }
      }
    };
    open(4, 4, 24, 20);
    for (int y = 60; y < 180; ++y) {
      for (int x = 60; x < 220; ++x) m.at({x, y}) = 100;
    }
    open(9, 2, 12, 4);  // niches
    open(24, 13, 26, 17);
    open(10, 20, 16, 22);
    open(17, 20, 18, 23);
    return m;
  }();
  return map;
}

/// Round the block, `laps` times, in steps of 5 cm and with rounded corners.
hyselam::RobotLog drive(int laps) {
  hyselam::RobotLog log;
  const fsd_localization::GridRayCaster rays(building());
  Pose2 at{7, 5, 0};
  const Pose2 start = at;
  hyselam::Rng rng(3);
  double stamp = 1.0;
  const auto step = [&](double length, double turn) {
    at = at * Pose2{length, 0.0, turn};
    hyselam::LaserScan s;
    s.stamp = stamp += 0.1;
    s.angle_min = -hyselam::kPi / 2;
    s.angle_increment = hyselam::kPi / 90;
    s.range_min = 0.05;
    s.range_max = 20.0;
    for (int b = 0; b < 91; ++b) {
      s.ranges.push_back(static_cast<float>(
          rays.range(at.x, at.y, at.theta + s.angle_min + b * s.angle_increment, s.range_max) +
          rng.gaussian(0.0, 0.01)));
    }
    log.scans.push_back(s);
    log.odometry.push_back({s.stamp, start.inverse() * at});
    log.ground_truth.push_back({s.stamp, at});
  };
  for (int side = 0; side < 4 * laps; ++side) {
    const int straight = side % 2 == 0 ? 318 : 238;  // with the arcs: 18 and 14 m
    for (int i = 0; i < straight; ++i) step(0.05, 0.0);
    for (int i = 0; i < 40; ++i) step(1.05 * hyselam::kPi / 80, hyselam::kPi / 80);
  }
  return log;
}

}  // namespace

TEST(LogObservations, comeAtEveryStepOfThePath) {
  hyselam::RobotLog log = drive(1);
  LogObservationParams params;
  params.bandwidth = 1.5;
  const LogObservations seen = observationsOf(log, params);
  EXPECT_EQ(seen.scans_refused, 0u);
  double way = 0.0;
  for (std::size_t i = 1; i < log.odometry.size(); ++i) {
    way += hyselam::distance(log.odometry[i - 1].pose, log.odometry[i].pose);
  }
  EXPECT_NEAR(static_cast<double>(seen.observations.size()), way / 0.1, 0.05 * way / 0.1);
  // A corridor is narrower than the place beside a niche.
  const auto densityNear = [&](double x, double y) {
    double best = 1e9, density = 0.0;
    for (const DensityObservation& o : seen.observations) {
      const Pose2 p = Pose2{7, 5, 0} * o.base_in_odom;
      const double away = std::hypot(p.x - x, p.y - y);
      if (away >= best) continue;
      best = away;
      density = o.soft;
    }
    EXPECT_LT(best, 0.5);
    return density;
  };
  EXPECT_GT(densityNear(10.7, 5), densityNear(15, 5) + 0.05);

  // Every third scan, 15 cm apart: the count is still the length.
  hyselam::RobotLog sparse = log;
  sparse.scans.clear();
  for (std::size_t i = 0; i < log.scans.size(); i += 3) sparse.scans.push_back(log.scans[i]);
  const auto thin = observationsOf(sparse, params).observations;
  EXPECT_NEAR(static_cast<double>(thin.size()), way / 0.1, 0.05 * way / 0.1);
  for (std::size_t i = 1; i < thin.size(); ++i) ASSERT_GE(thin[i].stamp, thin[i - 1].stamp);

  log.odometry.clear();
  EXPECT_EQ(observationsOf(log, params).scans_without_odometry, log.scans.size());
  params.bandwidth = 100.0;
  EXPECT_NE(messageOf<hyselam::ParameterError>([&] { observationsOf(log, params); }), "");
}

class Tools : public ToolTest {
 protected:
  static void SetUpTestSuite() {
    ToolTest::SetUpTestSuite();
    hyselam::writeBag(*directory / "r.bag", drive(3));
  }
};

TEST_F(Tools, wordsOfflineWritesWordsMatchesAndCorpus) {
  const std::string options = " --levels 2 --min-n 4,6 --bandwidth 1.5 --classes 10 ";
  ASSERT_EQ(run("words_offline " + d / "r.bag" + options + "--out " + d / "a" + " --corpus " +
                d / "c" + " --json " + d / "j.json"),
            0)
      << errors;
  EXPECT_EQ(errors, "");
  const auto j = nlohmann::json::parse(fileBytes(d / "j.json"));
  EXPECT_GT(j["words"], 20);
  EXPECT_GT(j["matches"], 5);
  const std::string words = fileBytes(d / "a/words.csv"), matches = fileBytes(d / "a/matches.csv");
  EXPECT_EQ(words.rfind("word,level,first,last,run,stamp_begin,stamp_end,class,size,angle\n", 0),
            0u);
  EXPECT_EQ(static_cast<std::size_t>(std::count(words.begin(), words.end(), '\n')),
            1 + j["words"].get<std::size_t>() + j["alternative_words"].get<std::size_t>());
  EXPECT_EQ(matches.rfind("stamp_a,stamp_b,level,n,direction,x,y,theta,verified,", 0), 0u);
  EXPECT_NE(matches.find(",same,0,0,0,0,"), std::string::npos);
  const std::string regions = fileBytes(d / "a/regions.csv");
  EXPECT_EQ(regions.rfind("first,last,stamp_begin,stamp_end,class,confidence\n0,", 0), 0u);
  EXPECT_NE(regions.find("," + std::to_string(j["observations"].get<int>() - 1) + ","),
            std::string::npos);
  EXPECT_EQ(CorpusFile::load(d / "c").observations.size(), j["observations"].get<std::uint32_t>());
  // The same input gives the same bytes.
  ASSERT_EQ(run("words_offline " + d / "r.bag" + options + "--out " + d / "b"), 0) << errors;
  EXPECT_EQ(fileBytes(d / "b/words.csv"), words);
  EXPECT_EQ(fileBytes(d / "b/matches.csv"), matches);
  EXPECT_EQ(fileBytes(d / "b/regions.csv"), regions);
}

TEST_F(Tools, evaluateRecognitionFindsTheLaterLaps) {
  ASSERT_EQ(run("evaluate_recognition " + d / "r.bag" +
                " --levels 2 --min-n 4,6 --bandwidth 1.5 --classes 10 --json " + d / "j.json"),
            0)
      << errors;
  const auto j = nlohmann::json::parse(fileBytes(d / "j.json"));
  EXPECT_GT(j["revisits"], 1000);
  EXPECT_GE(j["precision"], 0.95);
  EXPECT_GE(j["recall"], 0.5);
  EXPECT_GE(j["match_precision"], 0.95);
}

TEST_F(Tools, evaluateRecognitionTellsOfPlacesAsSlamRecognizesThemUnlessAskedForWords) {
  const std::string tool = "evaluate_recognition " + d / "r.bag";
  ASSERT_EQ(run(tool + " --json " + d / "j.json"), 0) << errors;
  const auto j = nlohmann::json::parse(fileBytes(d / "j.json"));
  EXPECT_EQ(j["recognized_by"], "places");
  EXPECT_GT(j["words"], 0);
  EXPECT_GT(j["matches"], 0);
  EXPECT_GE(j["match_precision"], 0.95);
  EXPECT_GE(j["precision"], 0.95);
  EXPECT_GE(j["recall_any_direction"], 0.5);
  EXPECT_GE(j["revisits_any_direction"], j["revisits"]);
  EXPECT_GE(j["revisits_any_direction"], j["revisits_older_than_40_m"]);
  // A revisit may have more than one earlier pass, and not all of them are told.
  EXPECT_LE(j["pass_recall_any_direction"], j["recall_any_direction"]);

  // Two logs are asked apart; the figures are of all their questions.
  ASSERT_EQ(run(tool + " " + d / "r.bag" + " --json " + d / "two.json"), 0) << errors;
  const auto two = nlohmann::json::parse(fileBytes(d / "two.json"));
  ASSERT_EQ(two["logs"].size(), 2u);
  EXPECT_EQ(two["matches"], 2 * j["matches"].get<int>());
  EXPECT_EQ(two["recall_any_direction"], j["recall_any_direction"]);

  ASSERT_EQ(run(tool + " --by words --json " + d / "w.json"), 0) << errors;
  EXPECT_EQ(nlohmann::json::parse(fileBytes(d / "w.json"))["recognized_by"], "words");
  expectRefused(tool + " --by places --levels 2", "--levels");
  expectRefused(tool + " --by letters", "letters");
  expectRefused(tool + " --by words --model m.txt", "--model");
  expectRefused(tool + " --model " + d / "no.txt", "no.txt");
}

TEST_F(Tools, evaluatePlacesAsksAllMethodsTheSame) {
  ASSERT_EQ(
      run("evaluate_places " + d / "r.bag" +
          " --method signatures,words-thesis,context-submap,chains --no-verification --json " +
          d / "p.json"),
      0);
  const auto j = nlohmann::json::parse(fileBytes(d / "p.json"));
  ASSERT_EQ(j.size(), 4u);
  for (const auto& row : j) {
    EXPECT_EQ(row["questions"], j[0]["questions"]);
    EXPECT_EQ(row["revisits"], j[0]["revisits"]);
    EXPECT_GT(row["revisits"], 0);
    EXPECT_EQ(row["verified"], 0);
    // What is found alone is among what is found at all, and pairs are judged harder than places.
    EXPECT_LE(row["recall_unverified_none_wrong"], row["first_1"]);
    EXPECT_LE(row["recall_unverified_no_pair_wrong"], row["recall_unverified_none_wrong"]);
    EXPECT_LE(row["first_1"], row["first_10"]);
  }
  // A second lap of the same corridors: each of them finds places again.
  EXPECT_GT(j[0]["first_5"], 0.5);
  EXPECT_GT(j[1]["first_5"], 0.1);
  EXPECT_GT(j[2]["first_5"], 0.5);
  EXPECT_GT(j[3]["first_5"], 0.5);
}

TEST_F(Tools, evaluatePlacesRefusesOptionsThatItWouldIgnore) {
  const std::string tool = "evaluate_places " + d / "r.bag ";
  expectRefused(tool + "--candidates 0", "--candidates");
  expectRefused(tool + "--candidates 101", "--candidates");
  expectRefused(tool + "--leave-one-out", "--leave-one-out");
  expectRefused(tool + d / "r.bag" + " --leave-one-out --model m.txt", "--model");
  expectRefused(tool + "--no-verification --matches " + d / "m.csv", "--matches");
  const std::string peer = tool + "--method context-scan ";
  expectRefused(peer + "--model m.txt", "--model");
  expectRefused(peer + "--leave-one-out", "--leave-one-out");
  expectRefused(peer + "--exact", "--exact");
  expectRefused(peer + "--matches " + d / "m.csv", "--matches");
  expectRefused(tool + "--method signatures,letters", "letters");
  expectRefused(tool + "--reference a --reference b", "--reference");
}

TEST_F(Tools, refuseUnusableInputInOneLine) {
  expectRefused("words_offline /nowhere.bag --out " + d / "x", "/nowhere.bag");
  writeFile(d / "bad.log", "FLASER nonsense\n");
  expectRefused("words_offline " + d / "bad.log" + " --out " + d / "x", "bad.log");
  writeFile(d / "file", "");
  expectRefused("words_offline " + d / "r.bag" + " --out " + d / "file/x", "file/x");
  expectRefused("words_offline " + d / "r.bag" + " --levels 0 --out " + d / "x", "levels");
  expectRefused("words_offline " + d / "r.bag" + " --levels 2000000000 --out " + d / "x", "levels");
  expectRefused("words_offline " + d / "r.bag" + " --min-n 0 --out " + d / "x", "min_n");
  expectRefused("words_offline " + d / "r.bag" + " --step 0 --out " + d / "x", "step");
  expectRefused("evaluate_recognition " + d / "r.bag" + " --reference " + d / "file", "file");
  expectRefused("evaluate_recognition " + d / "r.bag" + " --distance -1", "distance");
  EXPECT_EQ(run("words_offline --help"), 0);
  EXPECT_EQ(run("evaluate_recognition --help"), 0);
  EXPECT_EQ(run("words_offline"), 2);
}
