// What the SLAM server does besides adding scans: one thread for loops and poses, one for maps and
// savings.
#include <chrono>
#include <utility>

#include "ngram_slam/ros/slam_server.hpp"
#include "wall_milliseconds.hpp"

namespace ngram_slam {

using Lock = std::unique_lock<std::mutex>;

namespace {

constexpr double kSaveCheckPeriod = 0.1;  // [s] of wall time: how often a saving may become due
constexpr double kIdleCheckPeriod = 0.1;  // [s] of wall time: how often scans may have ended

}  // namespace

// ---- loops and optimization

/// Applies the results that count before a scan of this stamp. False: one is not there. With mutex_
/// held.
bool SlamServer::takeIn(double stamp) {
  try {
    return mapping_->jobs.takeIn(stamp, &mapping_->engine);
  } catch (const std::exception& e) {
    noteJobError(e.what());
    return true;
  }
}

/// With mutex_ held.
bool SlamServer::takeInNow() {
  try {
    return mapping_->jobs.takeInNow(&mapping_->engine);
  } catch (const std::exception& e) {
    noteJobError(e.what());
    return false;
  }
}

/// With mutex_ held.
void SlamServer::noteJobError(const std::string& error) {
  status_.job_error = error;
  ROS_ERROR_STREAM(log_name_ << " loops are not added: " << error);
}

/// The scan at which results count waits for them.
bool SlamServer::isHeldUp(const ros::Time& stamp) {
  const Lock lock(mutex_);
  if (paused_) return false;
  const ros::WallTime now = ros::WallTime::now();
  last_scan_came_ = now;
  const bool there = takeIn(stamp.toSec());
  work_.notify_all();
  using Wait = hyselam::ResultWait;
  const auto verdict = result_wait_.ask(there, now);
  if (verdict != Wait::Verdict::kGivenUp) return verdict == Wait::Verdict::kWait;
  ROS_WARN_STREAM_THROTTLE(
      30.0, log_name_ << " loops or an optimization have taken longer than loop_latency, "
                      << params_.slam.loop_latency << " s, and loop_wait, " << params_.loop_wait
                      << " s: the machine is too slow, or the map too large. They count when they"
                      << " are done; the same scans may give another map");
  return false;
}

/// Nothing comes that results would have to wait for. With mutex_ held.
bool SlamServer::isIdle() const {
  return paused_ || last_scan_came_.isZero() ||
         (ros::WallTime::now() - last_scan_came_).toSec() >= BackgroundJobs::kPause;
}

void SlamServer::runJobs() {
  Lock lock(mutex_);
  while (!ending_) {
    if (isIdle() && takeInNow()) map_due_ = map_due_ || (drawsMaps() && mapping_->localized);
    const auto job = mapping_->jobs.begin();
    if (!job) {
      work_.wait_for(lock, std::chrono::duration<double>(kIdleCheckPeriod));
      continue;
    }
    const long epoch = epoch_;
    lock.unlock();
    const ros::WallTime begin = ros::WallTime::now();
    SlamJobResult result;
    std::string error;
    try {
      result = runJob(*job);
    } catch (const std::exception& e) {
      error = e.what();
    }
    lock.lock();
    if (epoch != epoch_) continue;
    mapping_->jobs.finish(std::move(result));
    status_.job_error.clear();
    if (!error.empty()) noteJobError(error);
    status_.job_ms = millisecondsSince(begin);
  }
}

// ---- maps and savings

/// Waits a moment for a map to become due; nothing if none did.
std::optional<SlamServer::MapRequest> SlamServer::awaitMapRequest() {
  Lock lock(mutex_);
  work_.wait_for(lock, std::chrono::duration<double>(kSaveCheckPeriod),
                 [this] { return map_due_ || ending_; });
  if (!map_due_ || ending_) return std::nullopt;
  map_due_ = false;
  const SlamEngine& engine = mapping_->engine;
  MapRequest request;
  request.keyframes = engine.keyframes();
  request.loops = engine.loops();
  request.graph = regionGraph(engine, mapping_->regions);
  request.header = header(params_.global_frame_id);
  request.shown = engine.shownRuns();
  request.settled = engine.settled();
  request.session = engine.firstRunOfSession();
  request.knows_changes = engine.knowsChanges();
  request.revision = engine.revision();
  request.epoch = epoch_;
  return request;
}

void SlamServer::drawMap(const MapRequest& request, PresentMap* mapper) {
  const ros::WallTime begin = ros::WallTime::now();
  std::string error;
  const auto attempt = [&](const auto& work) {
    try {
      work();
    } catch (const std::exception& e) {
      error = e.what();
      ROS_ERROR_STREAM_THROTTLE(10.0, log_name_ << " the map is not complete: " << error);
    }
  };
  attempt([&] {
    mapper->update(
        {request.keyframes, request.settled, request.shown, request.session, request.revision});
  });
  std::string changes;
  attempt([&] {  // what fits
    const PresentMap::Drawn drawn = mapper->draw();
    changes = summaryOf(drawn.changes, request.knows_changes);
    publisher_.publishMap(drawn, request.keyframes, request.shown, request.loops, request.graph,
                          request.header);
  });
  const Lock lock(mutex_);
  status_.map_error = error;
  status_.changes = changes;
  status_.map_ms = millisecondsSince(begin);
}

void SlamServer::runMapper() {
  const auto emptyMap = [this] {
    return PresentMap(params_.map, params_.slam.consolidation.present);
  };
  PresentMap mapper = emptyMap();
  long epoch = -1;
  ros::WallTime saved = ros::WallTime::now();
  const auto isEnding = [this] {
    const Lock lock(mutex_);
    return ending_;
  };
  while (!isEnding()) {
    if (const auto request = awaitMapRequest()) {
      if (epoch != request->epoch) mapper = emptyMap();
      epoch = request->epoch;
      if (!request->keyframes.empty()) drawMap(*request, &mapper);
    }
    changeSession();
    if (!params_.state.empty() && params_.save_period > 0.0 &&
        (ros::WallTime::now() - saved).toSec() >= params_.save_period) {
      saveIfChanged("now and then");
      saved = ros::WallTime::now();
    }
  }
}

}  // namespace ngram_slam
