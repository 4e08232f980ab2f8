// Services, states and diagnostics of the SLAM server.
#include <memory>
#include <utility>

#include "hyselam_common/errors.hpp"
#include "ngram_slam/ros/slam_server.hpp"
#include "ngram_slam/slam/slam_state_io.hpp"
#include "wall_milliseconds.hpp"

namespace ngram_slam {

using hyselam::addRemark;
using hyselam::addValue;
using Lock = std::unique_lock<std::mutex>;
using Status = diagnostic_msgs::DiagnosticStatus;

bool SlamServer::onMap(nav_msgs::GetMap::Response& out) {
  const Lock lock(map_mutex_);
  if (map_) out.map = *map_;
  return map_.has_value();
}

/// @returns what was written. @throws hyselam::InputError
std::string SlamServer::save(const std::string& path) {
  const Lock saving(save_mutex_);
  SlamState state;
  long epoch = 0;
  {
    const Lock lock(mutex_);
    state = mapping_->engine.state();
    epoch = epoch_;
  }
  const ros::WallTime begin = ros::WallTime::now();
  SlamStateFile::save(path, state);
  const Lock lock(mutex_);
  save_ms_ = millisecondsSince(begin);
  if (epoch == epoch_ && path == params_.state) mapping_->saved_scans = state.counters.scans;
  return path + ": " + std::to_string(state.keyframes.size()) + " keyframes, " +
         std::to_string(state.loops.size()) + " loops";
}

void SlamServer::saveNow(const char* when) {
  if (params_.state.empty()) return;
  {
    const Lock lock(mutex_);
    if (mapping_->saved_scans == mapping_->engine.counters().scans) return;
  }
  std::string error;
  try {
    save(params_.state);
  } catch (const std::exception& e) {
    error = e.what();
    ROS_ERROR_STREAM(who_ << " not saved (" << when << "): " << error);
  }
  const Lock lock(mutex_);
  save_error_ = error;
}

std::string SlamServer::pathOr(const std::string& given) const {
  if (given.empty() && params_.state.empty())
    throw hyselam::InputError("path", "", "none given, and the parameter state is empty");
  return given.empty() ? params_.state : given;
}

bool SlamServer::onSave(hyselam_msgs::StatePath::Request& request,
                        hyselam_msgs::StatePath::Response& out) {
  try {
    out.message = save(pathOr(request.path));
    out.success = true;
  } catch (const std::exception& e) {
    out.success = false;
    out.message = e.what();
    ROS_ERROR_STREAM(who_ << " not saved: " << e.what());
  }
  return true;
}

bool SlamServer::onLoad(hyselam_msgs::StatePath::Request& request,
                        hyselam_msgs::StatePath::Response& out) {
  try {
    const std::string path = pathOr(request.path);
    auto mapping =
        std::make_unique<Mapping>(params_, SlamStateFile::load(path, params_.slam.surface));
    out.message = path + ": " + std::to_string(mapping->engine.keyframes().size()) +
                  " keyframes, " + std::to_string(mapping->engine.loops().size()) + " loops";
    {
      const Lock lock(mutex_);
      std::swap(mapping_, mapping);
      ++epoch_;
      next_ = Next::kAfterPause;
      pending_.reset();
      map_due_ = drawsMaps();
    }
    work_.notify_all();
    out.success = true;
    ROS_INFO_STREAM(who_ << " loaded " << out.message);
  } catch (const std::exception& e) {
    out.success = false;
    out.message = e.what();
    ROS_ERROR_STREAM(who_ << " not loaded: " << e.what());
  }
  return true;
}

bool SlamServer::onPause(bool pause, std_srvs::Trigger::Response& out) {
  const Lock lock(mutex_);
  out.success = true;
  out.message = paused_ == pause ? (pause ? "paused already" : "was not paused")
                                 : (pause ? "paused" : "goes on");
  if (paused_ && !pause && next_ == Next::kGoOn && mapping_->localised) next_ = Next::kAfterPause;
  if (paused_ != pause) ROS_INFO_STREAM(who_ << ' ' << out.message);
  paused_ = pause;
  return true;
}

// ---- diagnostics

void SlamServer::report(Status& status) {
  input_->checkClock();
  {
    const Lock lock(mutex_);
    const SlamEngine& engine = mapping_->engine;
    const SlamCounters& c = engine.counters();
    addRemark(status, Status::OK,
              std::to_string(engine.keyframes().size()) + " keyframes, " +
                  std::to_string(engine.loops().size()) + " loops");
    if (paused_) addRemark(status, Status::WARN, "paused");
    if (!job_error_.empty()) addRemark(status, Status::ERROR, "optimisation: " + job_error_);
    if (!map_error_.empty()) addRemark(status, Status::ERROR, "map: " + map_error_);
    if (!save_error_.empty()) addRemark(status, Status::ERROR, "not saved: " + save_error_);
    addValue(status, "paused", paused_);
    addValue(status, "scans while paused", paused_scans_);
    addValue(status, "publishing tf", params_.tf_broadcast && mapping_->localised);
    addValue(status, "runs", engine.keyframes().empty() ? 0 : engine.keyframes().back().run + 1);
    addValue(status, "keyframes", engine.keyframes().size());
    addValue(status, "loops", engine.loops().size());
    addValue(status, "loops by words", c.words.accepted);
    addValue(status, "matches of words", engine.matches().size());
    addValue(status, "regions", mapping_->regions.size());
    addValue(status, "optimisations", c.optimisations);
    addValue(status, "scans that hardly matched", weak_);
    addValue(status, "odometry leapt", c.leaps);
    addValue(status, "last scan [ms]", scan_ms_);
    addValue(status, "slowest scan [ms]", worst_scan_ms_);
    addValue(status, "last loops and optimisation [ms]", job_ms_);
    addValue(status, "last map [ms]", map_ms_);
    if (!params_.state.empty()) {
      addValue(status, "state", params_.state);
      addValue(status, "scans not saved", c.scans - mapping_->saved_scans);
      addValue(status, "last saving [ms]", save_ms_);
    }
  }
  input_->report(status);
}

}  // namespace ngram_slam
