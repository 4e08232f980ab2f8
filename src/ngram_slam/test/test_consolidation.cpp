// A map of many visits: what is dropped of it, and what stays where it was.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <memory>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/rng.hpp"
#include "hyselam_common/testing/files.hpp"
#include "hyselam_pose_graph/graph_optimizer.hpp"
#include "ngram_slam/slam/consolidation.hpp"
#include "ngram_slam/slam/graph_reduction.hpp"
#include "ngram_slam/slam/slam_engine.hpp"
#include "ngram_slam/slam/slam_state_io.hpp"

namespace {

using namespace ngram_slam;  // NOLINT: a test
using hyselam::between;
using hyselam::Pose2;
using hyselam_pose_graph::GraphOptimizer;
using hyselam_pose_graph::GraphStart;
using hyselam_pose_graph::OptimizeParams;
using hyselam_pose_graph::PoseEdge;
using hyselam_pose_graph::PoseGraph;

// ---- the graph alone

Eigen::Matrix3d randomInformation(hyselam::Rng& rng) {
  Eigen::Matrix3d a;
  for (int i = 0; i < 9; ++i) a(i / 3, i % 3) = rng.gaussian(0.0, 1.0);
  Eigen::Matrix3d information = 20.0 * a * a.transpose();
  information.diagonal() += Eigen::Vector3d(50.0, 50.0, 200.0);
  return information;
}

/// `noise`: in lengths of the usual one.
PoseEdge noisyEdge(const std::vector<Pose2>& truth, int from, int to, hyselam::Rng& rng,
                   double noise = 1.0) {
  PoseEdge e;
  e.from = from;
  e.to = to;
  e.information = randomInformation(rng);
  e.measured = between(truth[static_cast<std::size_t>(from)], truth[static_cast<std::size_t>(to)]) *
               Pose2{rng.gaussian(0.0, 0.05 * noise), rng.gaussian(0.0, 0.05 * noise),
                     rng.gaussian(0.0, 0.02 * noise)};
  return e;
}

/// A walk with loops between poses that are near each other, at its optimum.
struct Walk {
  PoseGraph graph;
  std::vector<ReducedEdge> edges;
};

PoseGraph optimum(PoseGraph graph) {
  OptimizeParams p;
  p.start = GraphStart::kGiven;
  p.tolerance = 1e-14;
  graph.poses = GraphOptimizer(graph).optimize(p).poses;
  return graph;
}

Walk randomWalk(std::uint64_t seed, int poses, int loops, double noise = 1.0) {
  hyselam::Rng rng(seed);
  std::vector<Pose2> truth = {{100.0, -50.0, 0.3}};  // far from the origin of the map
  for (int i = 1; i < poses; ++i) {
    truth.push_back(truth.back() *
                    Pose2{0.5, rng.gaussian(0.0, 0.05), 0.25 + rng.gaussian(0.0, 0.1)});
  }
  Walk walk;
  walk.graph.poses = truth;
  for (int i = 0; i < poses; ++i) walk.graph.ids.push_back(i);
  for (int i = 1; i < poses; ++i)
    walk.edges.push_back({noisyEdge(truth, i - 1, i, rng, noise), true});
  for (int l = 0; l < loops; ++l) {
    const auto a = static_cast<int>(rng.uniform(0.0, poses - 5.0));
    const auto b = static_cast<int>(rng.uniform(a + 4.0, poses - 0.001));
    walk.edges.push_back({noisyEdge(truth, a, b, rng, noise), false});
  }
  for (const ReducedEdge& e : walk.edges) walk.graph.edges.push_back(e.edge);
  walk.graph = optimum(std::move(walk.graph));
  return walk;
}

/// The graph of the poses that stay. `numbers`: of each in the walk.
PoseGraph reduced(const Walk& walk, const std::vector<bool>& dropped, std::vector<int>* numbers) {
  std::vector<int> index(dropped.size(), -1);
  PoseGraph graph;
  for (std::size_t i = 0; i < dropped.size(); ++i) {
    if (dropped[i]) continue;
    index[i] = static_cast<int>(graph.poses.size());
    numbers->push_back(static_cast<int>(i));
    graph.ids.push_back(static_cast<std::int64_t>(i));
    graph.poses.push_back(walk.graph.poses[i]);
  }
  const auto add = [&](PoseEdge e) {
    e.from = index[static_cast<std::size_t>(e.from)];
    e.to = index[static_cast<std::size_t>(e.to)];
    graph.edges.push_back(e);
  };
  for (const ReducedEdge& e : walk.edges) {
    if (!dropped[static_cast<std::size_t>(e.edge.from)] &&
        !dropped[static_cast<std::size_t>(e.edge.to)]) {
      add(e.edge);
    }
  }
  for (const ReducedEdge& e : marginalizedEdges(walk.graph.poses, walk.edges, dropped)) add(e.edge);
  return graph;
}

std::vector<bool> randomlyDropped(std::uint64_t seed, std::size_t poses, double part) {
  hyselam::Rng rng(seed + 1000);
  std::vector<bool> dropped(poses, false);
  // The first pose is the one that does not move: both graphs are compared in its frame.
  for (std::size_t i = 1; i < poses; ++i) dropped[i] = rng.uniform(0.0, 1.0) < part;
  return dropped;
}

/// The poses that have no loop are dropped: each lies between two others.
std::vector<bool> withoutChains(const Walk& walk) {
  std::vector<bool> dropped(walk.graph.poses.size(), true);
  dropped.front() = dropped.back() = false;
  for (const ReducedEdge& e : walk.edges) {
    if (e.odometry) continue;
    dropped[static_cast<std::size_t>(e.edge.from)] = false;
    dropped[static_cast<std::size_t>(e.edge.to)] = false;
  }
  return dropped;
}

TEST(GraphReduction, LeavesTheOptimumOfTheOtherPosesWhereItIs) {
  for (std::uint64_t seed = 1; seed <= 25; ++seed) {
    const Walk walk = randomWalk(seed, 30, 25);
    const auto dropped = randomlyDropped(seed, 30, seed % 2 == 0 ? 0.4 : 0.8);
    std::vector<int> numbers;
    PoseGraph graph = reduced(walk, dropped, &numbers);
    EXPECT_LE(graph.edges.size(), walk.edges.size()) << seed;
    // From elsewhere: it must come back.
    hyselam::Rng rng(seed);
    for (std::size_t i = 1; i < graph.poses.size(); ++i) {
      graph.poses[i] = graph.poses[i] * Pose2{rng.gaussian(0.0, 0.1), rng.gaussian(0.0, 0.1),
                                              rng.gaussian(0.0, 0.05)};
    }
    graph = optimum(std::move(graph));
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      const Pose2& expected = walk.graph.poses[static_cast<std::size_t>(numbers[i])];
      EXPECT_NEAR(distance(graph.poses[i], expected), 0.0, 1e-5) << seed << ", " << numbers[i];
      EXPECT_NEAR(hyselam::normalizeAngle(graph.poses[i].theta - expected.theta), 0.0, 1e-5)
          << seed;
    }
  }
}

