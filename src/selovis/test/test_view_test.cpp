// The sequential test of a pose by views and scans, and what it is made of: learned views by pose,
// the fit of a scan, the memory of errors.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/rng.hpp"
#include "selovis/recognition/view_test.hpp"

namespace selovis {
namespace {

using hyselam::Pose2;

/// A corridor of 30 m, learned there and back, a frame each half metre; a place each 10 m.
Samples corridor() {
  Samples samples;
  samples.size = 1;
  const float nothing = 0.0f;
  int frame = 0;
  for (const double heading : {0.0, hyselam::kPi}) {
    for (int i = 0; i <= 60; ++i) {
      const double x = 0.5 * i;
      samples.add(&nothing, std::min(2, static_cast<int>(x / 10.0)), frame++, {x, 0.0, heading});
    }
  }
  return samples;
}

/// Squared distances of a frame taken at `camera` to the samples: views look alike as they are
/// near.
std::vector<float> distancesFrom(const Samples& samples, const Pose2& camera) {
  std::vector<float> out;
  for (const Pose2& p : samples.poses) {
    const double turn = hyselam::normalizeAngle(p.theta - camera.theta) / 0.3;
    const double d = hyselam::distance(p, camera);
    out.push_back(static_cast<float>(1.0 + std::min(4.0, d * d + turn * turn)));
  }
  return out;
}

struct Drive {
  explicit Drive(const ViewTestParams& params = {}) : samples(corridor()), test(samples, params) {}
  /// One frame seen at `truth` while the robot is believed at `base`.
  ViewTestState look(const Pose2& truth, const std::optional<Pose2>& base, double seconds = 0.2) {
    const std::vector<float> distances = distancesFrom(samples, truth);
    ViewTestFrame frame;
    frame.distances = &distances;
    frame.seconds = seconds;
    frame.base = base;
    frame.scan = scan;
    return test.update(frame);
  }
  Samples samples;
  ViewTest test;
  const ScanPoints* scan = nullptr;
};

TEST(LearnedViews, RegressionIsThatOfAllViews) {
  Samples samples = corridor();
  hyselam::Rng rng(1);
  for (Pose2& p : samples.poses) {  // anywhere
    p = {rng.uniform(-9.0, 9.0), rng.uniform(-9.0, 9.0), rng.uniform(-3.0, 3.0)};
  }
  samples.poses[7] = kNoPose;
  const double radius = 2.0, angle = 0.5, beta = 1.5;
  LearnedViews views(samples, radius, angle);
  const std::vector<float> distances = distancesFrom(samples, {0.0, 0.0, 0.0});
  views.compare(distances, beta);
  float least = std::numeric_limits<float>::infinity();
  for (std::size_t i = 0; i < samples.count(); ++i) {
    if (samples.poses[i].isFinite()) least = std::min(least, distances[i]);
  }
  int known = 0;
  for (int k = 0; k < 300; ++k) {
    const Pose2 at{rng.uniform(-11.0, 11.0), rng.uniform(-11.0, 11.0), rng.uniform(-3.2, 3.2)};
    double weight = 0.0, sum = 0.0;
    for (std::size_t i = 0; i < samples.count(); ++i) {
      if (!samples.poses[i].isFinite()) continue;
      const double r = hyselam::distance(samples.poses[i], at) / radius;
      const double phi = hyselam::normalizeAngle(samples.poses[i].theta - at.theta) / angle;
      if (r >= 1.0 || std::abs(phi) >= 1.0) continue;
      const double kernel = std::pow((1.0 - r * r) * (1.0 - phi * phi), 2.0);
      weight += kernel;
      sum += kernel * std::exp(-beta * (distances[i] - least) / least);
    }
    const LearnedViews::Regression seen = views.at(at);
    EXPECT_NEAR(seen.weight, weight, 1e-9);
    EXPECT_NEAR(seen.sum, sum, 1e-6);
    known += weight > 0.0;
  }
  EXPECT_GT(known, 20);
  EXPECT_EQ(views.at({1e12, 0.0, 0.0}).place, -1);
  EXPECT_THROW(views.compare({1.0f}, beta), hyselam::InputError);
}

/// Ordering all views is the oracle.
TEST(LearnedViews, MostSimilarOnesAreThoseOfAllViewsInOrder) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    hyselam::Rng rng(seed);
    Samples samples;
    samples.size = 1;
    const float nothing = 0.0f;
    std::vector<float> distances;
    for (int i = 0; i < 3000; ++i) {
      const Pose2 pose{rng.uniform(-9.0, 9.0), rng.uniform(-9.0, 9.0), rng.uniform(-3.0, 3.0)};
      samples.add(&nothing, 0, i / 5, i % 7 == 0 ? kNoPose : pose);
      // Many are equally far.
      distances.push_back(static_cast<float>(1.0 + 0.02 * rng.below(200)));
    }
    LearnedViews views(samples, 2.0, 0.5);
    views.compare(distances, 1.5);
    int asked = 0;
    const double wall = rng.uniform(-9.0, 9.0);
    const auto wanted = [&](const LearnedViews::View& v) {
      ++asked;
      return views.poseOf(v).x > wall;
    };
    std::vector<std::uint32_t> all, found;
    for (std::uint32_t v = 0; v < views.views().size(); ++v) {
      if (wanted(views.views()[v])) all.push_back(v);
    }
    std::stable_sort(all.begin(), all.end(), [&](std::uint32_t a, std::uint32_t b) {
      return views.similarity(views.views()[a]) > views.similarity(views.views()[b]);
    });
    for (const std::size_t count : {0u, 1u, 40u, 5000u}) {
      asked = 0;
      views.mostSimilar(count, wanted, &found);
      ASSERT_EQ(found, std::vector<std::uint32_t>(
                           all.begin(),
                           all.begin() + static_cast<std::ptrdiff_t>(std::min(count, all.size()))))
          << seed << ' ' << count;
      if (count == 40 && wall < 0.0) {
        EXPECT_LT(asked, 1000) << "few views are asked for";
      }
    }
  }
}

