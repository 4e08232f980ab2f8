// Surfaces, their map, refinement and search, in rooms whose walls are known.
#include <gtest/gtest.h>

#include <cmath>
#include <deque>
#include <limits>
#include <utility>
#include <vector>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/rng.hpp"
#include "hyselam_scan_matching/correlative_matcher.hpp"
#include "hyselam_scan_matching/icp.hpp"
#include "hyselam_scan_matching/scan_odometry.hpp"

namespace {

using namespace hyselam_scan_matching;  // NOLINT: a test
using hyselam::Pose2;

/// A room of 8 x 5 m with a pillar, the origin at a corner; what a laser all round sees from
/// `pose`.
hyselam::LaserScan roomScan(const Pose2& pose) {
  struct Box {
    double x0, y0, x1, y1;
  };
  const Box boxes[] = {{0, 0, 8, 5}, {5, 1, 5.6, 1.9}};
  hyselam::LaserScan scan;
  scan.angle_min = -hyselam::kPi;
  scan.angle_increment = hyselam::kPi / 180.0;
  scan.range_min = 0.01;
  scan.range_max = 50.0;
  for (int i = 0; i < 360; ++i) {
    const double a = pose.theta + scan.angle_min + i * scan.angle_increment;
    const double c = std::cos(a), s = std::sin(a);
    double best = 50.0;
    for (const Box& b : boxes) {
      for (const double x : {b.x0, b.x1}) {
        const double t = (x - pose.x) / c, y = pose.y + t * s;
        if (t > 1e-9 && t < best && y >= b.y0 && y <= b.y1) best = t;
      }
      for (const double y : {b.y0, b.y1}) {
        const double t = (y - pose.y) / s, x = pose.x + t * c;
        if (t > 1e-9 && t < best && x >= b.x0 && x <= b.x1) best = t;
      }
    }
    scan.ranges.push_back(static_cast<float>(best));
  }
  return scan;
}

SurfaceMap roomMap() {
  SurfaceMap map;
  for (const Pose2& p : {Pose2{2, 2, 0}, Pose2{6.5, 3, 1}, Pose2{7, 1, 2}, Pose2{3, 4, -1}})
    map.insert(p, surfacePoints(roomScan(p)));
  map.finish();
  return map;
}

TEST(SurfacePoints, NormalsFaceTheLaser) {
  const Pose2 at{3, 2, 0.3};
  const SurfacePoints points = transformed(at, surfacePoints(roomScan(at)));
  ASSERT_GT(points.size(), 100u);
  int told = 0;
  for (const SurfacePoint& p : points) {
    if (!p.hasNormal()) continue;
    ++told;
    EXPECT_GT(p.nx * (at.x - p.x) + p.ny * (at.y - p.y), 0.0);
    if (p.y < 1e-3 && p.x > 0.5 && p.x < 4.5) {
      EXPECT_NEAR(p.ny, 1.0, 1e-3);
    }
  }
  EXPECT_GT(told, 80);
}

TEST(SurfacePoints, InvalidReadingsAreLeftOut) {
  hyselam::LaserScan scan = roomScan({3, 2, 0});
  for (std::size_t i = 0; i < scan.ranges.size(); i += 4)
    scan.ranges[i] = std::numeric_limits<float>::quiet_NaN();
  for (std::size_t i = 1; i < scan.ranges.size(); i += 4)
    scan.ranges[i] = std::numeric_limits<float>::infinity();
  for (const SurfacePoint& p : surfacePoints(scan))
    EXPECT_TRUE(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.nx));
  scan.ranges.clear();
  EXPECT_TRUE(surfacePoints(scan).empty());
}

