// The graph of a run in a map that is held, against the whole graph.
#include <gtest/gtest.h>

#include "hyselam_common/rng.hpp"
#include "ngram_slam/slam/run_graph.hpp"

namespace {

using namespace ngram_slam;  // NOLINT: a test
using hyselam::Pose2;
using hyselam_pose_graph::PoseEdge;

Pose2 randomPose(hyselam::Rng& rng, double size) {
  return {rng.uniform(-size, size), rng.uniform(-size, size), rng.uniform(-3.0, 3.0)};
}

Eigen::Matrix3d randomInformation(hyselam::Rng& rng) {
  Eigen::Matrix3d a;
  for (int i = 0; i < 9; ++i) a(i / 3, i % 3) = rng.gaussian(0.0, 1.0);
  return a * a.transpose() + Eigen::Matrix3d::Identity();
}

/// Two runs of 20 keyframes, with loops within each and between them.
SlamState twoRuns(std::uint64_t seed) {
  hyselam::Rng rng(seed);
  SlamState state;
  for (int k = 0; k < 40; ++k) {
    SlamKeyframe keyframe;
    keyframe.pose = randomPose(rng, 50.0);
    keyframe.run = k < 20 ? 0 : 1;
    state.keyframes.push_back(keyframe);
    if (k % 20 == 0) continue;
    state.odometry.push_back({k - 1, k, randomPose(rng, 2.0), randomInformation(rng)});
  }
  const int ends[][2] = {{0, 20}, {3, 12}, {5, 25}, {19, 21}, {22, 38}, {7, 39}};
  for (const auto& [older, newer] : ends) {
    SlamLoop loop;
    loop.older = older;
    loop.newer = newer;
    loop.measured = randomPose(rng, 3.0);
    loop.information = randomInformation(rng);
    state.loops.push_back(loop);
  }
  return state;
}

TEST(RunGraph, CostsWhatTheWholeGraphCostsBesideTheHeldMap) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    SlamState state = twoRuns(seed);
    const RunGraph whole = runGraph(state, 0), run = runGraph(state, 20);
    ASSERT_EQ(whole.graph.poses.size(), 40u);
    ASSERT_EQ(run.graph.poses.size(), run.offset + 20u);
    EXPECT_EQ(run.odometry_edges, 19u);
    EXPECT_EQ(run.loops, (std::vector<std::size_t>{0, 2, 3, 4, 5}));
    run.graph.validate();
    whole.graph.validate();
    // Wherever the run lies, the costs differ by the same: those of the map's own edges.
    hyselam::Rng rng(seed + 100);
    std::vector<double> differences;
    for (int trial = 0; trial < 5; ++trial) {
      auto all = whole.graph.poses, own = run.graph.poses;
      for (std::size_t k = 20; k < 40; ++k) {
        all[k] = own[k - 20 + run.offset] = randomPose(rng, 50.0);
      }
      differences.push_back(graphCost(whole.graph, all) - graphCost(run.graph, own));
      EXPECT_NEAR(differences.back() / differences.front(), 1.0, 1e-9);
    }
  }
}

TEST(RunGraph, TakesNoLoopForOdometry) {
  const RunGraph run = runGraph(twoRuns(1), 20);
  for (std::size_t e = 0; e < run.graph.edges.size(); ++e) {
    EXPECT_EQ(isOdometry(run.graph.edges[e]), e < run.odometry_edges) << e;
  }
}

}  // namespace