/// A room of 6 x 4 m with a pillar, cells of 0.1 m, and what a laser in it returns.
hyselam::OccupancyGrid room() {
  hyselam::GridGeometry g;
  g.width = 80;
  g.height = 60;
  g.origin = {-1.0, -1.0, 0.1};
  hyselam::OccupancyGrid map(g, hyselam::OccupancyGrid::kFree);
  for (int x = 10; x < 70; ++x) map.at({x, 10}) = map.at({x, 49}) = 100;
  for (int y = 10; y < 50; ++y) map.at({10, y}) = map.at({69, y}) = 100;
  for (int y = 25; y < 30; ++y) map.at({30, y}) = 100;
  return map;
}

ScanPoints seenFrom(const hyselam::OccupancyGrid& map, const Pose2& base) {
  ScanPoints points;
  for (int k = 0; k < 60; ++k) {
    const double bearing = 2.0 * hyselam::kPi * k / 60.0;
    for (double r = 0.05; r < 9.0; r += 0.02) {
      const hyselam::Point2 p{r * std::cos(bearing), r * std::sin(bearing)};
      if (map.valueOr(map.geometry.cellAt(base * p)) != 100) continue;
      points.push_back(p);
      break;
    }
  }
  return points;
}

TEST(ScanFit, IsTheLikelihoodOfTheNearestObstacle) {
  const hyselam::OccupancyGrid map = room();
  const ScanFit fit(map);
  hyselam::Rng rng(2);
  for (int k = 0; k < 100; ++k) {
    const hyselam::Point2 point{rng.uniform(-2.0, 9.0), rng.uniform(-2.0, 7.0)};
    const hyselam::Cell cell = map.geometry.cellAt(point);
    double nearest2 = 1e9;
    for (int y = 0; y < map.geometry.height; ++y) {
      for (int x = 0; x < map.geometry.width; ++x) {
        if (map.at({x, y}) < ScanFit::kOccupiedFrom) continue;
        const double dx = x - cell.x, dy = y - cell.y;
        nearest2 = std::min(nearest2, 0.01 * (dx * dx + dy * dy));
      }
    }
    const double expected =
        map.geometry.contains(cell)
            ? std::log((1.0 - ScanFit::kAnything) *
                           std::exp(-0.5 * nearest2 / (ScanFit::kSigma * ScanFit::kSigma)) +
                       ScanFit::kAnything)
            : std::log(ScanFit::kAnything);
    EXPECT_NEAR(fit.at({point}, Pose2{}), expected, 1e-4);
  }
  EXPECT_EQ(fit.at({}, Pose2{}), std::log(ScanFit::kAnything));
  hyselam::OccupancyGrid broken = map;
  broken.cells.pop_back();
  EXPECT_THROW(ScanFit{broken}, hyselam::InputError);
}

