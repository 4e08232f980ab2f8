// The tools as a shell sees them: exit status, one line of error, results as JSON.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "altered_log.hpp"
#include "fsd_localization/models/grid_ray_caster.hpp"
#include "hyselam_common/map_io.hpp"
#include "hyselam_common/ros/bag_io.hpp"
#include "hyselam_common/testing/drawn_grid.hpp"
#include "hyselam_common/testing/files.hpp"
#include "hyselam_common/testing/program_run.hpp"
#include "hyselam_common/trajectory_io.hpp"
#include "localization_score.hpp"
#include "look.hpp"

namespace {

using hyselam::Pose2;
using hyselam::testing::fileBytes;
using hyselam::testing::TemporaryDirectory;
using hyselam::testing::writeFile;

/// A room of 8 x 5 m with a niche.
hyselam::OccupancyGrid room() {
  return hyselam::testing::drawnGrid({"#####",  //
                                      "#...#",  //
                                      "#.#.#",  //
                                      "#####"},
                                     0.1, {2, 49, 5, 22, 2}, {2, 28, 18, 2});
}

/// Three metres straight on, a scan each 10 cm.
hyselam::RobotLog drive() {
  hyselam::RobotLog log;
  const fsd_localization::GridRayCaster rays(room());
  for (int i = 0; i < 30; ++i) {
    const Pose2 at{1.0 + 0.1 * i, 2.5, 0.0};
    hyselam::LaserScan s = look(rays, at, 1.0 + 0.2 * i, 20.0);
    s.range_min = 0.05;
    log.scans.push_back(s);
    log.odometry.push_back({s.stamp, {0.1 * i, 0.0, 0.0}});
    log.ground_truth.push_back({s.stamp, at});
  }
  return log;
}

class Tools : public ::testing::Test {
 protected:
  void SetUp() override {
    hyselam::saveMap(d / "m.yaml", room());
    hyselam::writeBag(d / "r.bag", drive());
  }
  int run(const std::string& command) {
    const auto done = hyselam::testing::runProgram(std::string(HYSELAM_TOOLS) + "/" + command, d);
    errors = done.errors;
    return done.status;
  }
  int localize(const std::string& options) {
    return run("localize_offline --map " + d / "m.yaml --bag " + d / "r.bag --particles 2000 " +
               options);
  }
  int field(const std::string& options) { return run("fsd_field " + d / "m.yaml " + options); }
  /// Of the program that ran last.
  void expectRefused(int status, const std::string& part) {
    EXPECT_TRUE(hyselam::testing::refused({status, "", errors}, part));
  }