TEST(SurfaceMap, NearestEqualsExhaustiveSearch) {
  const SurfaceMap map = roomMap();
  hyselam::Rng rng(1);
  for (int k = 0; k < 5000; ++k) {
    SurfacePoint p{10.0 * rng.uniform() - 1.0, 7.0 * rng.uniform() - 1.0, 0.0, 0.0};
    const double a = 6.3 * rng.uniform(), radius = 0.05 + rng.uniform();
    p.nx = std::cos(a);
    p.ny = std::sin(a);
    double best = radius * radius;
    for (const SurfacePoint& q : map.points()) {
      if (p.nx * q.nx + p.ny * q.ny < 0.0) continue;
      best = std::min(best, (p.x - q.x) * (p.x - q.x) + (p.y - q.y) * (p.y - q.y));
    }
    const SurfacePoint* found = map.nearest(p, radius);
    if (best >= radius * radius) {
      EXPECT_EQ(found, nullptr);
      continue;
    }
    ASSERT_NE(found, nullptr);
    EXPECT_DOUBLE_EQ(std::pow(p.x - found->x, 2) + std::pow(p.y - found->y, 2), best);
  }
}

TEST(SurfaceMap, AMapThatWasDroppedFromEqualsOneWithoutWhatWasDropped) {
  hyselam::Rng rng(5);
  std::deque<std::pair<Pose2, SurfacePoints>> kept;
  SurfaceMap map(0.1);
  for (int k = 0; k < 60; ++k) {
    const Pose2 pose{0.3 * rng.uniform(), 0.3 * rng.uniform(), 6.0 * rng.uniform()};
    SurfacePoints points;  // crowded, so that cells hold many; sometimes none
    for (int i = 0; i < 40 * (k % 5); ++i) {
      const double a = 6.3 * rng.uniform();
      points.push_back({rng.uniform(), rng.uniform(), std::cos(a), std::sin(a)});
    }
    map.insert(pose, points);
    kept.emplace_back(pose, points);
    while (kept.size() > 7 || (k == 40 && !kept.empty())) {
      map.dropOldest();
      kept.pop_front();
    }
    if (k % 3 == 1) continue;  // several at once
    map.finish();
    SurfaceMap fresh(0.1);
    for (const auto& [p, seen] : kept) fresh.insert(p, seen);
    fresh.finish();
    ASSERT_EQ(map.size(), fresh.size()) << k;
    for (std::size_t i = 0; i < map.size(); ++i) {
      const SurfacePoint &a = map.points()[i], &b = fresh.points()[i];
      ASSERT_TRUE(a.x == b.x && a.y == b.y && a.nx == b.nx && a.ny == b.ny) << k;
    }
  }
  SurfaceMap empty;
  empty.dropOldest();
  empty.finish();
  EXPECT_TRUE(empty.empty());
}

TEST(SurfaceMap, EmptyMapsAndFarPointsAreHandled) {
  SurfaceMap map;
  map.finish();
  EXPECT_EQ(map.nearest({0, 0, 0, 0}, 1.0), nullptr);
  map.insert({}, {{0, 0, 1, 0}, {1e9, 0, 1, 0}, {std::nan(""), 0, 1, 0}});
  map.finish();
  EXPECT_EQ(map.size(), 1u);
  EXPECT_THROW(SurfaceMap(0.0), hyselam::ParameterError);
}

TEST(Icp, FindsThePoseFromGuessesNearby) {
  const SurfaceMap map = roomMap();
  hyselam::Rng rng(3);
  for (int k = 0; k < 100; ++k) {
    const Pose2 truth{1.0 + 3.0 * rng.uniform(), 1.0 + 3.0 * rng.uniform(), 6.0 * rng.uniform()};
    const Pose2 guess = truth * Pose2{0.3 * rng.uniform() - 0.15, 0.3 * rng.uniform() - 0.15,
                                      0.2 * rng.uniform() - 0.1};
    const IcpResult r = alignIcp(surfacePoints(roomScan(truth)), map, guess);
    EXPECT_LT(distance(r.pose, truth), 0.01) << k;
    EXPECT_LT(std::abs(hyselam::normalizeAngle(r.pose.theta - truth.theta)), 0.005) << k;
    EXPECT_GT(r.matched, 0.8);
    EXPECT_TRUE((r.information - r.information.transpose()).norm() < 1e-9 * r.information.norm());
  }
}

