// CARMEN logs: every message form, every kind of damage, and times that run wild.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "hyselam_common/carmen_log.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/rng.hpp"
#include "hyselam_common/testing/files.hpp"

namespace hyselam {
namespace {

using Kind = CarmenIssue::Kind;
using testing::messageOf;

struct Read {
  RobotLog log;
  std::vector<CarmenIssue> issues;
};

Read read(const std::string& text, const CarmenOptions& options = {}) {
  Read r;
  r.log = parseCarmenLog(text, "test.log", options, &r.issues);
  return r;
}

std::string readings(int n, const std::string& value = "2.5") {
  std::string text;
  for (int i = 0; i < n; ++i) text += " " + value;
  return text;
}

std::string flaser(double stamp, int n = 180, double x = 0.0) {
  return "FLASER " + std::to_string(n) + readings(n) + " 0 0 0 " + std::to_string(x) + " 2 0.5 " +
         std::to_string(1000.0 + stamp) + " host " + std::to_string(stamp) + "\n";
}

std::string odom(double stamp, double x) {
  return "ODOM " + std::to_string(x) + " 0 0 0.1 0 0 " + std::to_string(1000.0 + stamp) + " host " +
         std::to_string(stamp) + "\n";
}

/// `bad` between two good scans: reported at line 2 for `reason` and skipped.
::testing::AssertionResult skipped(const std::string& bad, const std::string& reason) {
  const Read r = read(flaser(1) + bad + "\n" + flaser(2));
  if (r.log.scans.size() != 2) {
    return ::testing::AssertionFailure() << r.log.scans.size() << " scans";
  }
  if (r.issues.size() != 1 || r.issues[0].line != 2 || r.issues[0].kind != Kind::kSkipped) {
    return ::testing::AssertionFailure() << r.issues.size() << " issues";
  }
  if (r.issues[0].reason.find(reason) == std::string::npos) {
    return ::testing::AssertionFailure() << "reason is '" << r.issues[0].reason << "'";
  }
  return ::testing::AssertionSuccess();
}

TEST(CarmenLog, FrontLaserScans) {
  const Read r = read(
      "# comment\nPARAM robot_frontlaser_offset 0.25 nohost 0\n\n"
      "FLASER 4 1.5 2.5 3.5 4.5 9 9 9 1 2 0.5 976052857.3 host 12.5\r\n");
  ASSERT_EQ(r.log.scans.size(), 1U);
  EXPECT_TRUE(r.issues.empty());
  const LaserScan& s = r.log.scans[0];
  EXPECT_DOUBLE_EQ(s.stamp, 12.5);
  EXPECT_EQ(s.ranges, (std::vector<float>{1.5F, 2.5F, 3.5F, 4.5F}));
  EXPECT_DOUBLE_EQ(s.laser_in_base.x, 0.25);
  ASSERT_EQ(r.log.odometry.size(), 1U);
  EXPECT_DOUBLE_EQ(r.log.odometry[0].pose.x, 1.0);
  EXPECT_DOUBLE_EQ(r.log.odometry[0].pose.theta, 0.5);
  EXPECT_DOUBLE_EQ(read("FLASER 2 1 1 0 0 0 0 0 0 976052857.3 h 1\n",
                        [] {
                          CarmenOptions o;
                          o.clock = CarmenClock::kIpc;
                          return o;
                        }())
                       .log.scans[0]
                       .stamp,
                   976052857.3);
}

TEST(CarmenLog, FieldOfViewFollowsFromTheBeamCount) {
  for (const int n : {180, 181, 360, 361}) {
    const LaserScan s = read(flaser(1, n)).log.scans[0];
    EXPECT_DOUBLE_EQ(s.angle_min, -kPi / 2);
    EXPECT_DOUBLE_EQ(s.angle_increment, radians(n > 200 ? 0.5 : 1.0)) << n;
  }
}

TEST(CarmenLog, RobotLaserOldAndNewForm) {
  const std::string poses = "1.2 0 0.1 1 0 0.1 ", motion = "0.3 0 0.4 0.5 1e6 ";
  const std::string times = "1000 host 7\n";
  const std::vector<std::string> forms{
      "ROBOTLASER1 0 -1.5 3.0 0.1 50.0 0.1 0 3 1 2 3 0 " + poses + motion + times,
      "ROBOTLASER1 0 -1.5 3.0 0.1 50.0 0.1 1 3 1 2 3 3 7 8 9 " + poses + motion + times,
      "ROBOTLASER1 3 1 2 3 " + poses + motion + times, "ROBOTLASER1 3 1 2 3 " + poses + times};
  for (std::size_t i = 0; i < forms.size(); ++i) {
    const Read r = read(forms[i]);
    ASSERT_TRUE(r.issues.empty()) << forms[i] << toString(r.issues[0]);
    const LaserScan& s = r.log.scans[0];
    EXPECT_EQ(s.ranges, (std::vector<float>{1, 2, 3}));
    EXPECT_DOUBLE_EQ(s.stamp, 7.0);
    EXPECT_NEAR(s.laser_in_base.x, 0.2 * std::cos(0.1), 1e-12);
    EXPECT_NEAR(s.laser_in_base.y, -0.2 * std::sin(0.1), 1e-12);
    EXPECT_DOUBLE_EQ(s.angle_min, i < 2 ? -1.5 : -kPi / 2);
    EXPECT_DOUBLE_EQ(s.angle_increment, i < 2 ? 0.1 : kPi / 2);
    if (i < 2) {
      EXPECT_DOUBLE_EQ(s.range_max, 50.0);
    }
    EXPECT_DOUBLE_EQ(r.log.odometry.at(0).pose.x, 1.0);
  }
}

TEST(CarmenLog, RawLaserWithOdometryLines) {
  const Read r = read(odom(1, 1) + "RAWLASER1 0 -1.5 3.0 0.1 8.0 0.1 0 3 1 2 3 0 1000 host 1.5\n" +
                      odom(2, 3) + "RAWLASER2 3 1 2 3 1000 host 2.5\n");
  ASSERT_EQ(r.log.scans.size(), 1U);  // the second laser is another sensor
  EXPECT_DOUBLE_EQ(r.log.scans[0].range_max, 8.0);
  ASSERT_EQ(r.log.odometry.size(), 2U);
  EXPECT_DOUBLE_EQ(poseAt(r.log.odometry, 1.5)->x, 2.0);
  CarmenOptions second;
  second.scan_message = "RAWLASER2";
  EXPECT_DOUBLE_EQ(
      read(odom(1, 1) + "RAWLASER2 3 1 2 3 1000 host 2.5\n", second).log.scans.at(0).stamp, 2.5);
}

TEST(CarmenLog, FrontLaserIsPreferredToTheSameScansRaw) {
  const Read r = read("RAWLASER1 2 1 1 1000 h 1\n" + flaser(1));
  ASSERT_EQ(r.log.scans.size(), 1U);
  EXPECT_EQ(r.log.scans[0].ranges.size(), 180U);
}

TEST(CarmenLog, WeanHallFormatIsInCentimetres) {
  const Read r =
      read("O 100 200 0.5 1.0\nL 100 200 0.5 " + std::to_string(100 + 25 * std::cos(0.5)) + " " +
           std::to_string(200 + 25 * std::sin(0.5)) + " 0.5 150 250 8183 1.5\n");
  ASSERT_EQ(r.log.scans.size(), 1U);
  EXPECT_EQ(r.log.scans[0].ranges, (std::vector<float>{1.5F, 2.5F, 81.83F}));
  EXPECT_NEAR(r.log.scans[0].laser_in_base.x, 0.25, 1e-6);
  EXPECT_NEAR(r.log.scans[0].laser_in_base.y, 0.0, 1e-6);
  EXPECT_DOUBLE_EQ(r.log.odometry.at(0).pose.x, 1.0);
  EXPECT_DOUBLE_EQ(r.log.odometry.at(0).pose.y, 2.0);
}

TEST(CarmenLog, TruePosIsGroundTruth) {
  const Read r = read(flaser(1) + "TRUEPOS 1 2 0.5 0 0 0 1000 host 1.5\n");
  ASSERT_EQ(r.log.ground_truth.size(), 1U);
  EXPECT_DOUBLE_EQ(r.log.ground_truth[0].pose.y, 2.0);
}

TEST(CarmenLog, ScansOdometryWinsAtTheSameTime) {
  const Read r = read(odom(1, 5) + flaser(1, 180, 7) + odom(2, 6));
  ASSERT_EQ(r.log.odometry.size(), 2U);
  EXPECT_DOUBLE_EQ(r.log.odometry[0].pose.x, 7.0);
  EXPECT_DOUBLE_EQ(r.log.odometry[1].pose.x, 6.0);
}

TEST(CarmenLog, OdometryRightAfterAScanIsLeftOutOfCorrectedLogsOnly) {
  const std::string log = odom(1, 1) + flaser(1, 180, 1) + odom(1.5, 99) + odom(2, 2);
  EXPECT_EQ(read(log).log.odometry.size(), 3U);
  EXPECT_EQ(read(log + "NEFF 29.5\n").log.odometry.size(), 2U);
}

TEST(CarmenLog, KnownMessagesArePassedOverSilently) {
  EXPECT_TRUE(read("SYNC tag 1 h 1\nNEFF 1\nPARAM other 1\n#PARAM\n" + flaser(1)).issues.empty());
}

// --- damaged lines

TEST(CarmenLog, TruncatedLineIsReportedAndSkipped) {
  const std::string line = flaser(1.5);
  EXPECT_TRUE(skipped(line.substr(0, line.size() / 2), "readings announced, but only"));
  EXPECT_TRUE(skipped("FLASER", "ends before the number of readings"));
  EXPECT_TRUE(skipped("FLASER 2 1 1 0 0 0 0 0", "ends before the odometry"));
  EXPECT_TRUE(skipped("FLASER 2 1 1 0 0 0 0 0 0 1000", "ends before the host"));
  EXPECT_TRUE(skipped("FLASER 2 1 1 0 0 0 0 0 0 1000 h", "ends before the logger timestamp"));
  EXPECT_TRUE(skipped("ODOM 1 2 3", "ends before tv"));
  EXPECT_TRUE(skipped("TRUEPOS 1 2", "ends before the true pose"));
  EXPECT_TRUE(skipped("ROBOTLASER1 0 -1.5 3.0 0.1 50.0 0.1 0 3 1 2 3 0 1 2 3", "ends before"));
  EXPECT_TRUE(skipped("RAWLASER1 0 -1.5 3.0 0.1 50.0 0.1 0 3 1 2 3 5 1", "ends before"));
  EXPECT_TRUE(skipped("PARAM", "names no parameter"));
}

TEST(CarmenLog, WrongCountsAreReportedAndSkipped) {
  EXPECT_TRUE(skipped("FLASER 180" + readings(179) + " 0 0 0 0 0 0 1 h 1", "not a finite number"));
  EXPECT_TRUE(skipped("FLASER 2 1 1 1 0 0 0 0 0 0 1000 h 1", "not a finite number"));
  EXPECT_TRUE(skipped("FLASER 2 1 1 0 0 0 0 0 0 1000 h 1 5", "1 fields too many"));
  EXPECT_TRUE(skipped("FLASER 0 0 0 0 0 0 0 1000 h 1", "fewer than 2 readings"));
  EXPECT_TRUE(skipped("FLASER -3 1 1 0 0 0 0 0 0 1000 h 1", "not a sensible count"));
  EXPECT_TRUE(skipped("FLASER 2.5 1 1 0 0 0 0 0 0 1000 h 1", "not a sensible count"));
  EXPECT_TRUE(skipped("FLASER 4000000000 1 1 0 0 0 0 0 0 1000 h 1", "not a sensible count"));
}

TEST(CarmenLog, NumbersThatAreNoneAreReportedAndSkipped) {
  for (const char* bad : {"nan", "inf", "-inf", "1.0.0", "0x10", "1e999", "abc", "--1", "1,5"}) {
    EXPECT_TRUE(skipped(std::string("FLASER 2 1 ") + bad + " 0 0 0 0 0 0 1000 h 1",
                        "field 4 (a reading) is not a finite number"));
    EXPECT_TRUE(skipped(std::string("ODOM 1 ") + bad + " 3 0 0 0 1000 h 1", "(the odometry)"));
    EXPECT_TRUE(skipped(std::string("ODOM 1 2 3 0 0 0 1000 h ") + bad, "(the logger timestamp)"));
  }
  EXPECT_TRUE(skipped("FLASER 2 1 1e30 0 0 0 0 0 0 1000 h 1", "beyond 1000 km"));
  EXPECT_TRUE(skipped("PARAM robot_frontlaser_offset far", "the laser offset"));
  EXPECT_TRUE(skipped("ROBOTLASER1 0 -1.5 3.0 0 50 0.1 0 2 1 2 0 0 0 0 0 0 0 0 0 0 0 0 1 h 1",
                      "angles that no laser has"));
  EXPECT_TRUE(skipped("RAWLASER1 0 -1.5 3.0 0.1 -5 0.1 0 2 1 2 0 1 h 1", "negative maximum range"));
}

TEST(CarmenLog, UnknownMessageIsReportedAndSkipped) {
  EXPECT_TRUE(skipped("FLASR 2 1 1", "unknown message 'FLASR'"));
  EXPECT_TRUE(skipped("\x01\xff garbage",
                      "unknown message '?"
                      "?'"));
}

TEST(CarmenLog, LogWithoutUsableScanIsAnError) {
  const auto error = [](const std::string& text) {
    return messageOf<InputError>([&] { read(text); });
  };
  EXPECT_NE(error("").find("test.log: holds no usable scan"), std::string::npos);
  EXPECT_NE(error(odom(1, 1)).find("holds no usable scan"), std::string::npos);
  EXPECT_NE(error("FLASER 180 1 2 3\n").find("line 1"), std::string::npos);
  EXPECT_NE(error(std::string(1000, '\0')).find("holds no usable scan"), std::string::npos);
  CarmenOptions options;
  options.scan_message = "RAWLASER1";
  EXPECT_THROW(read(flaser(1), options), InputError);
}

TEST(CarmenLog, OptionsOutOfRangeAreRefused) {
  const auto refused = [](auto change) {
    CarmenOptions o;
    change(o);
    EXPECT_THROW(read(flaser(1), o), ParameterError);
  };
  refused([](auto& o) { o.range_max = -1.0; });
  refused([](auto& o) { o.range_min = 0.0; });
  refused([](auto& o) { o.index_period = 0.0; });
}

// --- time

TEST(CarmenLog, OneTimeTooLateIsPutBetweenItsNeighbours) {
  const Read r = read(flaser(1) + flaser(900) + flaser(3) + flaser(4));
  ASSERT_EQ(r.log.scans.size(), 4U);
  EXPECT_DOUBLE_EQ(r.log.scans[1].stamp, 2.0);
  ASSERT_EQ(r.issues.size(), 1U);
  EXPECT_EQ(r.issues[0].line, 2U);
  EXPECT_EQ(r.issues[0].kind, Kind::kRetimed);
  EXPECT_DOUBLE_EQ(poseAt(r.log.odometry, 2.0)->y, 2.0);
}

TEST(CarmenLog, OneTimeTooEarlyIsPutBetweenItsNeighbours) {
  const Read r = read(flaser(10) + flaser(11) + flaser(0.5) + flaser(13) + flaser(13) + flaser(15));
  ASSERT_EQ(r.log.scans.size(), 6U);
  EXPECT_DOUBLE_EQ(r.log.scans[2].stamp, 12.0);
  EXPECT_EQ(r.issues.size(), 2U);  // the second 13 too: scans need times of their own
  for (std::size_t i = 1; i < 6; ++i) EXPECT_GT(r.log.scans[i].stamp, r.log.scans[i - 1].stamp);
}

TEST(CarmenLog, TimesThatNoBagHoldsAreReplaced) {
  const Read r = read(flaser(-5) + flaser(2) + flaser(3) + flaser(5e9) + flaser(4) + flaser(5));
  ASSERT_EQ(r.log.scans.size(), 6U);
  EXPECT_GE(r.log.scans[0].stamp, 0.0);
  EXPECT_LT(r.log.scans[0].stamp, 2.0);
  EXPECT_DOUBLE_EQ(r.log.scans[3].stamp, 3.5);
}

TEST(CarmenLog, UnusableClockIsReplacedByMessageNumbers) {
  std::string text;
  for (int i = 0; i < 10; ++i) text += flaser(100.0 - i);
  const Read r = read(text);
  ASSERT_EQ(r.log.scans.size(), 10U);
  EXPECT_NEAR(r.log.scans[9].stamp, 0.9, 1e-12);
  ASSERT_EQ(r.issues.size(), 1U);
  EXPECT_EQ(r.issues[0].kind, Kind::kLog);
}

TEST(CarmenLog, TimesInOrderAreNeverTouched) {
  Rng rng(4);
  std::string text;
  std::vector<double> stamps;
  double t = 0;
  for (int i = 0; i < 300; ++i) {
    t += rng.uniform(0.001, 20.0);
    stamps.push_back(std::stod(std::to_string(t)));
    text += flaser(t, 2);
  }
  const Read r = read(text);
  EXPECT_TRUE(r.issues.empty());
  for (std::size_t i = 0; i < stamps.size(); ++i) EXPECT_EQ(r.log.scans[i].stamp, stamps[i]);
}

// --- range limit

TEST(CarmenLog, RangeLimitIsWhereTheHighestReadingsPileUp) {
  std::string text = "FLASER 10 1 2 3 25.5 81.83 81.91 81.91 81.91 4 5 0 0 0 0 0 0 1 h 1\n";
  EXPECT_FLOAT_EQ(static_cast<float>(read(text).log.scans[0].range_max), 81.83F);
  text = "FLASER 6 1 2 3 25.5 4 5 0 0 0 0 0 0 1 h 1\n";
  EXPECT_GT(read(text).log.scans[0].range_max, 25.5);      // no pile: every reading is a return
  EXPECT_GT(read(flaser(1)).log.scans[0].range_max, 2.5);  // all equal and near: returns, too
  CarmenOptions options;
  options.range_max = 2.0;
  EXPECT_DOUBLE_EQ(read(text, options).log.scans[0].range_max, 2.0);
  EXPECT_GT(read("FLASER 2 0 0 0 0 0 0 0 0 1 h 1\n").log.scans[0].range_max, 0.0);
}

// --- noise

TEST(CarmenLog, RandomBytesNeverCrash) {
  Rng rng(1);
  for (int round = 0; round < 300; ++round) {
    std::string text(rng.below(4000), '\0');
    for (char& c : text) c = static_cast<char>(rng.below(256));
    try {
      read(text);
    } catch (const InputError&) {
    }
  }
}

TEST(CarmenLog, DamagedLogsNeverCrashAndStayInOrder) {
  std::string good;
  for (int i = 0; i < 30; ++i) good += odom(i, i) + flaser(i + 0.5, 20, i);
  good += "ROBOTLASER1 0 -1.5 3.0 0.1 50.0 0.1 0 3 1 2 3 0 1 2 3 1 2 3 0 0 0 0 0 1000 h 40\n";
  good += "L 1 2 3 1 2 3 5 6 7 41\nO 1 2 3 42\nNEFF 3\n";
  const std::string alphabet = "0123456789.-+eE \nFLASERODM#xninf";
  Rng rng(2);
  for (int round = 0; round < 500; ++round) {
    std::string text = good;
    for (int k = 0; k < 20; ++k) {
      const auto at = rng.below(static_cast<std::uint32_t>(text.size()));
      switch (rng.below(3)) {
        case 0:
          text[at] = alphabet[rng.below(static_cast<std::uint32_t>(alphabet.size()))];
          break;
        case 1:
          text.erase(at, rng.below(30));
          break;
        default:
          text.insert(at, 1, alphabet[rng.below(static_cast<std::uint32_t>(alphabet.size()))]);
      }
    }
    const RobotLog log = read(text).log;
    for (std::size_t i = 1; i < log.scans.size(); ++i) {
      ASSERT_GT(log.scans[i].stamp, log.scans[i - 1].stamp);
    }
    for (std::size_t i = 1; i < log.odometry.size(); ++i) {
      ASSERT_GT(log.odometry[i].stamp, log.odometry[i - 1].stamp);
      ASSERT_TRUE(log.odometry[i].pose.isFinite());
    }
  }
}

}  // namespace
}  // namespace hyselam
