#include "slam_run.hpp"

#include <utility>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/progress.hpp"
#include "ngram_slam/slam/background_jobs.hpp"
#include "ngram_slam/slam/consolidation.hpp"
#include "ngram_slam/slam/slam_state_io.hpp"
#include "tool_parts.hpp"

namespace ngram_slam {

std::unique_ptr<SlamEngine> makeEngine(const SlamOfflineOptions& o, const SlamParams& params) {
  if (o.state.empty()) return std::make_unique<SlamEngine>(params);
  SlamState state = SlamStateFile::load(o.state, params.surface);
  auto engine =
      std::make_unique<SlamEngine>(params, consolidated(std::move(state), params.consolidation));
  if (o.start == "unknown") {
    engine->startRunAnywhere();
  } else if (!o.start.empty()) {
    engine->startRun(parseStart(o.start));
  }
  return engine;
}

SlamRun runSlam(const hyselam::RobotLog& log, std::unique_ptr<SlamEngine> engine,
                const std::string& label) {
  const double begin = cpuSeconds();
  SlamRun run;
  run.engine = std::move(engine);
  run.saved_scans = run.engine->trajectory().size();
  run.saved_keyframes = run.engine->keyframes().size();
  run.saved_counts = run.engine->counters().scans;
  BackgroundJobs jobs(run.engine->params().loop_latency);
  hyselam::Progress progress(label, log.scans.size());
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    progress.update(i + 1);
    const auto odometry = hyselam::poseAt(log.odometry, log.scans[i].stamp, 0.2);
    if (!odometry) {
      ++run.without_odometry;
      continue;
    }
    const double stamp = log.scans[i].stamp;
    while (!jobs.takeIn(stamp, run.engine.get())) jobs.runHere();
    try {
      run.engine->add(log.scans[i], *odometry);
      jobs.noteScan(stamp, run.engine.get());
    } catch (const hyselam::InputError&) {
      ++run.refused;
    }
  }
  jobs.runAll(run.engine.get());
  run.engine->endRun();
  while (const auto job = run.engine->takeFinalJob()) run.engine->apply(runJob(*job));
  run.cpu = cpuSeconds() - begin;
  return run;
}

void checkMapped(const SlamRun& run, const std::string& name, std::size_t scans) {
  if (!run.engine->keyframes().empty()) return;
  throw hyselam::InputError(name, "",
                            "gives no map: of " + std::to_string(scans) + " scans " +
                                std::to_string(run.without_odometry) + " have no odometry, " +
                                std::to_string(run.refused) + " cannot be used");
}

std::vector<hyselam::StampedPose2> ownTrajectory(const SlamRun& run) {
  auto all = run.engine->trajectory();
  all.erase(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(run.saved_scans));
  return all;
}

std::optional<LaserMount> mountOf(const SlamRun& run) {
  const auto& all = run.engine->keyframes();
  return estimateLaserMount(
      {all.begin() + static_cast<std::ptrdiff_t>(run.saved_keyframes), all.end()});
}

PresentMap mapOf(const SlamEngine& engine, const SlamOfflineOptions& o) {
  PresentMap map(mapParamsOf(o), engine.params().consolidation.present);
  map.update({engine.keyframes(), engine.settled(), engine.shownRuns(), engine.firstRunOfSession(),
              engine.revision()});
  return map;
}

}  // namespace ngram_slam