  TemporaryDirectory d;
  std::string errors;
};

TEST_F(Tools, LocalizeOfflineWritesTrajectoryAndJson) {
  ASSERT_EQ(localize("--trajectory " + d / "t.tum --json " + d / "j.json"), 0) << errors;
  const auto json = nlohmann::json::parse(fileBytes(d / "j.json"));
  EXPECT_EQ(json["updates"], hyselam::readTum(d / "t.tum").size());
  EXPECT_EQ(json["scans_refused"], 0);
  EXPECT_EQ(json["scans_without_odometry"], 0);
  EXPECT_TRUE(json["against_reference"]["kidnaps"].empty());
  EXPECT_EQ(json, nlohmann::json::parse(fileBytes(d / "stdout")));
}

TEST_F(Tools, LocalizeOfflineSaysThatItWasNeverSure) {
  ASSERT_EQ(localize("--json " + d / "j.json"), 0);
  const auto json = nlohmann::json::parse(fileBytes(d / "j.json"));
  EXPECT_EQ(json["converged_at_m"].is_null(), errors.find("never sure in") != std::string::npos);
  ASSERT_EQ(localize("--distance 0.05 --model fsd --json " + d / "j.json"), 0);
  ASSERT_TRUE(nlohmann::json::parse(fileBytes(d / "j.json"))["converged_at_m"].is_null());
  EXPECT_NE(errors.find("never sure in 0 m: is this the right map?"), std::string::npos) << errors;
}

TEST_F(Tools, LocalizeOfflineTellsOfStands) {
  ASSERT_EQ(localize("--start-known --stops 2 --stand 3 --json " + d / "j.json"), 0) << errors;
  const auto report = nlohmann::json::parse(fileBytes(d / "j.json"))["against_reference"];
  ASSERT_EQ(report["stands"].size(), 2U);
  EXPECT_NEAR(report["stands"][0]["begin_s"], 3.0, 0.21);
  EXPECT_FALSE(report["stands"][0]["carried"]);
  EXPECT_TRUE(report["kidnaps"].empty()) << "to stand is no jump";
  expectRefused(localize("--stops 2 --kidnaps 2"), "--stops");
  expectRefused(localize("--stops 2 --crowd 1.5"), "--crowd");
}

TEST_F(Tools, EqualSeedsGiveEqualBytes) {
  ASSERT_EQ(localize("--seed 3 --trajectory " + d / "a.tum"), 0) << errors;
  ASSERT_EQ(localize("--seed 3 --trajectory " + d / "b.tum"), 0) << errors;
  ASSERT_EQ(localize("--seed 4 --trajectory " + d / "c.tum"), 0) << errors;
  EXPECT_TRUE(fileBytes(d / "a.tum") == fileBytes(d / "b.tum"));
  EXPECT_FALSE(fileBytes(d / "a.tum") == fileBytes(d / "c.tum"));
}

TEST_F(Tools, CacheGivesEqualPosesAndUnwritableCacheIsReported) {
  ASSERT_EQ(localize("--trajectory " + d / "a.tum"), 0) << errors;
  for (const char* round : {"written", "read"}) {
    ASSERT_EQ(localize("--cache --trajectory " + d / "b.tum"), 0) << round << errors;
    EXPECT_EQ(errors, "");
    EXPECT_TRUE(std::filesystem::is_regular_file(d / "m.yaml.fsd"));
    EXPECT_TRUE(fileBytes(d / "a.tum") == fileBytes(d / "b.tum")) << round;
  }
  std::filesystem::remove(d / "m.yaml.fsd");
  std::filesystem::create_directory(d / "m.yaml.fsd");  // where the file should go
  ASSERT_EQ(localize("--cache --trajectory " + d / "b.tum"), 0) << errors;
  EXPECT_EQ(errors.rfind("warning: the density fields are not kept: " + d / "m.yaml.fsd", 0), 0U)
      << errors;
  EXPECT_TRUE(fileBytes(d / "a.tum") == fileBytes(d / "b.tum"));
}

TEST_F(Tools, FsdFieldDraws) {
  ASSERT_EQ(field("--bandwidth 1 --out " + d / "f.png --json " + d / "j.json"), 0) << errors;
  EXPECT_GT(std::filesystem::file_size(d / "f.png"), 100U);
  const auto json = nlohmann::json::parse(fileBytes(d / "j.json"));
  EXPECT_EQ(json["cells"], 4000);
  EXPECT_EQ(json["radius_cells"], 10);
  EXPECT_EQ(json["bytes"], 16000);
}

TEST_F(Tools, HelpIsNoError) {
  EXPECT_EQ(run("localize_offline --help"), 0);
  EXPECT_EQ(run("fsd_field --help"), 0);
}

TEST_F(Tools, WrongUsageIsStatus2) {
  expectRefused(run("localize_offline"), "--");
  expectRefused(localize("--no-such-option"), "--no-such-option");
  expectRefused(localize("--start -1"), "--start");
  expectRefused(run("localize_offline --map " + d / "m.yaml --bag " + d / "r.bag" +
                    " --search-alone --start-known"),
                "--start-known");
  expectRefused(field(""), "--out");
  expectRefused(field("--out " + d / "f.png --threads many"), "--threads");
}

TEST_F(Tools, UnreadableInputIsStatus2) {
  expectRefused(run("localize_offline --map " + d / "none.yaml --bag " + d / "r.bag"), "none.yaml");
  expectRefused(run("localize_offline --map " + d / "m.yaml --bag " + d / "none.bag"), "none.bag");
  writeFile(d / "text.bag", "no bag");
  expectRefused(run("localize_offline --map " + d / "m.yaml --bag " + d / "text.bag"), "text.bag");
  expectRefused(localize("--reference " + d / "none.tum"), "none.tum");
  expectRefused(localize("--start 1000"), "after the last scan");
  expectRefused(run("fsd_field " + d / "none.yaml --out " + d / "f.png"), "none.yaml");
  EXPECT_FALSE(std::filesystem::exists(d / "f.png"));
}

TEST_F(Tools, ParametersOutOfRangeAreStatus2) {
  expectRefused(localize("--model amcl"), "fsd, beam, cosine, likelihood, hybrid");
  expectRefused(localize("--kernel round"), "uniform, gaussian, inverted");
  expectRefused(localize("--bandwidths 1.5,20"), "bandwidth");
  expectRefused(localize("--bandwidths 1.5,nan"), "bandwidth");
  expectRefused(localize("--particles 0"), "particles");
  expectRefused(field("--out " + d / "f.png --kernel round"), "uniform, gaussian, inverted");
  expectRefused(field("--out " + d / "f.png --bandwidth 50"), "127 cells");
  expectRefused(field("--out " + d / "f.png --bandwidth nan"), "bandwidth");
}

TEST_F(Tools, UnwritableOutputIsStatus2) {
  expectRefused(localize("--trajectory " + d / "none/t.tum"), "none/t.tum");
  expectRefused(localize("--json " + d / "none/j.json"), "none/j.json");
  expectRefused(field("--out " + d / "none/f.png"), "none/f.png");
  expectRefused(field("--out " + d / "f.xyz"), "f.xyz: no picture format");
  EXPECT_FALSE(std::filesystem::exists(d / "f.xyz"));
}

}  // namespace