/// How far the optimum moves if the graph is reduced at poses that are off it [m]. `size`: of the
/// errors of the edges and of the poses.
double shiftOff(double size) {
  double largest = 0.0;
  for (std::uint64_t seed = 1; seed <= 25; ++seed) {
    Walk walk = randomWalk(seed, 30, 5, size);
    const std::vector<Pose2> best = walk.graph.poses;
    hyselam::Rng rng(seed);
    const auto error = [&] { return rng.gaussian(0.0, 0.02 * size); };
    for (std::size_t i = 1; i < best.size(); ++i) {
      walk.graph.poses[i] = best[i] * Pose2{error(), error(), 0.5 * error()};
    }
    std::vector<int> numbers;
    const PoseGraph graph = optimum(reduced(walk, withoutChains(walk), &numbers));
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      const Pose2& expected = best[static_cast<std::size_t>(numbers[i])];
      largest = std::max(largest, distance(graph.poses[i], expected));
    }
  }
  return largest;
}

TEST(GraphReduction, BesideTheOptimumErrsInSecondOrderOnly) {
  EXPECT_LT(shiftOff(1.0), 0.005);
  EXPECT_LT(shiftOff(0.25), shiftOff(1.0) / 10.0);
  EXPECT_LT(shiftOff(0.05), shiftOff(0.5) / 50.0);
}

