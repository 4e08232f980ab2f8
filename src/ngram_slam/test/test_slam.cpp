// The SLAM engine on simulated buildings with loops.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>
#include <type_traits>

#include "hyselam_common/carmen_log.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/rng.hpp"
#include "hyselam_common/testing/files.hpp"
#include "hyselam_common/trajectory_io.hpp"
#include "ngram_slam/slam/loop_tasks.hpp"
#include "ngram_slam/slam/region_graph.hpp"
#include "ngram_slam/slam/slam_engine.hpp"
#include "ngram_slam/slam/slam_score.hpp"
#include "visits.hpp"

namespace ngram_slam {
namespace {

using hyselam::Pose2;

/// A round through corridors with odometry that is off by metres in the end.
const hyselam::RobotLog& building() {
  static const hyselam::RobotLog log = [] {
    const auto made = loopedCorridors(5, 3, 26);
    auto params = atScanRate(5.0);
    params.odometry.sigma = 0.01;
    params.odometry.base_scale = 1.03;
    return hyselam_sim::simulate(made.plan, made.route, 3, params).log;
  }();
  return log;
}

SlamEngine mapped(LoopClosureMode loops, std::size_t scans = 100000) {
  SlamParams params;
  params.loops = loops;
  SlamEngine engine(params);
  feed(&engine, building(), 0, scans);
  finish(&engine);
  return engine;
}

const SlamEngine& withAllLoops() {
  static const SlamEngine engine = mapped(LoopClosureMode::kAll);
  return engine;
}

TEST(SlamEngine, mapsABuildingFarBetterThanOdometry) {
  const SlamEngine& engine = withAllLoops();
  const TrajectoryError slam = trajectoryError(engine.trajectory(), building().ground_truth);
  const TrajectoryError odometry = trajectoryError(building().odometry, building().ground_truth);
  EXPECT_EQ(engine.trajectory().size(), building().scans.size());
  EXPECT_LT(slam.rms, 0.15);
  EXPECT_LT(10.0 * slam.rms, odometry.rms);
  EXPECT_GT(engine.loops().size(), 10U);
}

/// The same round with a scan each meter, and odometry that errs by 10 cm and 0.1 rad in it.
hyselam::RobotLog sparseLogOfABadRobot(std::uint64_t seed) {
  hyselam::RobotLog log = building();
  log.scans.clear();
  log.odometry.clear();
  hyselam::Rng rng(seed);
  Pose2 told;
  std::optional<Pose2> last;
  for (const hyselam::LaserScan& scan : building().scans) {
    const auto truth = hyselam::poseAt(building().ground_truth, scan.stamp, 1.0);
    if (!truth || (last && distance(*last, *truth) < 1.0)) continue;
    if (last) {
      told = told * between(*last, *truth) *
             Pose2{rng.gaussian(0.0, 0.1), rng.gaussian(0.0, 0.1), rng.gaussian(0.0, 0.1)};
    }
    log.odometry.push_back({scan.stamp, told});
    log.scans.push_back(scan);
    last = *truth;
  }
  return log;
}

double errorWithoutLoops(const hyselam::RobotLog& log, double max_deviations) {
  SlamParams params;
  params.loops = LoopClosureMode::kNone;
  params.relocalization.max_deviations = max_deviations;
  SlamEngine engine(params);
  feed(&engine, log, 0, log.scans.size());
  finish(&engine);
  if (max_deviations > 0.0) {
    // Straight on, the model expects 0.06 rad.
    EXPECT_GT(engine.odometryNoise().headingScale(), 1.0);
  }
  return trajectoryError(engine.trajectory(), log.ground_truth).mean_step;
}

TEST(SlamEngine, searchesWhatHopelessOdometryLeavesOpen) {
  for (const std::uint64_t seed : {1, 2}) {
    const hyselam::RobotLog log = sparseLogOfABadRobot(seed);
    const double searched = errorWithoutLoops(log, SlamParams().relocalization.max_deviations);
    EXPECT_LT(searched, 0.06) << seed;
    EXPECT_LT(1.5 * searched, errorWithoutLoops(log, 0.0)) << seed;
  }
}

/// The engine where the scans have just been asked for a step again.
struct AskedAgain {
  SlamEngine engine;
  SlamJobResult result;
};

AskedAgain askedAgain(double path_behind) {
  SlamParams params;
  params.loops = LoopClosureMode::kNone;
  params.step_check.path_behind = path_behind;
  AskedAgain asked{SlamEngine(params), {}};
  const hyselam::RobotLog log = sparseLogOfABadRobot(1);
  for (std::size_t i = 0; i < 60; ++i) {
    asked.engine.add(log.scans[i], log.odometry[i].pose);
    while (const auto job = asked.engine.takeJob()) {
      asked.result = runJob(*job);
      if (i > 30 && !job->tasks.empty() && job->tasks[0].step) return asked;
      asked.engine.apply(asked.result);
    }
  }
  asked.result = {};
  return asked;
}

TEST(SlamEngine, changesAStepThatBothSidesContradict) {
  AskedAgain asked = askedAgain(SlamParams().step_check.path_behind);
  ASSERT_EQ(asked.result.tasks.size(), 1U);
  const auto older = static_cast<std::size_t>(asked.result.tasks[0].older);
  const std::vector<SlamKeyframe> before = asked.engine.keyframes();
  const auto step = [&](const std::vector<SlamKeyframe>& k, std::size_t i) {
    return between(k[i].pose, k[i + 1].pose);
  };
  ASSERT_GT(before.size(), older + 4);
  const Pose2 true_step = step(before, older) * Pose2{0.2, 0.1, 0.3};
  LoopVerification& answer = asked.result.verifications[0];
  answer.verified = true;
  answer.loop.measured = true_step;
  answer.loop.information = Eigen::Vector3d(1e6, 1e6, 1e7).asDiagonal();
  const Pose2 robot = between(before.back().pose, asked.engine.pose());
  const int revision = asked.engine.revision();
  asked.engine.apply(asked.result);
  EXPECT_GT(asked.engine.revision(), revision);
  EXPECT_EQ(asked.engine.roughRoad().steps_mended, 1U);
  const std::vector<SlamKeyframe>& now = asked.engine.keyframes();
  EXPECT_LT(distance(step(now, older), true_step), 1e-3);
  EXPECT_NEAR(hyselam::normalizeAngle(step(now, older).theta - true_step.theta), 0.0, 1e-3);
  EXPECT_LT(distance(asked.engine.odometry()[older].measured, true_step), 1e-3);
  for (std::size_t i = 0; i + 1 < now.size(); ++i) {
    if (i == older) continue;
    EXPECT_LT(distance(step(now, i), step(before, i)), 1e-9) << i;
  }
  EXPECT_LT(distance(between(now.back().pose, asked.engine.pose()), robot), 1e-9);
}

TEST(SlamEngine, leavesAStepOfWhichTheScansKnowNothing) {
  AskedAgain asked = askedAgain(SlamParams().step_check.path_behind);
  ASSERT_EQ(asked.result.tasks.size(), 1U);
  const auto older = static_cast<std::size_t>(asked.result.tasks[0].older);
  const Pose2 was = asked.engine.odometry()[older].measured;
  LoopVerification& answer = asked.result.verifications[0];
  answer.verified = true;
  answer.loop.measured = was * Pose2{0.5, 0.0, 0.0};
  answer.loop.information = Eigen::Vector3d(1.0, 1e6, 1e7).asDiagonal();  // along a corridor
  asked.engine.apply(asked.result);
  EXPECT_EQ(asked.engine.roughRoad().steps_mended, 0U);
  EXPECT_EQ(distance(asked.engine.odometry()[older].measured, was), 0.0);
}

TEST(SlamEngine, asksNoStepAgainWhereNoneIsWanted) {
  const AskedAgain asked = askedAgain(0.0);
  EXPECT_TRUE(asked.result.tasks.empty());
  EXPECT_EQ(asked.engine.roughRoad().steps_checked, 0U);
}

TEST(StepTask, isAnsweredByThePathOnBothSides) {
  const SlamEngine engine = mapped(LoopClosureMode::kNone, 900);
  const auto& keyframes = engine.keyframes();
  const SlamParams params;
  int asked = 0, answered = 0;
  for (std::size_t k = 40; k + 40 < keyframes.size(); k += 10, ++asked) {
    LoopTask task = stepTask(keyframes, static_cast<int>(k), params.step_check);
    EXPECT_EQ(task.new_segment.front().pose.theta, 0.0);
    const Pose2 step = between(keyframes[k - 1].pose, keyframes[k].pose);
    task.initial_guess = step * Pose2{0.3, -0.3, 0.35};
    const LoopVerification answer = verifyStep(task, params);
    if (!answer.verified) continue;
    ++answered;
    // Along a corridor the answer says by its information that it does not know.
    const Pose2 error = between(step, answer.loop.measured);
    EXPECT_LT(std::abs(error.theta), 0.03) << k;
    EXPECT_LT(std::min(std::abs(error.x), std::abs(error.y)), 0.1) << k;
  }
  EXPECT_GT(asked, 5);
  EXPECT_GT(2 * answered, asked);
}

TEST(SlamEngine, acceptsNoFalseLoop) {
  const SlamEngine& engine = withAllLoops();
  for (const SlamLoop& l : engine.loops()) {
    const auto e = loopError(engine.keyframes()[static_cast<std::size_t>(l.older)],
                             engine.keyframes()[static_cast<std::size_t>(l.newer)], l.measured,
                             building().ground_truth);
    ASSERT_TRUE(e.has_value());
    EXPECT_FALSE(e->isFalse()) << l.older << " and " << l.newer << ": " << e->distance << " m, "
                               << hyselam::degrees(e->angle) << " deg";
  }
  const SlamKeyframe& first = engine.keyframes().front();
  EXPECT_FALSE(loopError(first, engine.keyframes().back(), {}, {}).has_value());
}

// Jobs change what is recognised, which two engines must not share.
static_assert(!std::is_copy_constructible_v<SlamEngine>);
static_assert(std::is_move_constructible_v<SlamEngine>);

TEST(SlamEngine, closesFarLoopsBySignaturesOnly) {
  const SlamEngine engine = mapped(LoopClosureMode::kSignatures);
  const SlamCounters& c = engine.counters();
  EXPECT_GT(c.signatures.tried, 0U);
  EXPECT_GT(c.signatures.accepted, 0U);
  EXPECT_EQ(c.far.tried + c.words.tried, 0U);
  EXPECT_TRUE(engine.matches().empty());
  EXPECT_LT(trajectoryError(engine.trajectory(), building().ground_truth).rms, 0.15);
}

TEST(SlamEngine, asksASavedMapForNewPlacesOnly) {
  SlamParams params;
  params.loops = LoopClosureMode::kSignatures;
  SlamEngine first(params);
  feed(&first, building(), 0, 900);
  finish(&first);
  SlamEngine second(params, first.state());
  const auto saved = static_cast<int>(second.keyframes().size());
  bool made = false;
  while (const auto job = second.takeFinalJob()) {
    made = made || !job->keyframes.empty();
    const SlamJobResult result = runJob(*job);
    EXPECT_TRUE(result.candidates.empty());
    second.apply(result);
  }
  EXPECT_TRUE(made);
  bool asked = false;
  for (std::size_t i = 900; i < std::min<std::size_t>(2200, building().scans.size()); ++i) {
    const auto& scan = building().scans[i];
    second.add(scan, *hyselam::poseAt(building().odometry, scan.stamp, 1.0));
    while (const auto job = second.takeJob()) {
      const SlamJobResult result = runJob(*job);
      for (const SignatureCandidate& candidate : result.candidates) {
        EXPECT_GE(candidate.keyframe_newer, saved);
        asked = true;
      }
      second.apply(result);
    }
  }
  EXPECT_TRUE(asked);
}

TEST(SlamEngine, givesTheSameMapForTheSameInput) {
  const SlamEngine a = mapped(LoopClosureMode::kAll, 900), b = mapped(LoopClosureMode::kAll, 900);
  ASSERT_EQ(a.keyframes().size(), b.keyframes().size());
  ASSERT_EQ(a.loops().size(), b.loops().size());
  for (std::size_t i = 0; i < a.keyframes().size(); ++i) {
    EXPECT_EQ(a.keyframes()[i].pose.x, b.keyframes()[i].pose.x);
    EXPECT_EQ(a.keyframes()[i].pose.y, b.keyframes()[i].pose.y);
    EXPECT_EQ(a.keyframes()[i].pose.theta, b.keyframes()[i].pose.theta);
  }
}

TEST(SlamEngine, acceptsWordsWithoutVerificationInThesisMode) {
  const SlamEngine engine = mapped(LoopClosureMode::kThesis);
  std::size_t edges = 0;
  for (const SlamLoop& l : engine.loops()) {
    EXPECT_EQ(l.source, LoopSource::kNgram);
    EXPECT_EQ(l.measured.x, 0.0);
    EXPECT_EQ(l.measured.y, 0.0);
    EXPECT_TRUE(l.measured.theta == 0.0 || l.measured.theta == hyselam::kPi);
    EXPECT_EQ(l.information, engine.loops().front().information);
    ++edges;
  }
  EXPECT_GT(edges, 0U);
  const SlamParams thesis = SlamParams::thesis(2);
  EXPECT_EQ(thesis.loops, LoopClosureMode::kThesis);
  EXPECT_EQ(thesis.words.matcher.min_n, (std::vector<int>{7, 10}));
  EXPECT_NO_THROW(thesis.validate());
  EXPECT_EQ(engine.counters().near.tried + engine.counters().far.tried, 0U);
}

TEST(SlamEngine, buildsAChainWithoutLoops) {
  const SlamEngine engine = mapped(LoopClosureMode::kNone, 600);
  EXPECT_TRUE(engine.loops().empty());
  EXPECT_EQ(engine.graph().edges.size() + 1, engine.keyframes().size());
  EXPECT_NO_THROW(engine.graph().validate());
}

TEST(SlamEngine, continuesFromAStateInTheSameMap) {
  SlamParams params;
  SlamEngine first(params);
  const std::size_t half = 700;
  feed(&first, building(), 0, half);
  finish(&first);
  SlamEngine second(params, first.state());
  EXPECT_EQ(second.keyframes().size(), first.keyframes().size());
  EXPECT_EQ(second.recognizer().observations().size(), first.recognizer().observations().size());
  feed(&second, building(), half, half + 300);
  EXPECT_EQ(second.keyframes().back().run, 1U);
  const TrajectoryError e = trajectoryError(second.trajectory(), building().ground_truth);
  EXPECT_LT(e.rms, 0.15);
  EXPECT_LT(e.max, 0.5);
}

TEST(SlamEngine, refusesAStateWhosePartsDoNotFit) {
  SlamEngine engine = mapped(LoopClosureMode::kAll, 100);
  SlamState state = engine.state();
  state.scans.push_back({1e6, 100000, {}});
  EXPECT_THROW(SlamEngine(SlamParams{}, state), hyselam::InputError);
  state = engine.state();
  state.keyframe_of_observation.push_back(0);
  EXPECT_THROW(SlamEngine(SlamParams{}, state), hyselam::InputError);
  state = engine.state();
  state.keyframes[3].scan.reset();
  EXPECT_THROW(SlamEngine(SlamParams{}, state), hyselam::InputError);
}

TEST(SlamEngine, refusesUnusableScansAndContinues) {
  SlamEngine engine;
  feed(&engine, building(), 0, 50);
  const std::size_t keyframes = engine.keyframes().size();
  const auto& scan = building().scans[60];
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(engine.add(building().scans[20], engine.pose()), hyselam::InputError);
  EXPECT_THROW(engine.add(scan, Pose2{nan, 0, 0}), hyselam::InputError);
  hyselam::LaserScan bad = scan;
  bad.angle_increment = 0.0;
  EXPECT_THROW(engine.add(bad, engine.pose()), hyselam::InputError);
  bad = scan;
  bad.laser_in_base.x = 6.0;  // not on the map that words are measured on
  EXPECT_THROW(engine.add(bad, engine.pose()), hyselam::InputError);
  EXPECT_THROW(engine.add(scan, Pose2{1e9, 0, 0}), hyselam::InputError);
  bad = scan;
  bad.stamp = nan;
  EXPECT_THROW(engine.add(bad, engine.pose()), hyselam::InputError);
  EXPECT_EQ(engine.counters().scans, 50U);
  EXPECT_EQ(engine.keyframes().size(), keyframes);
  feed(&engine, building(), 50, 120);
  EXPECT_EQ(engine.counters().scans, 120U);
}

TEST(SlamEngine, standsWhenTheOdometryJumps) {
  SlamEngine engine;
  feed(&engine, building(), 0, 50);
  const Pose2 before = engine.pose();
  const auto& scan = building().scans[50];
  const SlamUpdate update =
      engine.add(scan, *hyselam::poseAt(building().odometry, scan.stamp) * Pose2{50.0, 0.0, 0.0});
  EXPECT_TRUE(update.odometry_jump);
  EXPECT_LT(distance(before, engine.pose()), 1.0);
}

TEST(SlamEngine, handlesEmptyScansAndAnEmptyLog) {
  SlamEngine nothing;
  finish(&nothing);
  EXPECT_TRUE(nothing.trajectory().empty());
  EXPECT_TRUE(nothing.graph().poses.empty());
  SlamEngine blind;
  hyselam::LaserScan scan = building().scans[0];
  for (int i = 0; i < 100; ++i) {
    scan.stamp = 1.0 + i;
    scan.ranges.assign(scan.ranges.size(), std::numeric_limits<float>::infinity());
    blind.add(scan, Pose2{0.1 * i, 0.0, 0.0});
  }
  finish(&blind);
  EXPECT_NEAR(blind.pose().x, 9.9, 1e-6);  // odometry alone
}

TEST(SlamEngine, correctsTheDriftByMapToOdom) {
  const SlamEngine& engine = withAllLoops();
  const auto& last = building().scans.back();
  const Pose2 pose = engine.odomInMap() * *hyselam::poseAt(building().odometry, last.stamp, 1.0);
  EXPECT_NEAR(distance(pose, engine.pose()), 0.0, 1e-9);
  // The map begins where odometry is at the first scan.
  const auto& first = building().scans.front();
  const auto truth = [](double stamp) {
    return *hyselam::poseAt(building().ground_truth, stamp, 1.0);
  };
  const Pose2 expected = *hyselam::poseAt(building().odometry, first.stamp, 1.0) *
                         between(truth(first.stamp), truth(last.stamp));
  EXPECT_LT(distance(pose, expected), 0.5);
  EXPECT_GT(distance(*hyselam::poseAt(building().odometry, last.stamp, 1.0), expected), 1.0);
}

TEST(SlamEngine, runsJobsWhileScansAreAdded) {
  // A job is out for many scans; what is applied late must not distort the path.
  SlamEngine engine;
  std::optional<SlamJob> job;
  const auto& log = building();
  for (std::size_t i = 0; i < 1500 && i < log.scans.size(); ++i) {
    engine.add(log.scans[i], *hyselam::poseAt(log.odometry, log.scans[i].stamp, 1.0));
    if (!job) {
      job = engine.takeJob();
    } else if (i % 25 == 0) {
      EXPECT_FALSE(engine.takeJob());  // one at a time
      engine.apply(runJob(*job));
      job.reset();
    }
  }
  if (job) engine.apply(runJob(*job));
  finish(&engine);
  EXPECT_LT(trajectoryError(engine.trajectory(), log.ground_truth).rms, 0.15);
}

TEST(SlamEngine, assignsWeightsToTheirLoopsWhenARunBeganMeanwhile) {
  SlamEngine engine;
  const auto& log = building();
  std::optional<SlamJob> job;
  std::size_t i = 0;
  const auto add = [&] {
    engine.add(log.scans[i], *hyselam::poseAt(log.odometry, log.scans[i].stamp, 1.0));
    ++i;
  };
  while (i + 1 < log.scans.size() && !(job && job->graph)) {
    if (job) engine.apply(runJob(*job));
    add();
    job = engine.takeJob();
  }
  ASSERT_TRUE(job && job->graph);
  const std::size_t loops = engine.loops().size();
  engine.startRun(engine.pose(), 1.0, 0.5, RunTrust::kKnown);
  add();
  ASSERT_EQ(engine.loops().size(), loops + 1);  // the edge to the run before
  SlamJobResult result = runJob(*job);
  // Each edge its own weight.
  std::vector<double>& weights = result.optimized->weights;
  ASSERT_EQ(weights.size(), job->graph->edges.size());
  for (std::size_t k = 0; k < weights.size(); ++k) weights[k] = 0.5 + 1e-6 * static_cast<double>(k);
  engine.apply(result);
  for (std::size_t k = 0; k < loops; ++k)
    EXPECT_EQ(engine.loops()[k].weight, weights[weights.size() - loops + k]);
  EXPECT_EQ(engine.loops().back().weight, 1.0);  // not optimized yet
}

TEST(SlamEngine, ignoresLateVerificationsOfReplacedMatches) {
  SlamEngine engine;
  feed(&engine, building(), 0, 300);
  const auto k = static_cast<int>(engine.keyframes().size()) - 1;
  SlamState state = engine.state();
  SlamMatch match;
  match.keyframe_older = 1;
  match.keyframe_newer = k;
  state.matches.assign(1, match);
  SlamEngine second(engine.params(), state);
  SlamJobResult late;
  LoopTask task;
  task.source = LoopSource::kNgram;
  task.match = 0;
  task.older = 2;
  task.newer = k;
  LoopVerification answer;
  answer.verified = true;
  answer.loop.older = task.older;
  answer.loop.newer = task.newer;
  answer.loop.information.setIdentity();
  late.tasks.push_back(task);
  late.verifications.push_back(answer);
  second.apply(late);
  EXPECT_FALSE(second.matches().front().verified);
  late.tasks.front().older = late.verifications.front().loop.older = 1;
  second.apply(late);
  EXPECT_TRUE(second.matches().front().verified);
}

TEST(SlamEngine, refusesStartsThatCannotBeSearched) {
  SlamEngine engine;
  feed(&engine, building(), 0, 50);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(engine.startRun({nan, 0, 0}), hyselam::ParameterError);
  EXPECT_THROW(engine.startRun({}, 0.0), hyselam::ParameterError);
  EXPECT_THROW(engine.startRun({}, 1e6), hyselam::ParameterError);
  EXPECT_THROW(engine.startRun({}, 1.0, 4.0), hyselam::ParameterError);
  feed(&engine, building(), 50, 60);
  EXPECT_EQ(engine.keyframes().back().run, 0U);  // the run went on
}

TEST(RegionGraph, containsEveryObservationAndConnectsLoops) {
  const SlamEngine& engine = withAllLoops();
  const RegionGraph graph = regionGraph(engine);
  ASSERT_FALSE(graph.nodes.empty());
  std::uint32_t next = 0;
  for (const RegionNode& n : graph.nodes) {
    EXPECT_EQ(n.first, next);
    next = n.last + 1;
  }
  EXPECT_EQ(next, engine.recognizer().observations().size());
  std::size_t loops = 0;
  for (const RegionEdge& e : graph.edges) {
    EXPECT_LT(e.a, e.b);
    EXPECT_LT(e.b, graph.nodes.size());
    if (e.kind == RegionEdge::Kind::kLoop) ++loops;
  }
  EXPECT_GT(loops, 0U);
  const RegionGraph spaced = spacedGraph(engine, 2.0);
  EXPECT_GT(spaced.nodes.size(), graph.nodes.size());
  for (const RegionNode& n : spaced.nodes) EXPECT_LT(n.length, 2.5);
  EXPECT_THROW(spacedGraph(engine, 0.0), hyselam::ParameterError);
}

TEST(SlamParams, namesTheParameterOutOfRange) {
  SlamParams p;
  p.keyframe_step = -1.0;
  EXPECT_NE(hyselam::testing::messageOf<hyselam::ParameterError>([&] {
              SlamEngine engine(p);
            }).find("keyframe_step"),
            std::string::npos);
  p = {};
  p.loop.far_min_surface_ratio = 2.0;
  EXPECT_THROW(p.validate(), hyselam::ParameterError);
  p = {};
  p.loop.far_resolution = 0.01;  // ObservedSpace would have too many cells
  EXPECT_THROW(p.validate(), hyselam::ParameterError);
}

TEST(SlamEngine, mapsARealLog) {
  HYSELAM_NEED_DATA(data);
  hyselam::RobotLog log = hyselam::readCarmenLog(data + "/laser/intel/intel.log.gz");
  log.scans.resize(3500);
  SlamEngine engine;
  feed(&engine, log, 0, log.scans.size());
  finish(&engine);
  const auto reference = hyselam::readReferenceTable(data + "/laser/intel/intel.reference.txt.gz");
  EXPECT_LT(trajectoryError(engine.trajectory(), reference).rms, 0.15);
  EXPECT_GT(trajectoryError(log.odometry, reference).rms, 0.5);
}

}  // namespace
}  // namespace ngram_slam