// A robot that is tracked, and from the given update on, a decimetre each, 10 m aside.
TEST(LocalizationScore, aPoseThatIsLeftForAnotherIsAnAlarmAndFalseIfItWasRight) {
  for (const bool was_right : {true, false}) {
    fsd_localization::LocalizationScore score({});
    for (int i = 0; i < 40; ++i) {
      fsd_localization::LocalizationResult r;
      r.converged = true;
      r.phase = fsd_localization::Phase::kTracking;
      r.travelled = 0.1 * i;
      const bool aside = i >= 20;
      r.base_in_map = {0.1 * i, aside ? 10.0 : 0.0, 0.0};
      score.add(r, {0.1 * i, was_right ? 0.0 : 10.0, 0.0});
    }
    const auto report = score.report();
    ASSERT_EQ(report["alarms"].size(), 1U);
    EXPECT_EQ(report["alarms"][0]["false"], was_right);
    EXPECT_EQ(report["false_doubts"], was_right ? 1 : 0);
  }
}

TEST(AlteredLog, stopsOnItsWayAmongPeopleAndDrivesOn) {
  const hyselam::RobotLog log = drive();
  fsd_localization::Alterations stops;
  stops.stops = 2;
  stops.stand = 3.0;
  stops.crowd = 0.5;
  const auto altered = fsd_localization::altered(log, log.ground_truth, stops);
  ASSERT_EQ(altered.stands.size(), 2U);
  ASSERT_EQ(altered.log.scans.size(), log.scans.size() + 2 * 30);
  ASSERT_EQ(altered.log.odometry.size(), altered.log.scans.size());
  const auto& stand = altered.stands[0];
  EXPECT_FALSE(stand.carried);
  EXPECT_NEAR(stand.end - stand.begin, 3.0, 1e-9);
  for (std::size_t i = 0; i < altered.log.scans.size(); ++i) {
    const hyselam::LaserScan& scan = altered.log.scans[i];
    if (i > 0) {
      EXPECT_GT(scan.stamp, altered.log.scans[i - 1].stamp);
    }
    const bool stands = std::any_of(
        altered.stands.begin(), altered.stands.end(),
        [&](const auto& s) { return scan.stamp > s.begin + 1e-6 && scan.stamp < s.end + 1e-6; });
    const auto hidden = std::count(scan.ranges.begin(), scan.ranges.end(), 0.6F);
    EXPECT_EQ(hidden > static_cast<std::ptrdiff_t>(scan.ranges.size()) / 2 - 10, stands) << i;
    if (stands) {
      EXPECT_EQ(altered.log.odometry[i].pose.x, altered.log.odometry[i - 1].pose.x);
    }
  }
  EXPECT_NEAR(altered.log.scans.back().stamp, log.scans.back().stamp + 6.0, 1e-9);
  EXPECT_EQ(altered.log.odometry.back().pose.x, log.odometry.back().pose.x);
}

