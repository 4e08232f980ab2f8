// Sessions of the SLAM server that end while the robot drives, so that its map stays as large as
// the building. On the thread that draws maps: scans are added meanwhile, to the session that ends,
// and once more to the next one.
#include <malloc.h>

#include <chrono>
#include <stdexcept>
#include <utility>

#include "ngram_slam/ros/slam_server.hpp"
#include "wall_milliseconds.hpp"

namespace ngram_slam {

using Lock = std::unique_lock<std::mutex>;

namespace {

constexpr double kCheckPeriod = 0.1;      // [s] of wall time between looks for a scan
constexpr std::size_t kFewScans = 10;     // added while others wait
constexpr std::size_t kMostScans = 5000;  // of a machine that is too slow to add them all

}  // namespace

/// With mutex_ held.
bool SlamServer::isSessionOver() const {
  const SlamEngine& engine = mapping_->engine;
  return params_.session_path > 0.0 && mapping_->localized && !paused_ && !initial_pose_ &&
         next_scan_ == NextScan::kGoesOn && engine.runPlace() != RunPlace::kSupposed &&
         engine.keyframes().back().path_length >= mapping_->session_end;
}

/// Slow. Its pending work is done: the first scans do not wait for it.
std::unique_ptr<SlamServer::Mapping> SlamServer::nextSession(SlamState state) const {
  auto next = std::make_unique<Mapping>(params_,
                                        consolidated(std::move(state), params_.slam.consolidation));
  next->jobs.runAll(&next->engine);
  next->requantizations = -1;  // who listens gets all words anew: others have gone
  return next;
}

/// Adds what came since the copy and puts the next session in the place of this one. False: the
/// copy is void. @throws std::runtime_error if they are too many.
bool SlamServer::goOnWith(std::unique_ptr<Mapping>* next) {
  Mapping& n = **next;
  std::vector<LaterScan> scans;
  // With the loops that count before each, as offline: unless others wait, where they come later.
  const auto addScans = [&](bool others_wait) {
    for (const LaterScan& s : scans) {
      if (!n.localized) n.engine.startRunByOdometry(s.odometry);
      while (!n.jobs.takeIn(s.scan.stamp, &n.engine) && !others_wait) n.jobs.runHere();
      n.engine.add(s.scan, s.odometry);
      n.jobs.noteScan(s.scan.stamp, &n.engine);
      n.localized = true;
    }
    scans.clear();
  };
  while (true) {
    {
      Lock lock(mutex_);
      work_.wait_for(lock, std::chrono::duration<double>(kCheckPeriod), [&] {
        return ending_ || !later_scans_ || n.localized || !later_scans_->empty();
      });
      if (ending_ || !later_scans_) return false;
      std::swap(scans, *later_scans_);
      if (scans.size() > kMostScans) {
        throw std::runtime_error(
            "its end takes too long: the machine is too slow, or the map too large");
      }
      if (n.localized && scans.size() <= kFewScans) {
        addScans(true);
        n.saved_scans = mapping_->saved_scans;
        std::swap(mapping_, *next);
        later_scans_.reset();
        result_wait_.forget();
        ++epoch_;
        map_due_ = drawsMaps();
        return true;
      }
    }
    addScans(false);
  }
}

void SlamServer::changeSession() {
  SlamState state;
  {
    const Lock lock(mutex_);
    if (!isSessionOver()) return;
    state = mapping_->engine.state();
    later_scans_.emplace();
  }
  const ros::WallTime begin = ros::WallTime::now();
  const std::size_t keyframes = state.keyframes.size();
  std::unique_ptr<Mapping> next;
  std::string error;
  try {
    next = nextSession(std::move(state));
    if (!goOnWith(&next)) return;
  } catch (const std::exception& e) {
    error = e.what();
    ROS_ERROR_STREAM(log_name_ << " the session goes on: " << error);
  }
  next.reset();
  // Thousands of keyframes went, out of many threads' arenas, which would keep their room.
  malloc_trim(0);
  const Lock lock(mutex_);
  status_.session_error = error;
  status_.session_ms = millisecondsSince(begin);
  if (!error.empty()) {
    later_scans_.reset();
    mapping_->session_end += params_.session_path;
    return;
  }
  ++status_.sessions_ended;
  ROS_INFO_STREAM(log_name_ << " a session has ended: " << keyframes << " keyframes, now "
                            << mapping_->engine.keyframes().size());
}

}  // namespace ngram_slam
