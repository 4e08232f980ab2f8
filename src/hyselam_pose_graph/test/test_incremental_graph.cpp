// A graph that grows pose by pose against the same graph solved at once.
#include <gtest/gtest.h>

#include "hyselam_common/errors.hpp"
#include "hyselam_pose_graph/incremental_graph.hpp"
#include "random_graphs.hpp"

namespace {

using namespace hyselam_pose_graph;  // NOLINT: a test
using hyselam::Pose2;
using random_graphs::worst;

/// The graph cut off after some pose, edges in order.
PoseGraph firstPart(const PoseGraph& whole, int poses) {
  PoseGraph part;
  part.ids.assign(whole.ids.begin(), whole.ids.begin() + poses);
  part.poses.assign(whole.poses.begin(), whole.poses.begin() + poses);
  for (const PoseEdge& e : whole.edges)
    if (e.from < poses && e.to < poses) part.edges.push_back(e);
  return part;
}

/// Takes a graph's edges in as a robot would; optimises at each loop.
class Grower {
 public:
  explicit Grower(const PoseGraph& whole) : whole_(whole) { graph.addPose(whole.poses.front()); }
  /// Up to and with a pose.
  template <class AtLoop>
  void growTo(int pose, const AtLoop& at_loop) {
    for (; next_ < whole_.edges.size() && whole_.edges[next_].to <= pose; ++next_) {
      const PoseEdge& e = whole_.edges[next_];
      if (e.to == static_cast<int>(graph.graph().poses.size())) {
        graph.append(e.measured, e.information);
      } else {
        graph.addEdge(e);
        at_loop();
      }
    }
  }
  IncrementalGraph graph;

 private:
  const PoseGraph& whole_;
  std::size_t next_ = 0;
};

TEST(IncrementalGraph, EqualsTheBatchAtEachLoop) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const auto known = random_graphs::streets(150, 0.02, seed);
    Grower g(known.graph);
    int loops = 0;
    g.growTo(149, [&] {
      EXPECT_TRUE(g.graph.pending());
      const OptimizeResult r = g.graph.optimize();
      EXPECT_FALSE(g.graph.pending());
      const int n = static_cast<int>(g.graph.graph().poses.size());
      // All loops of the newest pose are in (streets() gives each at most one).
      const OptimizeResult batch = GraphOptimizer(firstPart(known.graph, n)).optimize();
      EXPECT_NEAR(r.final_cost, batch.final_cost, 1e-5 * (1e-3 + batch.final_cost));
      EXPECT_LT(worst(r.poses, batch.poses), 1e-3);
      ++loops;
    });
    EXPECT_GT(loops, 5) << seed;
  }
}

TEST(IncrementalGraph, CovariancesEqualTheBatchBeforeAndAfterALoop) {
  const auto known = random_graphs::streets(120, 0.02, 11);
  Grower g(known.graph);
  const auto compare = [&] {
    const int n = static_cast<int>(g.graph.graph().poses.size());
    const GraphOptimizer batch(firstPart(known.graph, n));
    std::vector<int> all(static_cast<std::size_t>(n));
    for (int i = 0; i < n; ++i) all[static_cast<std::size_t>(i)] = i;
    const auto expected = batch.covariances(g.graph.graph().poses, all);
    for (int i = 0; i < n; ++i) {
      const Eigen::Matrix3d& e = expected[static_cast<std::size_t>(i)];
      EXPECT_LT((g.graph.covariance(i) - e).norm(), 1e-6 * (e.norm() + 1e-12)) << i << " of " << n;
    }
  };
  g.growTo(3, [] {});
  compare();  // odometry alone
  g.growTo(100, [&] { g.graph.optimize(); });
  g.graph.optimize();
  compare();
  // Poses appended since, up to the next loop.
  g.growTo(101, [&] { g.graph.optimize(); });
  compare();
}

TEST(IncrementalGraph, CovariancesGrowAlongALongPathWithoutLoops) {
  IncrementalGraph graph;
  graph.addPose({});
  constexpr int kSteps = 200000;
  for (int i = 0; i < kSteps; ++i) graph.append({}, 4.0 * Eigen::Matrix3d::Identity());
  EXPECT_NEAR(graph.covariance(kSteps)(2, 2), 0.25 * kSteps, 1e-6 * kSteps);
}

TEST(IncrementalGraph, PatternIsReusedWhenALoopFitsIntoIt) {
  const auto known = random_graphs::streets(200, 0.02, 3);
  IncrementalGraph graph(known.graph);
  graph.optimize();
  EXPECT_EQ(graph.patternAnalyses(), 1);
  PoseEdge again = known.graph.edges.back();  // the same two poses, measured once more
  graph.addEdge(again);
  graph.optimize();
  EXPECT_EQ(graph.patternAnalyses(), 1);
  // Two neighbors of one pose, which is eliminated before or after them, may not be coupled; poses
  // far apart are not.
  again.from = 1;
  again.to = 150;
  again.measured = between(known.truth[1], known.truth[150]);
  graph.addEdge(again);
  const OptimizeResult r = graph.optimize();
  PoseGraph whole = graph.graph();
  EXPECT_NEAR(GraphOptimizer(whole).optimize().final_cost, r.final_cost, 1e-5 * r.final_cost);
  graph.append({1.0, 0.0, 0.0}, Eigen::Matrix3d::Identity());
  graph.optimize();
  EXPECT_GE(graph.patternAnalyses(), 2) << "a new pose needs a new pattern";
}

TEST(IncrementalGraph, LargeRotationErrorsStartTheGlobalRelaxation) {
  // A first guess from which descent ends in a false minimum.
  auto known = random_graphs::streets(300, 0.02, 3);
  const double best = GraphOptimizer(known.graph).optimize().final_cost;
  hyselam::Rng rng(5);
  for (std::size_t i = 1; i < known.graph.poses.size(); ++i)
    known.graph.poses[i] = {50.0 * rng.uniform(), 50.0 * rng.uniform(), 6.0 * rng.uniform() - 3.0};
  OptimizeParams params;
  params.start = GraphStart::kGiven;
  ASSERT_GT(GraphOptimizer(known.graph).optimize(params).final_cost, 1.1 * best);
  EXPECT_NEAR(IncrementalGraph(known.graph).optimize().final_cost, best, 1e-4 * best);
}

TEST(IncrementalGraph, RejectsInvalidEdgesAndStaysUnchanged) {
  IncrementalGraph graph;
  EXPECT_THROW(graph.append({1, 0, 0}, Eigen::Matrix3d::Identity()), hyselam::InputError);
  graph.addPose({});
  EXPECT_THROW(graph.append({std::nan(""), 0, 0}, Eigen::Matrix3d::Identity()),
               hyselam::InputError);
  EXPECT_THROW(graph.append({1, 0, 0}, -Eigen::Matrix3d::Identity()), hyselam::InputError);
  PoseEdge edge;
  edge.to = 1;
  EXPECT_THROW(graph.addEdge(edge), hyselam::InputError);
  EXPECT_EQ(graph.graph().poses.size(), 1u);
  EXPECT_TRUE(graph.graph().edges.empty());
  EXPECT_FALSE(graph.pending());
  EXPECT_EQ(graph.optimize().final_cost, 0.0);
  EXPECT_THROW(graph.covariance(1), hyselam::InputError);
}

}  // namespace