TEST(Icp, ABareCorridorGivesNoInformationAlongIt) {
  SurfaceMap map;
  SurfacePoints walls;
  for (int i = -200; i <= 200; ++i) {
    walls.push_back({i * 0.05, 1.0, 0.0, -1.0});
    walls.push_back({i * 0.05, -1.0, 0.0, 1.0});
  }
  map.insert({}, walls);
  map.finish();
  SurfacePoints seen;
  for (const SurfacePoint& p : walls)
    if (std::abs(p.x) < 4.0) seen.push_back(p);
  Eigen::Matrix3d odometry = Eigen::Vector3d(100, 100, 100).asDiagonal();
  const IcpResult r = alignIcp(seen, map, {0.4, 0.1, 0.02}, odometry);
  EXPECT_NEAR(r.pose.x, 0.4, 0.02);  // odometry's word counts
  EXPECT_NEAR(r.pose.y, 0.0, 0.005);
  EXPECT_NEAR(r.pose.theta, 0.0, 0.002);
  EXPECT_LT(r.information(0, 0), 1e-3 * r.information(1, 1));
}

TEST(Icp, CostTellsTheRightPoseFromAnotherOneThatFits) {
  const SurfaceMap map = roomMap();
  const Pose2 truth{2.5, 2.0, 0.3};
  const SurfacePoints scan = surfacePoints(roomScan(truth));
  const Pose2 guess = truth * Pose2{0.9, 0.3, 0.5};  // too far for the iteration
  const Eigen::Matrix3d odometry = Eigen::Vector3d(1, 1, 1).asDiagonal();
  const IcpResult there = alignIcp(scan, map, guess, odometry);
  const IcpResult right = alignIcpFrom(truth * Pose2{0.05, 0.05, 0.03}, scan, map, guess, odometry);
  EXPECT_LT(distance(right.pose, truth), 0.01);
  EXPECT_GT(distance(there.pose, truth), 0.1);
  EXPECT_LT(right.cost, there.cost);
  EXPECT_GE(right.cost, 0.0);
  // Where the iteration begins is no prior: it ends at the same pose as from the guess.
  const Pose2 near = truth * Pose2{0.05, 0.05, 0.03};
  const IcpResult a = alignIcp(scan, map, near, odometry);
  const IcpResult b = alignIcpFrom(truth, scan, map, near, odometry);
  EXPECT_LT(distance(a.pose, b.pose), 1e-3);
}

TEST(Icp, ReturnsTheGuessWithoutAnythingToMatch) {
  const IcpResult a = alignIcp({}, roomMap(), {1, 2, 3});
  SurfaceMap nothing;
  nothing.finish();
  const IcpResult b = alignIcp(surfacePoints(roomScan({3, 2, 0})), nothing, {1, 2, 3});
  for (const IcpResult* r : {&a, &b}) {
    EXPECT_EQ(r->pose.y, 2.0);
    EXPECT_EQ(r->matched, 0.0);
  }
  IcpParams bad;
  bad.final_distance = 1.0;
  EXPECT_THROW(bad.validate(), hyselam::ParameterError);
}

/// The score of every pose of the window, one by one.
double bestOfAllPoses(const SurfaceMap& map, const SurfacePoints& scan, const Pose2& guess,
                      CorrelativeMatcherParams params) {
  params.linear_window = params.resolution;  // a window of a cell each way ...
  const double window = 0.4, turn = params.angular_window;
  params.angular_window = 0.0;
  double far = 1.0;
  for (const SurfacePoint& p : scan) far = std::max(far, std::hypot(p.x, p.y));
  const double step = std::max(params.resolution / far, 0.002);
  const int turns = static_cast<int>(std::ceil(turn / step));
  const int cells = static_cast<int>(std::ceil(window / params.resolution));
  params.min_score = 0.0;
  const CorrelativeMatcher grid(map, params);
  double best = 0.0;
  for (int t = -turns; t <= turns; ++t)
    for (int y = -cells + 1; y < cells; ++y)
      for (int x = -cells + 1; x < cells; ++x) {
        // ... around each pose of the larger one.
        const auto f = grid.match(scan, {guess.x + x * params.resolution,
                                         guess.y + y * params.resolution, guess.theta + t * step});
        if (f) best = std::max(best, f->score);
      }
  return best;
}

