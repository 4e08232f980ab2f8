// What SLAM keeps in a file: the same after as before, and nothing but that.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "hyselam_common/binary_io.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/testing/files.hpp"
#include "ngram_slam/slam/slam_engine.hpp"
#include "ngram_slam/slam/slam_state_io.hpp"

namespace {

using namespace ngram_slam;  // NOLINT: a test
using hyselam::Pose2;
using hyselam::testing::messageOf;
using hyselam::testing::TemporaryDirectory;

/// What a laser sees in a corridor of 24 m by 3 m with niches, from x metres along it.
hyselam::LaserScan corridor(double x, double stamp) {
  hyselam::LaserScan scan;
  scan.stamp = stamp;
  scan.angle_min = -hyselam::kPi / 2.0;
  scan.angle_increment = hyselam::kPi / 180.0;
  scan.range_min = 0.05;
  scan.range_max = 20.0;
  for (int i = 0; i <= 180; ++i) {
    const double a = scan.angle_min + i * scan.angle_increment;
    double r = 25.0;
    for (double t = 0.1; t < 20.0; t += 0.01) {
      const double px = x + t * std::cos(a), py = t * std::sin(a);
      const bool niche = std::fmod(px + 100.0, 6.0) < 1.0 && px < 15.0;
      if (std::abs(py) > (niche ? 2.2 : 1.5) || px > 24.0) {
        r = t;
        break;
      }
    }
    scan.ranges.push_back(static_cast<float>(r));
  }
  scan.ranges[7] = std::numeric_limits<float>::infinity();
  scan.ranges[8] = std::numeric_limits<float>::quiet_NaN();
  return scan;
}

SlamState load(const std::string& path) {
  return SlamStateFile::load(path, SlamParams{}.surface);
}

SlamEngine engineAfter(int scans) {
  SlamEngine engine;
  for (int i = 0; i < scans; ++i) {
    engine.add(corridor(0.1 * i, 100.0 + i), {0.1 * i, 0.0, 0.0});
    while (auto job = engine.takeJob()) engine.apply(runJob(*job));
  }
  return engine;
}

SlamState fullState() {
  SlamState s = engineAfter(60).state();
  // What a short path does not contain.
  SlamLoop loop;
  loop.older = 1;
  loop.newer = 5;
  loop.measured = {1.0, 0.25, -0.5};
  loop.information << 3, 1, 0, 1, 4, 0.5, 0, 0.5, 5;
  loop.source = LoopSource::kNgram;
  loop.far = true;
  loop.inlier_ratio = 0.75;
  loop.weight = 0.5;
  loop.fit = 0.6875123;
  s.loops.push_back(loop);
  loop.source = LoopSource::kProximity;
  s.pending_loops.push_back(loop);
  SlamMatch match;
  match.newer = 9;
  match.older = 3;
  match.n = 4;
  match.level = 1;
  match.direction = Direction::kReverse;
  match.probability = 0.875;
  match.keyframe_newer = 5;
  match.keyframe_older = 1;
  match.tried = match.verified = true;
  s.matches.push_back(match);
  s.counters.words.accepted = 17;
  return s;
}

void expectSame(const SlamState& a, const SlamState& b) {
  ASSERT_EQ(a.keyframes.size(), b.keyframes.size());
  for (std::size_t i = 0; i < a.keyframes.size(); ++i) {
    const SlamKeyframe &x = a.keyframes[i], &y = b.keyframes[i];
    EXPECT_EQ(x.stamp, y.stamp);
    EXPECT_EQ(x.pose.x, y.pose.x);
    EXPECT_EQ(x.odometry.theta, y.odometry.theta);
    EXPECT_EQ(x.path_length, y.path_length);
    EXPECT_EQ(x.run, y.run);
    ASSERT_EQ(x.scan->ranges.size(), y.scan->ranges.size());
    for (std::size_t k = 0; k < x.scan->ranges.size(); ++k)
      EXPECT_TRUE(x.scan->ranges[k] == y.scan->ranges[k] ||
                  (std::isnan(x.scan->ranges[k]) && std::isnan(y.scan->ranges[k])));
    ASSERT_EQ(x.points->size(), y.points->size());
    for (std::size_t k = 0; k < x.points->size(); ++k)
      EXPECT_EQ((*x.points)[k].nx, (*y.points)[k].nx);
  }
  ASSERT_EQ(a.scans.size(), b.scans.size());
  EXPECT_EQ(a.scans.back().base_in_keyframe.x, b.scans.back().base_in_keyframe.x);
  ASSERT_EQ(a.odometry.size(), b.odometry.size());
  EXPECT_EQ(a.odometry.back().information, b.odometry.back().information);
  ASSERT_EQ(a.loops.size(), b.loops.size());
  EXPECT_EQ(a.loops.back().information, b.loops.back().information);
  EXPECT_EQ(a.loops.back().fit, b.loops.back().fit);
  EXPECT_EQ(a.loops.back().source, b.loops.back().source);
  EXPECT_EQ(a.loops.back().far, b.loops.back().far);
  EXPECT_EQ(a.loops.back().weight, b.loops.back().weight);
  ASSERT_EQ(a.pending_loops.size(), b.pending_loops.size());
  ASSERT_EQ(a.matches.size(), b.matches.size());
  EXPECT_EQ(a.matches.back().direction, b.matches.back().direction);
  EXPECT_EQ(a.matches.back().probability, b.matches.back().probability);
  EXPECT_EQ(a.matches.back().verified, b.matches.back().verified);
  EXPECT_EQ(a.matches.back().accepted, b.matches.back().accepted);
  EXPECT_EQ(a.counters.words.accepted, b.counters.words.accepted);
  EXPECT_EQ(a.counters.scans, b.counters.scans);
  EXPECT_EQ(a.keyframe_of_observation, b.keyframe_of_observation);
  EXPECT_EQ(a.corpus.observations.size(), b.corpus.observations.size());
}

TEST(SlamStateFile, isTheSameAfterLoading) {
  TemporaryDirectory folder;
  const SlamState state = fullState();
  ASSERT_GT(state.keyframes.size(), 10u);
  ASSERT_GT(state.corpus.observations.size(), 10u);
  SlamStateFile::save(folder / "map.slam", state);
  expectSame(state, load(folder / "map.slam"));
  EXPECT_EQ(folder.fileCount(), 1u);
  SlamStateFile::save(folder / "again.slam", load(folder / "map.slam"));
  EXPECT_EQ(hyselam::testing::fileBytes(folder / "map.slam"),
            hyselam::testing::fileBytes(folder / "again.slam"));
}

TEST(SlamStateFile, keepsAScanWithoutALargestRange) {
  SlamEngine engine;
  hyselam::LaserScan scan = corridor(0.0, 100.0);
  scan.range_max = std::numeric_limits<double>::infinity();
  engine.add(scan, {});
  TemporaryDirectory folder;
  SlamStateFile::save(folder / "map.slam", engine.state());
  EXPECT_EQ(load(folder / "map.slam").keyframes.front().scan->range_max, scan.range_max);
}

TEST(SlamStateFile, keepsAnEmptyState) {
  TemporaryDirectory folder;
  SlamStateFile::save(folder / "map.slam", SlamState{});
  EXPECT_TRUE(load(folder / "map.slam").keyframes.empty());
}

TEST(SlamStateFile, letsSlamContinueInIt) {
  TemporaryDirectory folder;
  SlamEngine first = engineAfter(100);
  SlamStateFile::save(folder / "map.slam", first.state());
  SlamEngine second(first.params(), load(folder / "map.slam"));
  // The robot was moved half a metre while it was off, and its odometry begins at 0.
  second.startRun(first.pose(), 1.5, 0.5, RunTrust::kKnown);
  const double x = 0.1 * 99 + 0.5;
  const SlamUpdate u = second.add(corridor(x, 500.0), {0.0, 0.0, 0.0});
  EXPECT_NEAR(u.base_in_map.x, x, 0.05);
  EXPECT_NEAR(u.base_in_map.y, 0.0, 0.05);
  for (int i = 1; i < 30; ++i) second.add(corridor(x + 0.1 * i, 500.0 + i), {0.1 * i, 0.0, 0.0});
  EXPECT_NEAR(second.pose().x, x + 2.9, 0.1);
  EXPECT_EQ(second.keyframes().back().run, 1u);
}

TEST(SlamState, isRefusedWithScansThatTheEngineWouldRefuse) {
  SlamState state = engineAfter(20).state();
  EXPECT_EQ(state.error(), nullptr);
  SlamState far_laser = state;
  auto scan = std::make_shared<hyselam::LaserScan>(*state.keyframes[1].scan);
  scan->laser_in_base.x = 6.0;
  far_laser.keyframes[1].scan = scan;
  ASSERT_NE(far_laser.error(), nullptr);
  EXPECT_NE(std::string(far_laser.error()).find("5 m"), std::string::npos);
  SlamState far_away = state;
  far_away.keyframes[1].pose.x = 1e8;
  EXPECT_NE(far_away.error(), nullptr);
}

TEST(SlamStateFile, refusesAnyDamage) {
  TemporaryDirectory folder;
  SlamStateFile::save(folder / "map.slam", fullState());
  const std::string whole = hyselam::testing::fileBytes(folder / "map.slam");
  const auto refusal = [&](const std::string& bytes) {
    hyselam::testing::writeFile(folder / "bad.slam", bytes);
    return messageOf<hyselam::InputError>([&] { load(folder / "bad.slam"); });
  };
  for (std::size_t n = 0; n < whole.size(); n += n < 64 ? 1 : whole.size() / 97)
    EXPECT_NE(refusal(whole.substr(0, n)), "") << n;
  EXPECT_NE(refusal(whole.substr(0, whole.size() - 1)).find("truncated"), std::string::npos);
  EXPECT_NE(refusal(whole + "x").find("bytes instead of"), std::string::npos);
  for (std::size_t n = 0; n < whole.size(); n += whole.size() / 211) {
    std::string bad = whole;
    bad[n] = static_cast<char>(bad[n] ^ 0x10);
    EXPECT_NE(refusal(bad), "") << n;
  }
  EXPECT_NE(refusal("P5 200 100 255 ").find("is no state of SLAM"), std::string::npos);
  EXPECT_NE(refusal("").find("bad.slam"), std::string::npos);
  EXPECT_THROW(load(folder / "none.slam"), hyselam::InputError);
}

TEST(SlamStateFile, namesAnotherVersion) {
  TemporaryDirectory folder;
  SlamStateFile::save(folder / "map.slam", SlamState{});
  std::string bytes = hyselam::testing::fileBytes(folder / "map.slam");
  bytes[8] = 7;
  // Looked at before the checksum, which another version may form otherwise.
  hyselam::testing::writeFile(folder / "map.slam", bytes);
  const std::string damaged = messageOf<hyselam::InputError>([&] { load(folder / "map.slam"); });
  EXPECT_NE(damaged.find("version"), std::string::npos) << damaged;
}

TEST(SlamStateFile, readsTheFirstVersionWhoseLoopsTellNoFit) {
  TemporaryDirectory folder;
  const SlamState state = fullState();
  SlamStateFile::save(folder / "map.slam", state);
  std::string bytes = hyselam::testing::fileBytes(folder / "map.slam");
  // As it was written then: without the numbers that stand for the fit.
  const double fit = 0.6875123;
  const std::string told(reinterpret_cast<const char*>(&fit), sizeof(fit));
  std::size_t taken_out = 0;
  for (auto at = bytes.find(told); at != std::string::npos; at = bytes.find(told)) {
    bytes.erase(at, sizeof(fit));
    ++taken_out;
  }
  ASSERT_EQ(taken_out, state.loops.size() + state.pending_loops.size());
  // And without a settled map: the side of its cells, none of them.
  const double side = state.settled.cell;
  const std::string settled =
      std::string(reinterpret_cast<const char*>(&side), sizeof(side)) + std::string(4, '\0');
  ASSERT_TRUE(state.settled.cells.empty());
  const auto section = bytes.rfind(settled);
  ASSERT_NE(section, std::string::npos);
  bytes.erase(section, settled.size());
  const auto put = [&](std::size_t at, std::uint64_t value, std::size_t size) {
    for (std::size_t i = 0; i < size; ++i) bytes[at + i] = static_cast<char>(value >> 8 * i & 0xff);
  };
  put(8, 1, 4);
  put(12, bytes.size() - 28, 8);
  put(20, hyselam::checksumOf(bytes, 0, 20), 4);
  put(bytes.size() - 4, hyselam::checksumOf(bytes, 24, bytes.size() - 4), 4);
  hyselam::testing::writeFile(folder / "old.slam", bytes);
  const SlamState old = load(folder / "old.slam");
  ASSERT_EQ(old.loops.size(), state.loops.size());
  EXPECT_EQ(old.loops.back().fit, 0.85);
  EXPECT_EQ(old.loops.back().weight, state.loops.back().weight);
  EXPECT_EQ(old.pending_loops.back().inlier_ratio, state.pending_loops.back().inlier_ratio);
  EXPECT_EQ(old.matches.size(), state.matches.size());
}

TEST(SlamStateFile, refusesPartsThatDoNotFit) {
  TemporaryDirectory folder;
  for (int part = 0; part < 6; ++part) {
    SlamState s = fullState();
    if (part == 0) s.loops.back().newer = 1000;
    if (part == 1) s.scans.back().keyframe = -1;
    if (part == 2) s.keyframe_of_observation.pop_back();
    if (part == 3) s.keyframes[3].pose.x = std::nan("");
    if (part == 4) s.matches.back().newer = 1000000;
    if (part == 5) s.matches.back().keyframe_older = -1;
    SlamStateFile::save(folder / "map.slam", s);
    EXPECT_NE(messageOf<hyselam::InputError>([&] { load(folder / "map.slam"); }), "") << part;
  }
}

TEST(SlamStateFile, keepsTheOldFileWhenSavingFails) {
  TemporaryDirectory folder;
  EXPECT_THROW(SlamStateFile::save(folder / "no/such/folder/map.slam", SlamState{}),
               hyselam::InputError);
}

}  // namespace
