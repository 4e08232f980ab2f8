// What loops are made of: candidates by lengths of paths, scans that verify them, loops that bear
// each other out.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/rng.hpp"
#include "ngram_slam/slam/loop_tasks.hpp"
#include "ngram_slam/slam/slam_engine.hpp"
#include "ngram_slam/slam/slam_score.hpp"

namespace ngram_slam {
namespace {

using hyselam::Pose2;

/// Points along a wall that is seen from the origin's side.
void addWall(hyselam_scan_matching::SurfacePoints* points, double x0, double y0, double x1,
             double y1) {
  const double length = std::hypot(x1 - x0, y1 - y0), ux = (x1 - x0) / length,
               uy = (y1 - y0) / length;
  const double side = (0.0 - x0) * -uy + (0.0 - y0) * ux > 0.0 ? 1.0 : -1.0;
  for (double t = 0.0; t < length; t += 0.04)
    points->push_back({x0 + t * ux, y0 + t * uy, -side * uy, side * ux});
}

LoopTask taskOf(const hyselam_scan_matching::SurfacePoints& old_points,
                const hyselam_scan_matching::SurfacePoints& new_points) {
  LoopTask task;
  task.older = 0;
  task.newer = 1;
  task.far = true;
  task.window = 2.0;
  task.old_segment.push_back(
      {{}, std::make_shared<const hyselam_scan_matching::SurfacePoints>(old_points), {}});
  task.new_segment.push_back(
      {{}, std::make_shared<const hyselam_scan_matching::SurfacePoints>(new_points), {}});
  return task;
}

TEST(VerifyLoop, findsTheSameRoomAndNoOther) {
  hyselam_scan_matching::SurfacePoints room, divided, corridor;
  for (auto* points : {&room, &divided}) {
    addWall(points, -4.0, -2.0, 4.0, -2.0);
    addWall(points, 4.0, -2.0, 4.0, 3.0);
    addWall(points, 4.0, 3.0, -4.0, 3.0);
    addWall(points, -4.0, 3.0, -4.0, -2.0);
  }
  // Stand in the middle of what the room's scan saw free.
  addWall(&divided, 2.0, -2.0, 2.0, 3.0);
  addWall(&divided, -2.0, -2.0, -2.0, 3.0);
  addWall(&corridor, -15.0, -1.0, 15.0, -1.0);
  addWall(&corridor, -15.0, 1.0, 15.0, 1.0);
  const SlamParams params;
  const Pose2 moved{0.7, -0.4, 0.2};  // of the room's origin in the new scan's frame
  const LoopVerification same = verifyLoop(taskOf(room, transformed(moved, room)), params);
  EXPECT_TRUE(same.verified);
  const Pose2 off = moved * same.loop.measured;
  EXPECT_LT(std::hypot(off.x, off.y), 0.02);
  EXPECT_LT(std::abs(off.theta), 0.01);
  EXPECT_FALSE(verifyLoop(taskOf(room, divided), params).verified);
  EXPECT_FALSE(verifyLoop(taskOf(divided, room), params).verified);
  // The corridor looks the same everywhere: nobody can tell where along it this is.
  hyselam_scan_matching::SurfacePoints part;
  addWall(&part, -5.0, -1.0, 5.0, -1.0);
  addWall(&part, -5.0, 1.0, 5.0, 1.0);
  const LoopVerification anywhere = verifyLoop(taskOf(corridor, part), params);
  EXPECT_FALSE(anywhere.verified);
  EXPECT_GT(anywhere.ambiguous_score, 0.0);
  EXPECT_FALSE(verifyLoop(taskOf(room, {}), params).verified);
}

TEST(ObservedSpace, detectsSurfacesInFreeSpace) {
  ObservedSpace space(20.0, 0.1);
  hyselam_scan_matching::SurfacePoints wall;
  for (int i = -20; i <= 20; ++i) wall.push_back({5.0, 0.1 * i, -1.0, 0.0});
  space.insert({}, wall, {});
  EXPECT_EQ(space.overlap({}, wall).surface_ratio, 1.0);
  EXPECT_EQ(space.overlap({}, wall).observed_ratio, 1.0);
  EXPECT_EQ(space.overlap({-1.0, 0.0, 0.0}, wall).surface_ratio,
            0.0);  // in the free space before it
  EXPECT_EQ(space.overlap({3.0, 0.0, 0.0}, wall).observed_ratio, 0.0);   // behind it
  EXPECT_EQ(space.overlap({50.0, 0.0, 0.0}, wall).observed_ratio, 0.0);  // off the square
  EXPECT_THROW(ObservedSpace(0.0, 0.1), hyselam::ParameterError);
}

TEST(GraphPathLengths, useLoopsAsShortcuts) {
  GraphPathLengths lengths;
  for (int i = 0; i < 100; ++i) lengths.addEdge(i, i + 1, 1.0);
  EXPECT_NEAR(lengths.from(100)[0], 100.0, 1e-6);
  lengths.addEdge(0, 90, 0.5);
  EXPECT_NEAR(lengths.from(100)[0], 10.5, 1e-6);
  EXPECT_TRUE(std::isinf(lengths.from(150)[0]));
}

TEST(GraphPathLengths, toWantedKeyframesAreThoseOfTheWholeGraph) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    hyselam::Rng rng(seed);
    std::vector<SlamKeyframe> keyframes(200);
    GraphPathLengths lengths;
    for (std::size_t i = 1; i < keyframes.size(); ++i) {
      SlamKeyframe& k = keyframes[i];
      k.pose = keyframes[i - 1].pose * Pose2{1.0, 0.0, rng.gaussian(0.0, 0.3)};
      k.path_length = static_cast<double>(i);
      // Two parts of the graph, and the second goes over the place of the first.
      if (i != 60) lengths.addEdge(static_cast<int>(i) - 1, static_cast<int>(i), 1.0);
    }
    for (int l = 0; l < 10; ++l) {
      lengths.addEdge(static_cast<int>(rng.uniform(60.0, 100.0)),
                      static_cast<int>(rng.uniform(100.0, 199.0)), 0.5);
    }
    const LoopParams params;
    for (const int k : {59, 130, 199}) {
      const auto wanted = keyframesInReach(keyframes, k, params);
      const auto all = lengths.from(k), some = lengths.from(k, wanted);
      for (const int w : wanted) {
        EXPECT_EQ(some[static_cast<std::size_t>(w)], all[static_cast<std::size_t>(w)]);
      }
      const auto expected = loopCandidates(keyframes, k, all, params);
      const auto found = loopCandidates(keyframes, k, some, params);
      ASSERT_EQ(found.size(), expected.size());
      for (std::size_t i = 0; i < found.size(); ++i) {
        EXPECT_EQ(found[i].older, expected[i].older);
        EXPECT_EQ(found[i].position_uncertainty, expected[i].position_uncertainty);
      }
    }
    EXPECT_TRUE(std::isinf(lengths.from(59, {120})[120]));
    EXPECT_EQ(lengths.from(199, {198, 198, 5000})[198], lengths.from(199)[198]);
  }
}

