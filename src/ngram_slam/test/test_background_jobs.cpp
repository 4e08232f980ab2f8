#include <gtest/gtest.h>

#include <string>

#include "hyselam_common/rng.hpp"
#include "hyselam_common/testing/files.hpp"
#include "ngram_slam/slam/background_jobs.hpp"
#include "ngram_slam/slam/slam_state_io.hpp"
#include "visits.hpp"

namespace ngram_slam {
namespace {

using hyselam::Rng;

const hyselam::RobotLog& round() {
  static const hyselam::RobotLog log = visit(11, 2, {});
  return log;
}

SlamParams params() {
  SlamParams p;
  p.loops = LoopClosureMode::kAll;
  return p;
}

void add(std::size_t i, SlamEngine* engine) {
  const auto& scan = round().scans[i];
  engine->add(scan, *hyselam::poseAt(round().odometry, scan.stamp, 1.0));
}

/// Everything that is kept of a map, as bytes.
std::string bytes(const SlamEngine& engine) {
  const hyselam::testing::TemporaryDirectory folder;
  SlamStateFile::save(folder / "slam.state", engine.state());
  return hyselam::testing::fileBytes(folder / "slam.state");
}

/// How a machine does its work.
struct Machine {
  /// Scans from the one behind which a job is made to the one before which it is done: at random,
  /// from 0 to this.
  int slowest = 0;
  std::uint64_t seed = 1;
};

/// As a nodelet does it, with a machine that gets to a job when it likes; a scan at which a result
/// counts waits for it.
SlamEngine live(const Machine& machine, double latency, std::size_t end) {
  SlamEngine engine(params());
  BackgroundJobs jobs(latency);
  Rng rng(machine.seed);
  std::optional<SlamJob> at_work;
  int left = 0;
  const auto work = [&] {
    if (!at_work) {
      at_work = jobs.begin();
      left = static_cast<int>(rng.uniform(0.0, machine.slowest + 1.0));
    }
    if (at_work && left-- <= 0) {
      jobs.finish(runJob(*at_work));
      at_work.reset();
    }
  };
  for (std::size_t i = 0; i < end; ++i) {
    work();
    while (!jobs.takeIn(round().scans[i].stamp, &engine)) work();
    add(i, &engine);
    jobs.noteScan(round().scans[i].stamp, &engine);
  }
  return engine;
}

/// As a tool does it.
SlamEngine offline(double latency, std::size_t end) {
  SlamEngine engine(params());
  BackgroundJobs jobs(latency);
  for (std::size_t i = 0; i < end; ++i) {
    while (!jobs.takeIn(round().scans[i].stamp, &engine)) jobs.runHere();
    add(i, &engine);
    jobs.noteScan(round().scans[i].stamp, &engine);
  }
  return engine;
}

TEST(BackgroundJobs, giveEqualMapsHoweverBusyTheMachineIs) {
  const std::size_t end = round().scans.size();
  const SlamEngine expected = offline(1.0, end);
  EXPECT_GT(expected.loops().size(), 5U);
  EXPECT_GT(expected.counters().optimizations, 0U);
  const std::string map = bytes(expected);
  EXPECT_TRUE(bytes(live({0, 1}, 1.0, end)) == map) << "of a fast machine";
  EXPECT_TRUE(bytes(live({3, 2}, 1.0, end)) == map) << "of one that is nearly in time";
  EXPECT_TRUE(bytes(live({40, 3}, 1.0, end)) == map) << "of one that scans wait for";
}

TEST(BackgroundJobs, giveAnotherMapWhereResultsCountWhenTheyAreThere) {
  // What the latency is for: without it, a result counts at the scan before which it is done.
  const auto at_once = [](const Machine& machine, std::size_t end) {
    SlamEngine engine(params());
    Rng rng(machine.seed);
    std::optional<SlamJob> job;
    int left = 0;
    for (std::size_t i = 0; i < end; ++i) {
      if (job && left-- <= 0) {
        engine.apply(runJob(*job));
        job.reset();
      }
      add(i, &engine);
      if (!job && (job = engine.takeJob())) {
        left = static_cast<int>(rng.uniform(0.0, machine.slowest + 1.0));
      }
    }
    return bytes(engine);
  };
  const std::size_t end = round().scans.size();
  EXPECT_FALSE(at_once({0, 1}, end) == at_once({8, 2}, end));
}

TEST(BackgroundJobs, countBeforeTheNextScanWithoutLatency) {
  const std::size_t end = round().scans.size() / 2;
  SlamEngine expected(params());
  for (std::size_t i = 0; i < end; ++i) {
    while (const auto job = expected.takeJob()) expected.apply(runJob(*job));
    add(i, &expected);
  }
  EXPECT_TRUE(bytes(offline(0.0, end)) == bytes(expected));
}

/// An engine with a job that is out since the scan `at`.
struct Busy {
  SlamEngine engine{params()};
  BackgroundJobs jobs{1.0};
  std::size_t at = 0;
  Busy() {
    for (;; ++at) {
      const double stamp = round().scans.at(at).stamp;
      while (!jobs.takeIn(stamp, &engine)) jobs.runHere();
      add(at, &engine);
      jobs.noteScan(stamp, &engine);
      if (jobs.isOut()) return;
    }
  }
  double stamp() const { return round().scans[at].stamp; }
};

TEST(BackgroundJobs, countAfterTheirLatency) {
  Busy busy;
  EXPECT_TRUE(busy.jobs.takeIn(busy.stamp() + 0.99, &busy.engine));
  EXPECT_TRUE(busy.jobs.isOut());
  EXPECT_FALSE(busy.jobs.takeIn(busy.stamp() + 1.0, &busy.engine)) << "nobody has done it";
  busy.jobs.runHere();
  EXPECT_TRUE(busy.jobs.takeIn(busy.stamp() + 0.99, &busy.engine)) << "done, but too early";
  EXPECT_TRUE(busy.jobs.isOut());
  EXPECT_TRUE(busy.jobs.takeIn(busy.stamp() + 1.0, &busy.engine));
}

TEST(BackgroundJobs, countAtOnceAfterAPauseAndWhereTimeGoesBack) {
  for (const double step : {BackgroundJobs::kPause, -0.5}) {
    Busy busy;
    const double stamp = busy.stamp() + step;
    int jobs = 0;
    for (; !busy.jobs.takeIn(stamp, &busy.engine); ++jobs) busy.jobs.runHere();
    EXPECT_GT(jobs, 0);
    EXPECT_FALSE(busy.jobs.isOut()) << "also what the first one leads to";
    EXPECT_FALSE(busy.engine.takeJob());
  }
}

TEST(BackgroundJobs, thatAreLateWhereTimeGoesBackCountSoonAfter) {
  Busy busy;
  const double back = busy.stamp() - 500.0;
  EXPECT_FALSE(busy.jobs.takeIn(back, &busy.engine));
  busy.jobs.noteScan(back, &busy.engine);  // without it
  EXPECT_TRUE(busy.jobs.takeIn(back + 0.9, &busy.engine));
  EXPECT_FALSE(busy.jobs.takeIn(back + 1.0, &busy.engine)) << "not when time is there again";
  busy.jobs.runHere();
  EXPECT_TRUE(busy.jobs.takeIn(back + 1.0, &busy.engine));
}

TEST(BackgroundJobs, areOneForAllKindsOfWork) {
  // Verifications come up at every turn: whatever waited behind them would wait for ever.
  SlamEngine engine(params());
  for (std::size_t i = 0; i < round().scans.size(); ++i) add(i, &engine);
  const auto job = engine.takeAllWork();
  ASSERT_TRUE(job);
  EXPECT_FALSE(engine.takeAllWork()) << "one at a time";
  EXPECT_GT(job->tasks.size(), 0U);
  EXPECT_GE(job->keyframes.size() + 1, engine.keyframes().size());
  engine.apply(runJob(*job));
  EXPECT_GT(engine.loops().size(), 0U);
  const auto next = engine.takeAllWork();
  ASSERT_TRUE(next);
  EXPECT_TRUE(next->graph) << "of the loops that the first one found";
}

TEST(BackgroundJobs, areAllDoneWithoutScansOnRequest) {
  Busy busy;
  EXPECT_FALSE(busy.jobs.takeInNow(&busy.engine)) << "it has not been run";
  busy.jobs.runAll(&busy.engine);
  EXPECT_FALSE(busy.jobs.isOut());
  EXPECT_FALSE(busy.jobs.takeInNow(&busy.engine));
  EXPECT_FALSE(busy.engine.takeJob());
}

TEST(BackgroundJobs, ofASavedMapCountBeforeTheFirstScan) {
  SlamEngine first = offline(1.0, round().scans.size() / 2);
  SlamEngine engine(params(), first.state());
  BackgroundJobs jobs(1.0);
  const double stamp = round().scans.front().stamp;
  int run = 0;
  for (; !jobs.takeIn(stamp, &engine); ++run) jobs.runHere();
  EXPECT_GT(run, 0) << "its keyframes have no signatures yet";
  EXPECT_FALSE(jobs.isOut());
}

}  // namespace
}  // namespace ngram_slam