/// How uncertain the reduced graph takes the poses to be, in lengths of the full graph's.
std::vector<double> uncertaintyRatios(const Walk& walk, const std::vector<bool>& dropped) {
  std::vector<int> numbers;
  const PoseGraph graph = reduced(walk, dropped, &numbers);
  std::vector<int> all;
  for (std::size_t i = 0; i < numbers.size(); ++i) all.push_back(static_cast<int>(i));
  const auto before = GraphOptimizer(walk.graph).covariances(walk.graph.poses, numbers);
  const auto after = GraphOptimizer(graph).covariances(graph.poses, all);
  std::vector<double> ratios;
  for (std::size_t i = 1; i < numbers.size(); ++i) {
    ratios.push_back(std::pow(after[i].determinant() / before[i].determinant(), 1.0 / 6.0));
  }
  return ratios;
}

TEST(GraphReduction, KeepsTheInformationOfPosesBetweenTwoOthers) {
  for (std::uint64_t seed = 1; seed <= 25; ++seed) {
    const Walk walk = randomWalk(seed, 30, 5);
    for (const double ratio : uncertaintyRatios(walk, withoutChains(walk))) {
      EXPECT_NEAR(ratio, 1.0, 1e-6);
    }
  }
}

TEST(GraphReduction, KeepsMostOfTheInformationOfPosesBetweenMany) {
  double sum = 0.0, smallest = 1.0, largest = 1.0;
  int count = 0;
  for (std::uint64_t seed = 1; seed <= 25; ++seed) {
    const Walk walk = randomWalk(seed, 30, 15);
    for (const double r : uncertaintyRatios(walk, randomlyDropped(seed, 30, 0.6))) {
      smallest = std::min(smallest, r);
      largest = std::max(largest, r);
      sum += r;
      ++count;
    }
  }
  RecordProperty("mean", std::to_string(sum / count));
  RecordProperty("smallest", std::to_string(smallest));
  RecordProperty("largest", std::to_string(largest));
  EXPECT_GT(smallest, 0.6);
  EXPECT_LT(largest, 1.6);
  EXPECT_NEAR(sum / count, 1.0, 0.15);
}

TEST(GraphReduction, RefusesAnEdgeWithoutInverse) {
  Walk walk = randomWalk(1, 5, 0);
  walk.edges[1].edge.information.setZero();
  std::vector<bool> dropped(5, false);
  dropped[1] = true;
  EXPECT_THROW(marginalizedEdges(walk.graph.poses, walk.edges, dropped), hyselam::InputError);
  dropped[1] = false;
  dropped[3] = true;
  EXPECT_EQ(marginalizedEdges(walk.graph.poses, walk.edges, dropped).size(), 1u);
}

TEST(GraphReduction, ComposesEdgesAlongAPath) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    // Loops pull at the edges: what was measured is not what the poses say.
    const Walk walk = randomWalk(seed, 12, 10);
    const PoseEdge &a = walk.edges[2].edge, &b = walk.edges[1].edge, &c = walk.edges[0].edge;
    const PoseEdge back = composedEdge(walk.graph.poses, {{a, true}, {b, true}});
    EXPECT_EQ(back.from, 3);
    EXPECT_EQ(back.to, 1);
    const Pose2 expected = a.measured.inverse() * b.measured.inverse();
    const double pulled = distance(between(walk.graph.poses[3], walk.graph.poses[1]), expected);
    EXPECT_LT(distance(back.measured, expected), 0.2 * pulled + 1e-4) << seed;
    EXPECT_LT(back.information.determinant(),
              std::min(a.information.determinant(), b.information.determinant()));
    const PoseEdge there = composedEdge(walk.graph.poses, {{c, false}, {b, false}});
    EXPECT_EQ(there.from, 0);
    EXPECT_EQ(there.to, 2);
    const Pose2 forth = c.measured * b.measured;
    const double off = distance(between(walk.graph.poses[0], walk.graph.poses[2]), forth);
    EXPECT_LT(distance(there.measured, forth), 0.2 * off + 1e-4) << seed;
  }
}