TEST(ScanFit, FindsThePoseThatAScanWasTakenAt) {
  const hyselam::OccupancyGrid map = room();
  const ScanFit fit(map);
  hyselam::Rng rng(3);
  for (int k = 0; k < 20; ++k) {
    const Pose2 truth{rng.uniform(1.0, 4.5), rng.uniform(1.0, 2.5), rng.uniform(-3.0, 3.0)};
    const ScanPoints points = seenFrom(map, truth);
    const Pose2 guess{truth.x + rng.uniform(-0.8, 0.8), truth.y + rng.uniform(-0.8, 0.8),
                      hyselam::normalizeAngle(truth.theta + rng.uniform(-0.25, 0.25))};
    const FittedPose found = fit.best(points, guess, 1.0, 0.35);
    EXPECT_LT(hyselam::distance(found.base, truth), 0.15) << k;
    EXPECT_LT(std::abs(hyselam::normalizeAngle(found.base.theta - truth.theta)), 0.06) << k;
    EXPECT_GT(found.fit, -0.4);
    EXPECT_LE(fit.at(points, guess), found.fit);
    EXPECT_NEAR(fit.at(points, found.base), found.fit, 1e-12);
  }
}

TEST(ScanFit, PointsAreTheReturnsInTheFrameOfTheBase) {
  hyselam::LaserScan scan;
  scan.angle_min = -0.5 * hyselam::kPi;
  scan.angle_increment = 0.5 * hyselam::kPi;
  scan.range_min = 0.1;
  scan.range_max = 8.0;
  scan.ranges = {1.0f, 8.0f, std::numeric_limits<float>::quiet_NaN()};
  scan.laser_in_base = {0.5, 0.0, 0.0};
  const ScanPoints points = scanPoints(scan);
  ASSERT_EQ(points.size(), 1u);
  EXPECT_NEAR(points[0].x, 0.5, 1e-6);
  EXPECT_NEAR(points[0].y, -1.0, 1e-6);
  scan.angle_increment = 0.01;
  scan.ranges.assign(181, 2.0f);
  EXPECT_EQ(scanPoints(scan, 60).size(), 60u);
}

TEST(ReliabilityMemory, ASecondErrorOfTheSameKindIsExpected) {
  ReliabilityMemory memory;
  const Pose2 door{3.4, -2.2, 1.0};
  EXPECT_EQ(memory.errorRate(door, 5), ReliabilityMemory::kPriorErrors);
  const Pose2 away{9.0, 9.0, 0.0};
  const auto visit = [&](int place) {
    for (int i = 0; i < 5; ++i) {
      memory.add(door, place < 0 ? std::vector<int>{} : std::vector<int>{place}, 0.5);
    }
    memory.add(away, {}, 0.5);
  };
  visit(5);
  EXPECT_GT(memory.errorRate({3.6, -2.8, 1.1}, 5), 0.3) << "in the same cell";
  EXPECT_LT(memory.errorRate(door, 4), ReliabilityMemory::kPriorErrors);
  EXPECT_EQ(memory.errorRate({3.4, -2.2, -2.0}, 5), ReliabilityMemory::kPriorErrors);
  for (int i = 0; i < 50; ++i) visit(-1);
  EXPECT_LT(memory.errorRate(door, 5), 0.03) << "it is right most of the times";
  EXPECT_EQ(memory.size(), 2u);
}