TEST(CorrelativeMatcher, EqualsExhaustiveSearch) {
  const SurfaceMap map = roomMap();
  hyselam::Rng rng(9);
  for (int k = 0; k < 3; ++k) {
    const Pose2 truth{2.0 + rng.uniform(), 2.0 + rng.uniform(), rng.uniform()};
    SurfacePoints scan = surfacePoints(roomScan(truth));
    SurfacePoints few;
    for (std::size_t i = 0; i < scan.size(); i += 8) few.push_back(scan[i]);
    CorrelativeMatcherParams params;
    params.linear_window = 0.4;
    params.angular_window = 0.05;
    params.min_score = 0.0;
    const Pose2 guess = truth * Pose2{0.2, -0.1, 0.03};
    const auto found = CorrelativeMatcher(map, params).match(few, guess);
    ASSERT_TRUE(found.has_value());
    EXPECT_NEAR(found->score, bestOfAllPoses(map, few, guess, params), 0.004) << k;
  }
}

/// The plain search: a score for each cell, each pose of the window one by one. The best sum of
/// those that are farther than `min_distance` from `best`, which may be null.
int plainBestSum(const SurfaceMap& map, const SurfacePoints& scan, const Pose2& guess,
                 const CorrelativeMatcherParams& p, const Pose2* best, double min_distance) {
  const double r = p.resolution;
  double x0 = map.points()[0].x, y0 = map.points()[0].y, far = 1.0;
  for (const SurfacePoint& q : map.points()) {
    x0 = std::min(x0, q.x);
    y0 = std::min(y0, q.y);
  }
  x0 -= p.max_distance + r;
  y0 -= p.max_distance + r;
  for (const SurfacePoint& q : scan) far = std::max(far, std::hypot(q.x, q.y));
  constexpr int kSide = 400;
  std::vector<int> score(std::size_t{kSide} * kSide, 0);
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      int& cell = score[static_cast<std::size_t>(y * kSide + x)];
      for (const SurfacePoint& q : map.points()) {
        const double dx = x0 + (x + 0.5) * r - q.x, dy = y0 + (y + 0.5) * r - q.y;
        const double part = 2.0 * (dx * dx + dy * dy) / (p.max_distance * p.max_distance);
        if (part < 2.0)
          cell = std::max(cell, static_cast<int>(0.5 + 255.0 * std::exp(-2.0 * part)));
      }
    }
  }
  const double step = std::max(r / far, 0.002);
  const int turns = static_cast<int>(std::ceil(p.angular_window / step));
  const int cells = static_cast<int>(std::ceil(p.linear_window / r));
  int largest = -1;
  for (int t = -turns; t <= turns; ++t) {
    const double c = std::cos(guess.theta + t * step), s = std::sin(guess.theta + t * step);
    for (int dy = -cells; dy <= cells; ++dy) {
      for (int dx = -cells; dx <= cells; ++dx) {
        if (best != nullptr && std::hypot(dx - (best->x - guess.x) / r,
                                          dy - (best->y - guess.y) / r) <= min_distance / r) {
          continue;
        }
        int sum = 0;
        for (const SurfacePoint& q : scan) {
          const int x = dx + static_cast<int>(std::floor((guess.x + c * q.x - s * q.y - x0) / r));
          const int y = dy + static_cast<int>(std::floor((guess.y + s * q.x + c * q.y - y0) / r));
          if (x >= 0 && y >= 0 && x < kSide && y < kSide) {
            sum += score[static_cast<std::size_t>(y * kSide + x)];
          }
        }
        largest = std::max(largest, sum);
      }
    }
  }
  return largest;
}