TEST(GraphReduction, MeanEdgeIsNoSurerThanTheSurest) {
  hyselam::Rng rng(5);
  const std::vector<Pose2> poses = {{3.0, 1.0, 0.5}, {4.0, 1.0, -0.5}};
  const std::vector<PoseEdge> edges = {noisyEdge(poses, 0, 1, rng), noisyEdge(poses, 0, 1, rng),
                                       noisyEdge(poses, 0, 1, rng)};
  double largest = 0.0;
  for (const PoseEdge& e : edges) largest = std::max(largest, e.information.determinant());
  EXPECT_NEAR(meanEdge(poses, edges).information.determinant() / largest, 1.0, 1e-9);
  const PoseEdge same = meanEdge(poses, {edges[0], edges[0]});
  EXPECT_NEAR(distance(same.measured, edges[0].measured), 0.0, 1e-9);
  EXPECT_TRUE(same.information.isApprox(edges[0].information, 1e-9));
}

// ---- maps

/// A hall of 16 m by 5 m with pillars, and a box in it where `box` says [m along it; none if < 0].
hyselam::LaserScan hall(const Pose2& robot, double stamp, double box) {
  hyselam::LaserScan scan;
  scan.stamp = stamp;
  scan.angle_min = -hyselam::kPi / 2.0;
  scan.angle_increment = hyselam::kPi / 120.0;
  scan.range_min = 0.05;
  scan.range_max = 30.0;
  const auto occupied = [&](double x, double y) {
    if (x < -2.0 || x > 14.0 || std::abs(y) > 2.5) return true;
    if (box >= 0.0 && std::abs(x - box) < 0.6 && y > 0.9 && y < 1.9) return true;
    return std::fmod(x + 20.0, 3.5) < 0.4 && std::abs(y) > 2.0;
  };
  for (int i = 0; i <= 120; ++i) {
    const double a = robot.theta + scan.angle_min + i * scan.angle_increment;
    double r = 0.1;
    while (!occupied(robot.x + r * std::cos(a), robot.y + r * std::sin(a))) r += 0.01;
    scan.ranges.push_back(static_cast<float>(r));
  }
  return scan;
}

void work(SlamEngine& engine) {
  while (auto job = engine.takeJob()) engine.apply(runJob(*job));
}

/// Drives along the hall; odometry begins anywhere.
void drive(SlamEngine& engine, double begin, double end, double box = -1.0) {
  const double step = begin < end ? 0.1 : -0.1;
  const double heading = begin < end ? 0.0 : hyselam::kPi;
  const auto steps = static_cast<int>(std::lround(std::abs(end - begin) / 0.1));
  for (int i = 0; i <= steps; ++i) {
    const Pose2 robot{begin + step * i, 0.05 * std::sin(0.3 * i), heading};
    engine.add(hall(robot, 100.0 + i, box), Pose2{7.0, -3.0, 1.0} * robot);
    work(engine);
  }
  engine.endRun();
  while (auto job = engine.takeFinalJob()) engine.apply(runJob(*job));
}

SlamState firstVisit() {
  SlamEngine engine;
  engine.startRun({0.0, 0.0, 0.0});
  drive(engine, 0.0, 12.0);
  return engine.state();
}

/// The state after another drive in the map. `begin`: where it begins, in the hall.
SlamState nextVisit(const SlamState& state, double begin, double end, double box = -1.0) {
  SlamEngine engine(SlamParams{}, state);
  engine.startRun({begin, 0.0, begin < end ? 0.0 : hyselam::kPi}, 0.5, 0.2, RunTrust::kKnown);
  drive(engine, begin, end, box);
  return engine.state();
}