// It drives 40 m straight on: carried off, it stands before the wheels turn again.
TEST(AlteredLog, isCarriedOffAndLeftStanding) {
  hyselam::RobotLog log;
  for (int i = 0; i < 400; ++i) {
    hyselam::LaserScan scan;
    scan.stamp = 0.2 * i;
    scan.range_max = 20.0;
    scan.ranges = {static_cast<float>(i)};
    log.scans.push_back(scan);
    log.odometry.push_back({scan.stamp, {0.1 * i, 0.0, 0.0}});
    log.ground_truth.push_back(log.odometry.back());
  }
  fsd_localization::Alterations kidnap;
  kidnap.kidnaps = 1;
  kidnap.stand = 2.0;
  const auto altered = fsd_localization::altered(log, log.ground_truth, kidnap);
  ASSERT_EQ(altered.stands.size(), 1U);
  EXPECT_TRUE(altered.stands[0].carried);
  std::size_t jump = 0;
  for (std::size_t i = 1; i < altered.log.scans.size(); ++i) {
    EXPECT_GT(altered.log.scans[i].stamp, altered.log.scans[i - 1].stamp);
    const auto step = [&](const std::vector<hyselam::StampedPose2>& poses) {
      return hyselam::distance(poses[i].pose, poses[i - 1].pose);
    };
    EXPECT_LT(step(altered.log.odometry), 0.11);
    if (step(altered.log.ground_truth) > 1.0) jump = i;
  }
  ASSERT_GT(jump, 0U);
  EXPECT_NEAR(altered.stands[0].begin, altered.log.scans[jump].stamp, 1e-9);
  for (std::size_t i = jump; i <= jump + 20; ++i) {
    EXPECT_EQ(altered.log.scans[i].ranges, altered.log.scans[jump].ranges);
    EXPECT_NEAR(altered.log.odometry[i].pose.x, altered.log.odometry[jump - 1].pose.x, 1e-9);
  }
  EXPECT_NE(altered.log.scans[jump + 21].ranges, altered.log.scans[jump].ranges);
}

// Stands of two seconds: what was told within them counts, and what comes after.
TEST(LocalizationScore, tellsWhatAStandingRobotSaid) {
  fsd_localization::LocalizationScore score({});
  const auto add = [&](double stamp, double travelled, bool converged) {
    fsd_localization::LocalizationResult r;
    r.stamp = stamp;
    r.travelled = travelled;
    r.converged = converged;
    r.phase = fsd_localization::Phase::kTracking;
    score.add(r, {});
  };
  add(1.0, 0.0, true);
  add(2.5, 0.0, false);  // within the second stand alone
  add(4.0, 0.5, false);
  add(5.0, 1.0, true);
  const auto stands = score.stands({{1.0, 2.0, false}, {2.0, 3.0, false}, {5.0, 6.0, false}});
  ASSERT_EQ(stands.size(), 3U);
  EXPECT_TRUE(stands[0]["unsure_after_s"].is_null());
  EXPECT_TRUE(stands[0]["sure_at_end"]);
  EXPECT_NEAR(stands[1]["unsure_after_s"], 0.5, 1e-9);
  EXPECT_TRUE(stands[1]["was_sure"]);
  EXPECT_FALSE(stands[1]["sure_at_end"]);
  EXPECT_FALSE(stands[1]["was_lost"]);
  EXPECT_NEAR(stands[1]["sure_again_after_m"], 1.0, 1e-9);
  EXPECT_TRUE(stands[2]["sure_again_after_m"].is_null());
}