TEST(CorrelativeMatcher, FindsTheScoreOfThePlainSearchAlsoBesideTheMap) {
  SurfaceMap map;  // coarse, the plain search is slow
  map.insert({2, 2, 0}, surfacePoints(roomScan({2, 2, 0})));
  map.finish();
  hyselam::Rng rng(4);
  for (int k = 0; k < 4; ++k) {
    const Pose2 truth{1.5 + 3.0 * rng.uniform(), 1.0 + 3.0 * rng.uniform(), 6.0 * rng.uniform()};
    const SurfacePoints scan = surfacePoints(roomScan(truth));
    SurfacePoints few;
    for (std::size_t i = 0; i < scan.size(); i += 5) few.push_back(scan[i]);
    CorrelativeMatcherParams params;
    params.resolution = k % 2 == 0 ? 0.1 : 0.07;
    params.max_distance = 0.3;
    params.linear_window = 0.5 + 0.6 * k;  // of one level of squares to five
    params.angular_window = 0.06;
    params.min_score = 0.0;
    // Half of the scan is beyond the border.
    const Pose2 guess = truth * Pose2{k == 3 ? 6.0 : 0.2, -0.1, 0.03};
    const CorrelativeMatcher matcher(map, params);
    const double full = 255.0 * static_cast<double>(few.size());
    const auto found = matcher.match(few, guess);
    ASSERT_TRUE(found.has_value());
    EXPECT_DOUBLE_EQ(found->score, plainBestSum(map, few, guess, params, nullptr, 0.0) / full) << k;
    const auto other = matcher.secondBest(few, guess, found->pose, 0.35, 0.0);
    ASSERT_TRUE(other.has_value());
    EXPECT_DOUBLE_EQ(other->score, plainBestSum(map, few, guess, params, &found->pose, 0.35) / full)
        << k;
    EXPECT_GT(distance(other->pose, found->pose), 0.35 - 1e-9);
    EXPECT_LE(other->score, found->score);
  }
}

TEST(CorrelativeMatcher, FindsTheSameForOneScanAloneAsOnTheWholeMap) {
  const SurfaceMap map = roomMap();
  hyselam::Rng rng(6);
  int found_some = 0;
  for (int k = 0; k < 60; ++k) {
    const Pose2 truth{1.0 + 5.0 * rng.uniform(), 1.0 + 3.0 * rng.uniform(), 6.0 * rng.uniform()};
    SurfacePoints scan;  // what is near: a part of the map is enough
    for (const SurfacePoint& p : surfacePoints(roomScan(truth))) {
      if (std::hypot(p.x, p.y) < 0.5 + 0.05 * k) scan.push_back(p);
    }
    CorrelativeMatcherParams params;
    params.linear_window = 0.12 + 0.02 * k;
    params.angular_window = 0.1;
    params.min_score = 0.2;
    const Pose2 guess = truth * Pose2{k % 10 == 9 ? 9.0 : 0.1, -0.1, 0.03};
    const CorrelativeMatcher whole(map, params), part(map, params, scan, guess);
    const auto expected = whole.match(scan, guess), match = part.match(scan, guess);
    ASSERT_EQ(match.has_value(), expected.has_value()) << k;
    if (!match) continue;
    ++found_some;
    EXPECT_EQ(match->pose.x, expected->pose.x);
    EXPECT_EQ(match->pose.y, expected->pose.y);
    EXPECT_EQ(match->pose.theta, expected->pose.theta);
    EXPECT_EQ(match->score, expected->score);
  }
  EXPECT_GT(found_some, 30);
}