std::string bytesOf(const SlamState& state) {
  hyselam::testing::TemporaryDirectory folder;
  SlamStateFile::save(folder / "map.slam", state);
  return hyselam::testing::fileBytes(folder / "map.slam");
}

std::vector<Pose2> scanPoses(const SlamState& s) {
  std::vector<Pose2> poses;
  for (const PlacedScan& p : s.scans) {
    poses.push_back(s.keyframes[static_cast<std::size_t>(p.keyframe)].pose * p.base_in_keyframe);
  }
  return poses;
}

std::size_t keyframesOfRun(const SlamState& s, std::uint32_t run) {
  return static_cast<std::size_t>(std::count_if(
      s.keyframes.begin(), s.keyframes.end(), [&](const SlamKeyframe& k) { return k.run == run; }));
}

TEST(Consolidation, LeavesOneVisitAsItIs) {
  const SlamState state = firstVisit();
  EXPECT_EQ(bytesOf(consolidated(state)), bytesOf(state));
  EXPECT_TRUE(consolidated(SlamState{}).keyframes.empty());
}

TEST(Consolidation, DropsASecondVisitThatSawTheSame) {
  const SlamState first = firstVisit();
  const SlamState both = nextVisit(first, 1.0, 11.0);
  ASSERT_GT(both.keyframes.size(), first.keyframes.size() + 30);
  const SlamState few = consolidated(both);
  EXPECT_EQ(few.error(), nullptr);
  // The last one stays: there the next run begins.
  EXPECT_LE(few.keyframes.size(), first.keyframes.size() + first.keyframes.size() / 20 + 1);
  EXPECT_EQ(few.keyframes.back().stamp, both.keyframes.back().stamp);
  EXPECT_EQ(keyframesOfRun(few, 0), first.keyframes.size());
  EXPECT_EQ(few.corpus.observations.runs(), first.corpus.observations.runs());
  EXPECT_LE(few.loops.size(), both.loops.size());
  // Everything is where it was.
  const auto before = scanPoses(both), after = scanPoses(few);
  ASSERT_EQ(after.size(), before.size());
  for (std::size_t i = 0; i < before.size(); ++i) {
    EXPECT_NEAR(distance(after[i], before[i]), 0.0, 1e-9);
    EXPECT_NEAR(hyselam::normalizeAngle(after[i].theta - before[i].theta), 0.0, 1e-9);
  }
  // And stays there when the graph is optimized again.
  SlamEngine engine(SlamParams{}, few);
  const PoseGraph again = optimum(engine.graph());
  for (std::size_t i = 0; i < again.poses.size(); ++i) {
    EXPECT_NEAR(distance(again.poses[i], few.keyframes[i].pose), 0.0, 0.01);
  }
}

TEST(Consolidation, IsDoneOnceAndAlwaysTheSameWay) {
  const SlamState both = nextVisit(firstVisit(), 0.5, 11.0, 6.0);
  const SlamState few = consolidated(both);
  ASSERT_LT(few.keyframes.size(), both.keyframes.size());
  EXPECT_EQ(bytesOf(consolidated(both)), bytesOf(few));
  EXPECT_EQ(bytesOf(consolidated(few)), bytesOf(few));
  ConsolidationParams off;
  off.enabled = false;
  EXPECT_EQ(bytesOf(consolidated(both, off)), bytesOf(both));
}

TEST(Consolidation, KeepsWhatNobodyHadSeen) {
  const SlamState first = firstVisit();
  // The other way: the laser sees 180 degrees only.
  const SlamState back = consolidated(nextVisit(first, 11.0, 1.0));
  EXPECT_GT(keyframesOfRun(back, 1), 25u);
  // A box that was not there.
  const SlamState plain = consolidated(nextVisit(first, 0.0, 11.0));
  const SlamState changed = consolidated(nextVisit(first, 0.0, 11.0, 6.0));
  EXPECT_GT(keyframesOfRun(changed, 1), keyframesOfRun(plain, 1) + 8);
}