TEST(ReliabilityMemory, IsReadBackFromBytesAndOthersAreRefused) {
  ReliabilityMemory memory;
  hyselam::Rng rng(3);
  std::vector<Pose2> poses;
  for (int i = 0; i < 300; ++i) {
    poses.push_back({rng.uniform(-5.0, 5.0), rng.uniform(-5.0, 5.0), rng.uniform(-3.0, 3.0)});
    memory.add(poses.back(), {static_cast<int>(rng.below(4))}, rng.uniform());
  }
  const std::string bytes = memory.toBytes();
  const ReliabilityMemory again = ReliabilityMemory::fromBytes(bytes, 4);
  EXPECT_EQ(again.size(), memory.size());
  EXPECT_EQ(again.toBytes(), bytes);
  int errors = 0;
  for (const Pose2& pose : poses) {
    for (int place = 0; place < 4; ++place) {
      EXPECT_EQ(again.errorRate(pose, place), memory.errorRate(pose, place));
      errors += memory.errorRate(pose, place) > 0.3;
    }
  }
  EXPECT_GT(errors, 20);
  EXPECT_THROW(ReliabilityMemory::fromBytes(bytes, 3), hyselam::InputError) << "an unknown place";
  EXPECT_THROW(ReliabilityMemory::fromBytes(bytes + "x", 4), hyselam::InputError);
  for (std::size_t cut = 0; cut < bytes.size(); cut += 7) {
    EXPECT_THROW(ReliabilityMemory::fromBytes(bytes.substr(0, cut), 4), hyselam::InputError) << cut;
  }
  std::string bad = bytes;
  bad[16] = 9;  // the first pose's heading
  EXPECT_THROW(ReliabilityMemory::fromBytes(bad, 4), hyselam::InputError);
  bad = bytes;
  std::fill(bad.begin() + 20, bad.begin() + 28, '\xff');  // its visits: no number
  EXPECT_THROW(ReliabilityMemory::fromBytes(bad, 4), hyselam::InputError);
}

TEST(ViewTest, ARightPoseRaisesNoEvidence) {
  Drive drive;
  for (int i = 0; i < 600; ++i) {
    const Pose2 at{0.05 * i, 0.1, 0.02};
    const ViewTestState state = drive.look(at, at);
    EXPECT_TRUE(state.tested);
    EXPECT_LT(state.evidence, 1.0) << i;
  }
}

TEST(ViewTest, AWrongPoseIsNoticedAndTheRivalIsWhereTheRobotIs) {
  Drive drive;
  ViewTestState state;
  double seconds = 0.0;
  for (int i = 0; state.evidence < drive.test.threshold(); ++i) {
    const double way = 0.02 * i;
    state = drive.look({20.0 + way, 0.0, 0.0}, Pose2{3.0 + way, 0.0, 0.0});
    seconds += 0.2;
    ASSERT_LT(seconds, 10.0);
  }
  EXPECT_GT(seconds, 0.5) << "no single look is enough";
  ASSERT_TRUE(state.rival);
  EXPECT_NEAR(state.rival->base.x, 20.0 + 0.1 * seconds, 1.0);
  EXPECT_EQ(state.rival->place, 2);
}

TEST(ViewTest, EvidenceIsGatheredInTimeNotByFrames) {
  const auto secondsAt = [](double rate) {
    Drive drive;
    for (int i = 1; i < 10000; ++i) {
      const ViewTestState state = drive.look({20.0, 0.0, 0.0}, Pose2{3.0, 0.0, 0.0}, 1.0 / rate);
      if (state.evidence >= drive.test.threshold()) return i / rate;
    }
    return 1e9;
  };
  const double slow = secondsAt(5.0), fast = secondsAt(30.0);
  EXPECT_NEAR(slow, fast, 0.21);
  EXPECT_GT(secondsAt(1.0), slow - 1e-9) << "a look counts once";
}