TEST(ConsistentLoops, excludeLoopsThatContradict) {
  std::vector<SlamKeyframe> keyframes(40);
  for (std::size_t i = 0; i < keyframes.size(); ++i) {
    keyframes[i].path_length = static_cast<double>(i);
    keyframes[i].pose = {static_cast<double>(i), 0.0, 0.0};
  }
  SlamLoop a, b;
  a.older = 2;
  a.newer = 30;
  a.measured = {0.3, 0.0, 0.0};
  b.older = 4;
  b.newer = 32;
  b.measured = {0.35, 0.05, 0.0};
  EXPECT_EQ(consistentLoops(a, {b}, keyframes, {}, LoopParams{}).size(), 1U);
  b.measured = {1.5, 0.0, 0.0};
  EXPECT_TRUE(consistentLoops(a, {b}, keyframes, {}, LoopParams{}).empty());
  b.measured = {0.35, 0.05, 0.5};
  EXPECT_TRUE(consistentLoops(a, {b}, keyframes, {}, LoopParams{}).empty());
}

TEST(TrajectoryError, ignoresTheFrame) {
  std::vector<hyselam::StampedPose2> a, b;
  const Pose2 moved{3.0, -2.0, 1.0};
  for (int i = 0; i < 50; ++i) {
    const Pose2 p{0.3 * i, std::sin(0.2 * i), 0.1 * i};
    a.push_back({1.0 * i, p});
    b.push_back({1.0 * i, moved * p});
  }
  const TrajectoryError e = trajectoryError(a, b);
  EXPECT_EQ(e.poses, 50U);
  EXPECT_NEAR(e.rms, 0.0, 1e-9);
  EXPECT_NEAR(e.mean_angle, 0.0, 1e-9);
  EXPECT_EQ(trajectoryError({}, b).poses, 0U);
}

}  // namespace
}  // namespace ngram_slam