SlamKeyframe keyframeIn(const Pose2& pose, std::uint32_t run, double box) {
  SlamKeyframe k;
  k.pose = pose;
  k.run = run;
  const hyselam::LaserScan scan = hall(pose, 1.0, box);
  k.scan = std::make_shared<const hyselam::LaserScan>(scan);
  k.points = std::make_shared<const hyselam_scan_matching::SurfacePoints>(
      surfacePoints(scan, SlamParams{}.surface));
  return k;
}

TEST(RedundantKeyframes, StayWhereSomethingKnownIsMissed) {
  // All that the last one sees was seen by the first, which saw the wall behind the box.
  const std::vector<SlamKeyframe> same = {keyframeIn({4.0, 0.0, 0.0}, 0, -1.0),
                                          keyframeIn({4.1, 0.0, 0.1}, 1, -1.0),
                                          keyframeIn({4.0, 0.1, 0.0}, 2, -1.0)};
  std::vector<SlamKeyframe> removed = same;
  removed[1] = keyframeIn({4.1, 0.0, 0.1}, 1, 5.0);
  const std::vector<int> one_component(3, 0);
  const std::vector<bool> free(3, false);
  EXPECT_EQ(redundantKeyframes(same, one_component, free, {}),
            (std::vector<bool>{false, true, true}));
  EXPECT_EQ(redundantKeyframes(removed, one_component, free, {}),
            (std::vector<bool>{false, false, false}));
  RedundancyParams blind;
  blind.min_seen_again = 0.0;
  EXPECT_EQ(redundantKeyframes(removed, one_component, free, blind),
            (std::vector<bool>{false, false, true}));
  // Of three runs that saw different things the first and the newest stay.
  std::vector<SlamKeyframe> different = removed;
  different[2] = keyframeIn({4.0, 0.1, 0.0}, 2, 6.5);
  RedundancyParams two;
  two.max_looks = 2;
  EXPECT_EQ(redundantKeyframes(different, one_component, free, {}),
            (std::vector<bool>{false, false, false}));
  EXPECT_EQ(redundantKeyframes(different, one_component, free, two),
            (std::vector<bool>{false, true, false}));
  EXPECT_EQ(redundantKeyframes(different, one_component, {false, true, false}, two),
            (std::vector<bool>{false, false, false}));
  // With the second one went what contradicted the third, which saw what the first did.
  EXPECT_EQ(redundantKeyframes(removed, one_component, free, two),
            (std::vector<bool>{false, true, true}));
  EXPECT_EQ(redundantKeyframes(same, {0, 1, 1}, free, {}), (std::vector<bool>{false, false, true}));
}

TEST(Consolidation, LevelsOffWhereTheHallChangesEachTime) {
  SlamState state = firstVisit();
  const std::size_t first = state.keyframes.size();
  std::vector<std::size_t> sizes, loops;
  constexpr int kVisits = 16, kPlaces = 7;
  for (int visit = 0; visit < kVisits; ++visit) {
    state = consolidated(nextVisit(state, 0.0, 11.0, 4.0 + 0.8 * (visit * 3 % kPlaces)));
    sizes.push_back(state.keyframes.size());
    loops.push_back(state.loops.size());
    EXPECT_LE(state.keyframes.size(), 3 * first + 3) << visit;
  }
  // As many as after half of the visits.
  EXPECT_LE(loops.back(), loops[kVisits / 2] + first / 2);
  EXPECT_LE(sizes.back(), sizes[kVisits / 2] + first / 10);
  // The newest are among those that stayed.
  EXPECT_GT(keyframesOfRun(state, kVisits), 5u);
}

TEST(Consolidation, ForgetsThePosesOfOldScansOnlyWhenAsked) {
  const SlamState first = firstVisit();
  const SlamState both = nextVisit(first, 1.0, 11.0);
  ConsolidationParams params;
  params.max_scans = 5;
  const SlamState few = consolidated(both, params);
  EXPECT_EQ(few.scans.size(), both.scans.size() - first.scans.size());
  EXPECT_EQ(few.scans.front().stamp, both.scans[first.scans.size()].stamp);
  params.max_scans = 0;
  EXPECT_EQ(consolidated(both, params).scans.size(), both.scans.size());
}

