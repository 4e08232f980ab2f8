// SLAM goes on in a saved map from starts that are right, wrong, unknown, or in another building.
#include <gtest/gtest.h>

#include <cmath>

#include "hyselam_common/robot_log.hpp"
#include "ngram_slam/slam/known_maps.hpp"
#include "ngram_slam/slam/run_connections.hpp"
#include "ngram_slam/slam/slam_engine.hpp"
#include "visits.hpp"

namespace ngram_slam {
namespace {

using hyselam::Pose2;

/// A round through corridors; `visit`: another one has other errors.
hyselam::RobotLog visit(std::uint64_t building, std::uint64_t visit) {
  const auto made = loopedCorridors(building, 3, 16);
  auto params = atScanRate(5.0);
  params.odometry.sigma = 0.01;
  return hyselam_sim::simulate(made.plan, made.route, visit, params).log;
}

const hyselam::RobotLog& firstVisit() {
  static const hyselam::RobotLog log = visit(5, 3);
  return log;
}
const hyselam::RobotLog& secondVisit() {
  static const hyselam::RobotLog log = visit(5, 4);
  return log;
}
const hyselam::RobotLog& otherBuilding() {
  static const hyselam::RobotLog log = visit(11, 5);
  return log;
}

/// The map of the first visit.
const SlamState& knownMap() {
  static const SlamState state = mapOf(firstVisit(), 0.0, 1.0);
  return state;
}

Pose2 truthAt(const hyselam::RobotLog& log, std::size_t scan) {
  return *hyselam::poseAt(log.ground_truth, log.scans[scan].stamp, 1.0);
}

/// A true pose as the known map has it.
Pose2 inMap(const Pose2& truth) {
  const SlamKeyframe* nearest = nullptr;
  Pose2 its_truth;
  for (const SlamKeyframe& k : knownMap().keyframes) {
    const Pose2 there = *hyselam::poseAt(firstVisit().ground_truth, k.stamp, 1.0);
    if (nearest == nullptr || distance(there, truth) < distance(its_truth, truth)) {
      nearest = &k;
      its_truth = there;
    }
  }
  return nearest->pose * between(its_truth, truth);
}

constexpr std::size_t kFirstScan = 200;

/// Goes on in the known map until the run is tied to it.
void driveUntilTied(SlamEngine* engine, std::size_t* scan) {
  while (*scan < secondVisit().scans.size() && engine->pathOfRun() < 60.0) {
    feed(engine, secondVisit(), *scan, *scan + 1);
    ++*scan;
    if (engine->runPlace() == RunPlace::kTied) return;
  }
}

class Restarts : public testing::TestWithParam<Pose2> {};

TEST_P(Restarts, areTiedWhereTheRobotIs) {
  SlamEngine engine(SlamParams{}, knownMap());
  engine.startRun(inMap(truthAt(secondVisit(), kFirstScan)) * GetParam());
  std::size_t scan = kFirstScan;
  feed(&engine, secondVisit(), scan, scan + 1);
  ++scan;
  EXPECT_EQ(engine.runPlace(), RunPlace::kSupposed);
  EXPECT_FALSE(engine.pathUntilTied());
  driveUntilTied(&engine, &scan);
  ASSERT_EQ(engine.runPlace(), RunPlace::kTied);
  EXPECT_LT(*engine.pathUntilTied(), 30.0);
  feed(&engine, secondVisit(), scan, scan + 50);
  EXPECT_EQ(engine.runPlace(), RunPlace::kTied);
  EXPECT_LT(distance(engine.pose(), inMap(truthAt(secondVisit(), scan + 49))), 0.5);
  EXPECT_EQ(engine.shownRuns(), (std::vector<bool>{true, true}));
}

INSTANTIATE_TEST_SUITE_P(Starts, Restarts,
                         testing::Values(Pose2{}, Pose2{0.0, 3.0, 0.0}, Pose2{10.0, 0.0, 0.0},
                                         Pose2{0.0, 0.0, hyselam::kPi},
                                         Pose2{3.0, 2.0, -hyselam::kPi / 2.0}));

TEST(Restart, knowsWhatChangedWhenItIsTied) {
  SlamEngine first;
  feed(&first, firstVisit(), 0, 10);
  EXPECT_TRUE(first.knowsChanges());  // there is no session before it
  SlamEngine engine(SlamParams{}, knownMap());
  EXPECT_FALSE(engine.knowsChanges());  // nothing was seen since
  engine.startRunAnywhere();
  std::size_t scan = kFirstScan;
  feed(&engine, secondVisit(), scan, scan + 1);
  ASSERT_EQ(engine.runPlace(), RunPlace::kSupposed);
  EXPECT_FALSE(engine.knowsChanges());
  driveUntilTied(&engine, &++scan);
  ASSERT_EQ(engine.runPlace(), RunPlace::kTied);
  EXPECT_TRUE(engine.knowsChanges());
}

TEST(Restart, anywhereIsFound) {
  SlamEngine engine(SlamParams{}, knownMap());
  engine.startRunAnywhere();
  std::size_t scan = kFirstScan;
  driveUntilTied(&engine, &scan);
  ASSERT_EQ(engine.runPlace(), RunPlace::kTied);
  EXPECT_LT(distance(engine.pose(), inMap(truthAt(secondVisit(), scan - 1))), 0.5);
}

/// The known map, and beside it, as a map of its own, the same again.
SlamState knownMapTwice() {
  SlamState state = knownMap();
  const auto n = static_cast<int>(state.keyframes.size());
  const double path = state.keyframes.back().path_length;
  for (int k = 0; k < n; ++k) {
    SlamKeyframe copy = state.keyframes[static_cast<std::size_t>(k)];
    copy.run = 1;
    copy.path_length += path;
    state.keyframes.push_back(copy);
  }
  const auto edges = state.odometry;
  for (auto e : edges) {
    e.from += n;
    e.to += n;
    state.odometry.push_back(e);
  }
  const auto loops = state.loops;
  for (SlamLoop l : loops) {
    l.older += n;
    l.newer += n;
    state.loops.push_back(l);
  }
  return state;
}

/// Ten metres of the second visit, the newest scan at `end`.
std::vector<SubmapScan> lastMetresAt(std::size_t end) {
  std::vector<SubmapScan> scans;
  for (std::size_t i = end;
       i > 0 && distance(truthAt(secondVisit(), i), truthAt(secondVisit(), end)) < 10.0; --i) {
    scans.insert(scans.begin(),
                 {truthAt(secondVisit(), i),
                  std::make_shared<const hyselam::LaserScan>(secondVisit().scans[i])});
  }
  return scans;
}

TEST(KnownMaps, tellWhereTheLastMetresFitBest) {
  KnownMaps maps(knownMap(), static_cast<int>(knownMap().keyframes.size()), {}, 1, {});
  const std::size_t end = kFirstScan + 300;
  const auto place = maps.find(lastMetresAt(end));
  ASSERT_TRUE(place);
  const Pose2 found = knownMap().keyframes[static_cast<std::size_t>(place->keyframe)].pose *
                      place->base_in_keyframe;
  const Pose2 right = inMap(truthAt(secondVisit(), end));
  EXPECT_LT(distance(found, right), 0.2);
  EXPECT_LT(std::abs(hyselam::normalizeAngle(found.theta - right.theta)), 0.05);
  EXPECT_GT(place->probability, 0.95);
}

TEST(KnownMaps, doubtAPlaceThatAnotherMapHasToo) {
  const SlamState twice = knownMapTwice();
  KnownMaps maps(twice, static_cast<int>(twice.keyframes.size()), {}, 2, {});
  const auto place = maps.find(lastMetresAt(kFirstScan + 300));
  ASSERT_TRUE(place);
  EXPECT_LT(place->probability, 0.9);
}

TEST(KnownMaps, doNotSearchTheMapOfTheRunItself) {
  KnownMaps maps(knownMap(), static_cast<int>(knownMap().keyframes.size()), {}, 0, {});
  EXPECT_FALSE(maps.find(lastMetresAt(kFirstScan + 300)));
}

TEST(KnownMaps, letGoOfTheScansTheyWereDrawnFrom) {
  const std::shared_ptr<const hyselam::LaserScan>& scan = knownMap().keyframes.front().scan;
  const long before = scan.use_count();
  KnownMaps maps(knownMap(), static_cast<int>(knownMap().keyframes.size()), {}, 1, {});
  EXPECT_EQ(scan.use_count(), before + 1);
  ASSERT_TRUE(maps.find(lastMetresAt(kFirstScan + 300)));
  EXPECT_EQ(scan.use_count(), before);
  EXPECT_TRUE(maps.find(lastMetresAt(kFirstScan + 300)));  // again
}

TEST(KnownMaps, areNotSearchedIfOneIsTooLargeToBeDrawn) {
  SlamState twice = knownMapTwice();
  twice.keyframes.back().pose.x += 1e6;
  KnownMaps maps(twice, static_cast<int>(twice.keyframes.size()), {}, 2, {});
  EXPECT_FALSE(maps.find(lastMetresAt(kFirstScan + 300)));
  EXPECT_FALSE(maps.find(lastMetresAt(kFirstScan + 300)));  // nor later
}

/// Nothing is found but on the drawn maps.
SlamParams placesOnly() {
  SlamParams params;
  params.loops = LoopClosureMode::kProximity;
  params.run_start.search_interval = params.run_start.whole_map_interval = 1e6;
  return params;
}

TEST(Restart, isTiedByAPlaceThatNoOtherRivals) {
  SlamEngine engine(placesOnly(), knownMap());
  engine.startRunAnywhere();
  std::size_t scan = kFirstScan;
  driveUntilTied(&engine, &scan);
  ASSERT_EQ(engine.runPlace(), RunPlace::kTied);
  EXPECT_LT(distance(engine.pose(), inMap(truthAt(secondVisit(), scan - 1))), 0.5);
}

TEST(Restart, waitsWhereTwoPlacesAreAlike) {
  SlamEngine engine(placesOnly(), knownMapTwice());
  engine.startRunAnywhere();
  std::size_t scan = kFirstScan;
  driveUntilTied(&engine, &scan);
  EXPECT_EQ(engine.runPlace(), RunPlace::kOwnMap);
}

/// As feed(). The maps that were asked last.
std::weak_ptr<KnownMaps> mapsAsked(SlamEngine* engine, const hyselam::RobotLog& log,
                                   std::size_t begin, std::size_t end) {
  std::weak_ptr<KnownMaps> asked;
  for (std::size_t i = begin; i < std::min(end, log.scans.size()); ++i) {
    engine->add(log.scans[i], *hyselam::poseAt(log.odometry, log.scans[i].stamp, 1.0));
    while (const auto job = engine->takeJob()) {
      if (job->place) asked = job->place->maps;
      engine->apply(runJob(*job));
    }
  }
  return asked;
}

TEST(Restart, keepsDrawnMapsUntilItEnds) {
  SlamEngine engine(placesOnly(), knownMap());
  const auto maps = mapsAsked(&engine, otherBuilding(), 0, 60);
  ASSERT_EQ(engine.runPlace(), RunPlace::kSupposed);
  EXPECT_FALSE(maps.expired());
  engine.endRun();
  EXPECT_TRUE(maps.expired());
}

TEST(Restart, keepsDrawnMapsUntilItIsAMapOfItsOwn) {
  SlamParams params = placesOnly();
  params.run_start.own_map_path = 3.0;
  SlamEngine engine(params, knownMap());
  std::weak_ptr<KnownMaps> maps;
  std::size_t scan = 0;
  for (; scan < 1000 && engine.runPlace() != RunPlace::kOwnMap; ++scan) {
    const auto asked = mapsAsked(&engine, otherBuilding(), scan, scan + 1);
    if (!asked.expired()) maps = asked;
  }
  ASSERT_EQ(engine.runPlace(), RunPlace::kOwnMap);
  mapsAsked(&engine, otherBuilding(), scan, scan + 20);  // another keyframe
  EXPECT_TRUE(maps.expired());
}

TEST(Restart, asksNoDrawnMapsWithoutAnInterval) {
  SlamParams params = placesOnly();
  params.run_start.place_interval = 0.0;
  SlamEngine engine(params, knownMap());
  int asked = 0;
  for (std::size_t i = 0; i < 100; ++i) {
    engine.add(otherBuilding().scans[i],
               *hyselam::poseAt(otherBuilding().odometry, otherBuilding().scans[i].stamp, 1.0));
    while (const auto job = engine.takeJob()) {
      asked += job->place.has_value();
      engine.apply(runJob(*job));
    }
  }
  EXPECT_GT(engine.pathOfRun(), 2.0);
  EXPECT_EQ(asked, 0);
}

TEST(Restart, inAnotherBuildingIsAMapOfItsOwn) {
  SlamEngine engine(SlamParams{}, knownMap());
  feed(&engine, otherBuilding(), 0, 100);
  EXPECT_EQ(engine.runPlace(), RunPlace::kSupposed);
  EXPECT_EQ(engine.shownRuns(), (std::vector<bool>{true, false}));
  feed(&engine, otherBuilding(), 100, 100000);
  ASSERT_GT(engine.pathOfRun(), engine.params().run_start.own_map_path);
  EXPECT_EQ(engine.runPlace(), RunPlace::kOwnMap);
  EXPECT_EQ(engine.shownRuns(), (std::vector<bool>{false, true}));
}

TEST(Restart, atAKnownPoseIsTiedAtOnce) {
  SlamEngine engine(SlamParams{}, knownMap());
  engine.startRun(inMap(truthAt(secondVisit(), kFirstScan)) * Pose2{0.2, 0.1, 0.05}, 1.0, 0.5,
                  RunTrust::kKnown);
  feed(&engine, secondVisit(), kFirstScan, kFirstScan + 1);
  EXPECT_EQ(engine.runPlace(), RunPlace::kTied);
  EXPECT_EQ(engine.pathUntilTied(), 0.0);
  EXPECT_LT(distance(engine.pose(), inMap(truthAt(secondVisit(), kFirstScan))), 0.1);
}

/// A far loop by signatures, as if the scans had verified it; or at a place of the drawn maps.
void tell(SlamEngine* engine, int older, int newer, const Pose2& measured,
          double place_probability = 0.0) {
  SlamJobResult result;
  LoopTask task;
  task.far = true;
  task.source = place_probability > 0.0 ? LoopSource::kProximity : LoopSource::kSignature;
  task.place_probability = place_probability;
  task.older = older;
  task.newer = newer;
  LoopVerification answer;
  answer.verified = true;
  answer.loop.older = older;
  answer.loop.newer = newer;
  answer.loop.far = true;
  answer.loop.source = task.source;
  answer.loop.measured = measured;
  answer.loop.information = 100.0 * Eigen::Matrix3d::Identity();
  answer.loop.inlier_ratio = 0.9;
  answer.loop.fit = 0.98;
  result.tasks.push_back(task);
  result.verifications.push_back(answer);
  engine->apply(result);
}

/// Nothing is found by itself in so short a path.
SlamParams nothingFound() {
  SlamParams params;
  params.loops = LoopClosureMode::kNgrams;
  params.run_start.search_interval = params.run_start.whole_map_interval = 1e6;
  return params;
}

/// A run of 30 keyframes of the second visit; its first one.
int driveThirtyKeyframes(SlamEngine* engine) {
  const auto first = static_cast<int>(engine->keyframes().size());
  for (std::size_t scan = kFirstScan;
       engine->keyframes().size() < static_cast<std::size_t>(first) + 30; ++scan) {
    engine->add(secondVisit().scans[scan],
                *hyselam::poseAt(secondVisit().odometry, secondVisit().scans[scan].stamp, 1.0));
  }
  return first;
}

TEST(Restart, isTiedByTwoPlacesOnlyIfBothAreSure) {
  SlamEngine engine(nothingFound(), knownMap());
  const int first = driveThirtyKeyframes(&engine);
  const auto& keyframes = engine.keyframes();
  const Pose2 correction =
      keyframes[10].pose * Pose2{0.3, 0.2, 0.4} * keyframes[first].pose.inverse();
  std::vector<Pose2> loops;  // as the run lay before
  for (int i = 0; i < 30; ++i) {
    loops.push_back(between(keyframes[10].pose,
                            correction * keyframes[static_cast<std::size_t>(first + i)].pose));
  }
  const auto tellOf = [&](int i, double place_probability) {
    tell(&engine, 10, first + i, loops[static_cast<std::size_t>(i)], place_probability);
  };
  const std::size_t known = engine.loops().size();
  tellOf(0, 0.6);
  tellOf(10, 0.95);
  EXPECT_EQ(engine.runPlace(), RunPlace::kSupposed);
  EXPECT_EQ(engine.loops().size(), known);
  tellOf(20, 0.95);
  ASSERT_EQ(engine.runPlace(), RunPlace::kTied);
  EXPECT_EQ(engine.loops().size(), known + 2);
  // One that was out meanwhile is a far loop as others are.
  tellOf(15, 0.6);
  EXPECT_EQ(engine.loops().size(), known + 3);
}

TEST(Restart, asksTheScansAtPlacesLikelierThanTheirLikes) {
  SlamEngine engine(nothingFound(), knownMap());
  const int first = driveThirtyKeyframes(&engine);
  const auto tried = [&](double probability) {
    const auto before = engine.state().counters.far.tried;
    SlamJobResult result;
    result.place = PlaceAnswer{first + 29, first + 15, KnownPlace{10, Pose2{}, probability}};
    engine.apply(result);
    return engine.state().counters.far.tried - before;
  };
  EXPECT_EQ(tried(0.5), 0u);
  EXPECT_EQ(tried(0.51), 1u);
}

TEST(Restart, givesUpTiesThatMoreLoopsContradict) {
  SlamEngine engine(nothingFound(), knownMap());
  const int first = driveThirtyKeyframes(&engine);
  // Beside keyframe 10 of the known map, 40 m and half a turn from ...
  const auto& keyframes = engine.keyframes();
  const Pose2 wrong = keyframes[10].pose * Pose2{0.3, 0.2, 0.4} * keyframes[first].pose.inverse();
  const Pose2 right = Pose2{40.0, 5.0, 3.0} * wrong;
  const auto measured = [&](int older, const Pose2& correction, const Pose2& pose) {
    return between(keyframes[static_cast<std::size_t>(older)].pose, correction * pose);
  };
  std::vector<Pose2> poses;  // as they were
  for (const SlamKeyframe& k : keyframes) poses.push_back(k.pose);
  for (const int i : {0, 5, 10}) {
    EXPECT_EQ(engine.runPlace(), RunPlace::kSupposed);
    tell(&engine, 10 + i, first + i,
         measured(10 + i, wrong, poses[static_cast<std::size_t>(first + i)]));
  }
  ASSERT_EQ(engine.runPlace(), RunPlace::kTied);
  EXPECT_LT(distance(engine.keyframes().back().pose, wrong * poses.back()), 0.01);
  int told = 0;
  for (const int i : {0, 4, 8, 12, 16, 20}) {
    tell(&engine, 10 + i, first + i,
         measured(10 + i, right, poses[static_cast<std::size_t>(first + i)]));
    ++told;
    if (engine.tiesWithdrawn() > 0) break;
  }
  EXPECT_GE(told, 4);  // as many say nothing
  EXPECT_EQ(engine.tiesWithdrawn(), 1);
  EXPECT_EQ(engine.runPlace(), RunPlace::kTied);
  EXPECT_LT(distance(engine.keyframes().back().pose, right * poses.back()), 0.01);
}

TEST(RunConnections, joinRunsByLoopsThatAreUsed) {
  std::vector<SlamKeyframe> keyframes(5);
  for (std::uint32_t k = 0; k < 5; ++k) keyframes[k].run = k;
  std::vector<SlamLoop> loops(3);
  loops[0].older = 3, loops[0].newer = 4;
  loops[1].older = 0, loops[1].newer = 1, loops[1].weight = 0.5 * kMinLoopWeight;
  loops[2].older = 1, loops[2].newer = 4;
  const RunConnections c(keyframes, loops);
  EXPECT_FALSE(c.connected(0, 1));
  EXPECT_TRUE(c.connected(1, 3));
  EXPECT_EQ(c.mapOf(4), 1u);
  EXPECT_EQ(c.mapOf(2), 2u);
  EXPECT_EQ(c.mapOf(7), 7u);
  EXPECT_EQ(loopsWithinRuns(loops, keyframes, 4).size(), 1u);
  EXPECT_EQ(loopsWithinRuns(loops, keyframes, 2).size(), 3u);
}

}  // namespace
}  // namespace ngram_slam