TEST(CorrelativeMatcher, FindsThePoseAcrossTheRoom) {
  const SurfaceMap map = roomMap();
  const Pose2 truth{2.2, 3.1, 0.7};
  const SurfacePoints scan = surfacePoints(roomScan(truth));
  CorrelativeMatcherParams params;
  params.linear_window = 2.5;
  params.angular_window = 0.8;
  const auto found = CorrelativeMatcher(map, params).match(scan, {4.0, 2.0, 0.1});
  ASSERT_TRUE(found.has_value());
  EXPECT_LT(distance(found->pose, truth), 0.1);
  EXPECT_LT(std::abs(found->pose.theta - truth.theta), 0.03);
  params.min_score = 0.99;
  EXPECT_FALSE(
      CorrelativeMatcher(map, params).match(surfacePoints(roomScan({20, 20, 0})), {4, 2, 0}));
}

TEST(CorrelativeMatcher, RejectsParametersOutOfRange) {
  CorrelativeMatcherParams params;
  params.angular_window = 4.0;
  EXPECT_THROW(CorrelativeMatcher(roomMap(), params), hyselam::ParameterError);
}

/// Drives a bow through the room; the wheels slip by `slip` [rad] at step 20.
struct Drive {
  ScanOdometry odometry;
  Pose2 truth{1.5, 1.5, 0.1}, wheels;
  ScanOdometry::Step last = odometry.add(roomScan(truth), wheels);
  double stamp = 0.0;

  void step(const Pose2& motion, const Pose2& slip) {
    truth = truth * motion;
    wheels = wheels * motion * slip;
    last = odometry.add(roomScan(truth), wheels);
  }
};

TEST(ScanOdometry, undoesSlipOfTheWheels) {
  Drive d;
  for (int i = 0; i < 40; ++i) {
    d.step({0.08, 0.0, 0.03}, i % 10 == 5 ? Pose2{0.02, 0.0, 0.25} : Pose2{0.002, 0.0, 0.0});
    EXPECT_FALSE(d.last.broken) << i;
  }
  const Pose2 moved = between(Pose2{1.5, 1.5, 0.1}, d.truth);
  EXPECT_GT(std::abs(hyselam::normalizeAngle(d.wheels.theta - moved.theta)), 0.9);
  EXPECT_LT(distance(d.last.pose, moved), 0.05);
  EXPECT_LT(std::abs(hyselam::normalizeAngle(d.last.pose.theta - moved.theta)), 0.02);
}

TEST(ScanOdometry, saysThatTheMotionIsUnknown) {
  Drive d;
  for (int i = 0; i < 10; ++i) d.step({0.08, 0.0, 0.0}, {});
  d.wheels = d.wheels * Pose2{30.0, 0.0, 0.0};  // the odometry begins again elsewhere
  const Pose2 before = d.last.pose;
  d.step({0.08, 0.0, 0.0}, {});
  EXPECT_TRUE(d.last.broken);
  EXPECT_LT(distance(d.last.pose, before), 1e-9) << "the robot is taken to have stood";
  d.step({0.08, 0.0, 0.0}, {});
  EXPECT_FALSE(d.last.broken);
}

TEST(ScanOdometry, goesByTheWheelsWhereNothingIsSeen) {
  ScanOdometry odometry;
  hyselam::LaserScan blind = roomScan({2, 2, 0});
  for (float& r : blind.ranges) r = 100.0F;
  Pose2 wheels;
  for (int i = 0; i < 10; ++i) {
    const ScanOdometry::Step step = odometry.add(blind, wheels);
    EXPECT_LT(distance(step.pose, wheels), 1e-9);
    EXPECT_FALSE(step.broken);
    wheels = wheels * Pose2{0.1, 0.0, 0.1};
  }
}

TEST(ScanOdometry, refusesParametersOutOfRange) {
  ScanOdometryParams params;
  params.keyframe_step = 0.0;
  EXPECT_THROW(ScanOdometry{params}, hyselam::ParameterError);
}

}  // namespace