TEST(Consolidation, KeepsAMapThatIsNotTied) {
  const SlamState first = firstVisit();
  SlamState both = nextVisit(first, 1.0, 11.0);
  // Without loops between them the runs are two maps.
  both.loops.clear();
  EXPECT_EQ(consolidated(both).keyframes.size(), both.keyframes.size());
}

TEST(Consolidation, LetsSlamContinue) {
  const SlamState state = consolidated(nextVisit(firstVisit(), 1.0, 11.0));
  SlamEngine engine(SlamParams{}, state);
  engine.startRun({0.1, 0.0, 0.0}, 0.5, 0.2, RunTrust::kKnown);
  drive(engine, 0.1, 10.1);
  EXPECT_NEAR(engine.pose().x, 10.1, 0.1);
  EXPECT_NEAR(engine.pose().y, 0.0, 0.1);
  EXPECT_EQ(engine.keyframes().back().run, 2u);
}

/// To and fro in the hall without a stop, odometry going on; after each time there and back the
/// session ends, if they do. Keyframes after each.
std::vector<std::size_t> keyframesToAndFro(int times, bool sessions_end, Pose2* pose) {
  auto engine = std::make_unique<SlamEngine>();
  std::vector<std::size_t> keyframes;
  double stamp = 100.0;
  bool begins = false;
  for (int i = 0; i < times; ++i) {
    for (int step = 0; step < 220; ++step) {
      const double x = step < 110 ? 0.1 * step : 0.1 * (220 - step);
      const Pose2 robot{x, 0.0, step < 110 ? 0.0 : hyselam::kPi};
      const Pose2 odometry = Pose2{7.0, -3.0, 1.0} * robot;
      if (begins) engine->startRunByOdometry(odometry);
      begins = false;
      engine->add(hall(robot, stamp += 1.0, -1.0), odometry);
      work(*engine);
    }
    if (sessions_end) {
      engine = std::make_unique<SlamEngine>(SlamParams{}, consolidated(engine->state()));
      work(*engine);
      begins = true;
    }
    keyframes.push_back(engine->keyframes().size());
  }
  *pose = Pose2{7.0, -3.0, 1.0}.inverse() * engine->pose();
  return keyframes;
}

TEST(Consolidation, KeepsTheMapOfARobotThatNeverStopsAsLargeAsTheBuilding) {
  Pose2 pose, pose_without;
  const auto ended = keyframesToAndFro(6, true, &pose);
  EXPECT_LE(ended.back(), ended[1] + ended[1] / 10);
  const auto went_on = keyframesToAndFro(6, false, &pose_without);
  EXPECT_GE(went_on.back(), 5 * went_on.front());
  EXPECT_NEAR(distance(pose, pose_without), 0.0, 0.01);
  EXPECT_NEAR(pose.x, 0.1, 0.1);  // of the hall, in which the odometry began
  EXPECT_NEAR(pose.y, 0.0, 0.1);
}

TEST(Consolidation, ARunThatGoesOnByOdometryIsKnown) {
  SlamEngine engine(SlamParams{}, firstVisit());
  const Pose2 robot{11.5, 0.0, hyselam::kPi};
  engine.startRunByOdometry(Pose2{7.0, -3.0, 1.0} * robot);
  engine.add(hall(robot, 1000.0, -1.0), Pose2{7.0, -3.0, 1.0} * robot);
  EXPECT_EQ(engine.runPlace(), RunPlace::kTied);
  EXPECT_NEAR(engine.pose().x, 11.5, 0.05);
  EXPECT_NEAR(engine.pose().y, 0.0, 0.05);
}

TEST(Consolidation, RefusesParametersOutOfRange) {
  ConsolidationParams params;
  params.max_loops = 0;
  EXPECT_THROW(consolidated(SlamState{}, params), hyselam::ParameterError);
}

}  // namespace