TEST(ViewTest, WhatWasNeverLearnedFromThereIsNoEvidence) {
  Drive drive;
  for (int i = 0; i < 100; ++i) {  // looks at the wall, which nobody did; it looks like elsewhere
    const ViewTestState state = drive.look({20.0, 0.0, 0.0}, Pose2{3.0, 0.0, 0.5 * hyselam::kPi});
    EXPECT_EQ(state.coverage, 0.0);
    EXPECT_EQ(state.evidence, 0.0);
  }
  EXPECT_FALSE(drive.look({20.0, 0.0, 0.0}, {}).tested) << "no pose";
}

TEST(ViewTest, ErrorsThatDoNotMoveWithTheRobotDoNotAddUp) {
  // The robot drives; now and then a frame looks like some other view, another one each time.
  Drive drive;
  hyselam::Rng rng(4);
  for (int i = 0; i < 1500; ++i) {
    const Pose2 at{0.02 * i, 0.0, 0.0};
    const Pose2 seen = i % 3 == 0 ? Pose2{rng.uniform(0.0, 30.0), 0.0, hyselam::kPi} : at;
    EXPECT_LT(drive.look(seen, at).evidence, drive.test.threshold()) << i;
  }
}

TEST(ViewTest, WhereTheCameraErredItIsBelievedLessTheNextTime) {
  ViewTestParams params;
  params.proven_after = 5.0;
  const auto evidenceOfSecondError = [&](bool remember) {
    params.remember = remember;
    Drive drive(params);
    double most = 0.0;
    for (int visit = 0; visit < 2; ++visit) {
      most = 0.0;
      for (int i = 0; i < 10; ++i) {
        most = std::max(most, drive.look({20.0, 0.0, 0.0}, Pose2{3.0, 0.0, 0.0}).evidence);
      }
      for (int i = 0; i < 50; ++i) drive.look({3.0, 0.0, 0.0}, Pose2{3.0, 0.0, 0.0});
      for (int i = 0; i < 50; ++i) drive.look({6.0, 0.0, 0.0}, Pose2{6.0, 0.0, 0.0});
    }
    return most;
  };
  const double with = evidenceOfSecondError(true), without = evidenceOfSecondError(false);
  EXPECT_GT(without, 3.0);
  EXPECT_LT(with, 0.5 * without);
}

TEST(ViewTest, AScanThatFitsThePoseOutweighsTheCamera) {
  Drive drive;
  // Walls about x = 3 only: the scan was taken there.
  hyselam::GridGeometry g;
  g.width = 340;
  g.height = 60;
  g.origin = {-2.0, -3.0, 0.0};
  hyselam::OccupancyGrid map(g, hyselam::OccupancyGrid::kFree);
  for (int x = 20; x < 80; ++x) map.at({x, 12}) = map.at({x, 45}) = 100;
  for (int y = 12; y < 46; ++y) map.at({20, y}) = map.at({79, y}) = 100;
  drive.test.setMap(std::make_shared<const ScanFit>(map));
  const Pose2 base{3.0, 0.0, 0.0};
  const ScanPoints points = seenFrom(map, base);
  drive.scan = &points;
  for (int i = 0; i < 50; ++i) {
    EXPECT_LT(drive.look({20.0, 0.0, 0.0}, base).evidence, 1.0);
  }
  // The other way about it is noticed sooner than without the scan.
  int with = 0, without = 0;
  Drive blind;
  while (drive.look({3.0, 0.0, 0.0}, Pose2{20.0, 0.0, 0.0}).evidence < drive.test.threshold()) {
    ASSERT_LT(++with, 50);
  }
  while (blind.look({3.0, 0.0, 0.0}, Pose2{20.0, 0.0, 0.0}).evidence < blind.test.threshold()) {
    ASSERT_LT(++without, 50);
  }
  EXPECT_LE(with, without);
}

TEST(ViewTest, MoreHoursBetweenFalseAlarmsNeedMoreEvidence) {
  double before = 0.0;
  for (const double hours : {0.1, 1.0, 10.0, 100.0}) {
    const double threshold = ViewTest::thresholdFor(hours, 0.4);
    EXPECT_GT(threshold, before);
    before = threshold;
  }
}

}  // namespace
}  // namespace selovis
