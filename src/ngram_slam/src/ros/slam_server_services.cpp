// Services, states and diagnostics of the SLAM server.
#include <algorithm>
#include <memory>
#include <utility>

#include "hyselam_common/errors.hpp"
#include "ngram_slam/ros/slam_graph_messages.hpp"
#include "ngram_slam/ros/slam_server.hpp"
#include "ngram_slam/slam/slam_state_io.hpp"
#include "ngram_slam/slam/standing_odometry.hpp"
#include "wall_milliseconds.hpp"

namespace ngram_slam {

using hyselam::addRemark;
using hyselam::addValue;
using Lock = std::unique_lock<std::mutex>;
using DiagnosticStatus = diagnostic_msgs::DiagnosticStatus;

void SlamServer::advertiseServices(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh) {
  ros::NodeHandle public_services(nh), private_services(private_nh);
  public_services.setCallbackQueue(&services_.queue);
  private_services.setCallbackQueue(&services_.queue);
  services_.save = private_services.advertiseService("save", &SlamServer::onSave, this);
  services_.load = private_services.advertiseService("load", &SlamServer::onLoad, this);
  using std_srvs::Trigger;
  const auto advertisePause = [&](const char* name, bool pause) {
    return private_services.advertiseService<Trigger::Request, Trigger::Response>(
        name,
        [this, pause](Trigger::Request&, Trigger::Response& out) { return onPause(pause, out); });
  };
  services_.pause = advertisePause("pause", true);
  services_.resume = advertisePause("resume", false);
  using nav_msgs::GetMap;
  services_.map = public_services.advertiseService<GetMap::Request, GetMap::Response>(
      "dynamic_map",
      [this](GetMap::Request&, GetMap::Response& out) { return publisher_.newestMap(out); });
  services_.graph = public_services.advertiseService("slam_graph", &SlamServer::onGraph, this);
}

/// @returns what was written. @throws hyselam::InputError
std::string SlamServer::saveState(const std::string& path) {
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
  status_.save_ms = millisecondsSince(begin);
  if (epoch == epoch_ && path == params_.state) mapping_->saved_scans = state.counters.scans;
  return path + ": " + std::to_string(state.keyframes.size()) + " keyframes, " +
         std::to_string(state.loops.size()) + " loops";
}

void SlamServer::saveIfChanged(const char* when) {
  if (params_.state.empty()) return;
  {
    const Lock lock(mutex_);
    if (mapping_->saved_scans == mapping_->engine.counters().scans) return;
  }
  std::string error;
  try {
    saveState(params_.state);
  } catch (const std::exception& e) {
    error = e.what();
    ROS_ERROR_STREAM(log_name_ << " not saved (" << when << "): " << error);
  }
  const Lock lock(mutex_);
  status_.save_error = error;
}

std::string SlamServer::pathOrDefault(const std::string& path) const {
  if (path.empty() && params_.state.empty()) {
    throw hyselam::InputError("path", "", "none given, and no state is kept");
  }
  return path.empty() ? params_.state : path;
}

bool SlamServer::onSave(hyselam_msgs::StatePath::Request& request,
                        hyselam_msgs::StatePath::Response& out) {
  try {
    out.message = saveState(pathOrDefault(request.path));
    out.success = true;
    const Lock lock(mutex_);
    status_.put_aside.clear();
  } catch (const std::exception& e) {
    out.success = false;
    out.message = e.what();
    ROS_ERROR_STREAM(log_name_ << " not saved: " << e.what());
  }
  return true;
}

bool SlamServer::onLoad(hyselam_msgs::StatePath::Request& request,
                        hyselam_msgs::StatePath::Response& out) {
  try {
    const std::string path = pathOrDefault(request.path);
    auto mapping = std::make_unique<Mapping>(
        params_,
        consolidated(SlamStateFile::load(path, params_.slam.surface), params_.slam.consolidation));
    out.message = path + ": " + std::to_string(mapping->engine.keyframes().size()) +
                  " keyframes, " + std::to_string(mapping->engine.loops().size()) + " loops";
    {
      const Lock lock(mutex_);
      std::swap(mapping_, mapping);
      later_scans_.reset();
      ++epoch_;
      next_scan_ = NextScan::kAfterPause;
      initial_pose_.reset();
      result_wait_.forget();
      map_due_ = drawsMaps();
      status_.put_aside.clear();
    }
    work_.notify_all();
    out.success = true;
    ROS_INFO_STREAM(log_name_ << " loaded " << out.message);
  } catch (const std::exception& e) {
    out.success = false;
    out.message = e.what();
    ROS_ERROR_STREAM(log_name_ << " not loaded: " << e.what());
  }
  return true;
}

bool SlamServer::onGraph(hyselam_msgs::SlamGraph::Request& request,
                         hyselam_msgs::SlamGraph::Response& out) {
  GraphPart part;
  {
    const Lock lock(mutex_);
    part = newGraphPart(mapping_->engine, mapping_->name, fromMsg(request));
  }
  toMsg(part, &out);
  out.frame = params_.global_frame_id;
  return true;
}

bool SlamServer::onPause(bool pause, std_srvs::Trigger::Response& out) {
  const Lock lock(mutex_);
  out.success = true;
  out.message = paused_ == pause ? (pause ? "paused already" : "was not paused")
                                 : (pause ? "paused" : "goes on");
  if (paused_ && !pause && next_scan_ == NextScan::kGoesOn && mapping_->localized)
    next_scan_ = NextScan::kAfterPause;
  if (paused_ != pause) ROS_INFO_STREAM(log_name_ << ' ' << out.message);
  if (pause) later_scans_.reset();
  paused_ = pause;
  return true;
}

// ---- diagnostics

/// Of odometry that fails and scans that are missing.
static void reportRoughRoad(DiagnosticStatus& status, const SlamEngine& engine) {
  const RoughRoad& road = engine.roughRoad();
  const auto first =
      std::find_if(engine.keyframes().begin(), engine.keyframes().end(),
                   [&](const auto& k) { return k.run >= engine.firstRunOfSession(); });
  if (odometryStands(road, engine.keyframes(),
                     static_cast<std::size_t>(first - engine.keyframes().begin()))) {
    addRemark(status, DiagnosticStatus::WARN, "the robot moves while its odometry stands still");
  }
  if (road.lost > 0) {
    addRemark(status, DiagnosticStatus::WARN,
              "lost " + std::to_string(road.lost) +
                  " times: neither odometry nor scans told how it moved");
  }
  addValue(status, "scans that moved while odometry stood", road.scans_moved_unseen);
  addValue(status, "path that odometry did not tell [m]", road.path_unseen);
  addValue(status, "scans searched wide", road.wide_searches);
  addValue(status, "gaps without scans", road.gaps);
  addValue(status, "times lost", road.lost);
  addValue(status, "runs split there", road.runs_split);
}

void SlamServer::report(DiagnosticStatus& status) {
  input_->checkClock();
  {
    const Lock lock(mutex_);
    const SlamEngine& engine = mapping_->engine;
    const SlamCounters& c = engine.counters();
    const auto addError = [&](const char* what, const std::string& error) {
      if (!error.empty()) addRemark(status, DiagnosticStatus::ERROR, what + error);
    };
    addRemark(status, DiagnosticStatus::OK,
              std::to_string(engine.keyframes().size()) + " keyframes, " +
                  std::to_string(engine.loops().size()) + " loops");
    if (engine.runPlace() == RunPlace::kSupposed && mapping_->localized) {
      addRemark(status, DiagnosticStatus::WARN, "not recognised in the known map yet");
    }
    if (paused_) addRemark(status, DiagnosticStatus::WARN, "paused");
    if (!status_.put_aside.empty()) addRemark(status, DiagnosticStatus::WARN, status_.put_aside);
    addError("optimization: ", status_.job_error);
    addError("map: ", status_.map_error);
    addError("not saved: ", status_.save_error);
    addError("the session goes on: ", status_.session_error);
    addValue(status, "paused", paused_);
    addValue(status, "scans while paused", status_.paused_scans);
    addValue(status, "publishing tf", params_.tf_broadcast && mapping_->localized);
    addValue(status, "place of the run", toString(engine.runPlace()));
    if (const auto tied = engine.pathUntilTied()) {
      addValue(status, "recognised after [m]", *tied);
    }
    addValue(status, "ties withdrawn", engine.tiesWithdrawn());
    addValue(status, "runs", engine.keyframes().empty() ? 0 : engine.keyframes().back().run + 1);
    addValue(status, "keyframes", engine.keyframes().size());
    addValue(status, "loops", engine.loops().size());
    addValue(status, "loops by words", c.words.accepted);
    addValue(status, "loops by signatures", c.signatures.accepted);
    addValue(status, "matches of words", engine.matches().size());
    addValue(status, "regions", mapping_->regions.size());
    addValue(status, "optimizations", c.optimizations);
    addValue(status, "words", engine.recognizer().text().words());
    addValue(status, "scans remembered", engine.scans());
    addValue(status, "cells settled", engine.settled().cells.size());
    if (params_.session_path > 0.0) {
      addValue(status, "sessions ended", status_.sessions_ended);
      addValue(status, "last end of a session [ms]", status_.session_ms);
    }
    addValue(status, "looking for loops", mapping_->jobs.isOut());
    addValue(status, "loops and optimizations late", result_wait_.givenUp());
    addValue(status, "scans that hardly matched", status_.weak_matches);
    addValue(status, "odometry jumps", c.odometry_jumps);
    reportRoughRoad(status, engine);
    addValue(status, "since the last session", status_.changes);
    addValue(status, "last scan [ms]", status_.scan_ms);
    addValue(status, "slowest scan [ms]", status_.max_scan_ms);
    addValue(status, "last loops and optimization [ms]", status_.job_ms);
    addValue(status, "last map [ms]", status_.map_ms);
    if (!params_.state.empty()) {
      addValue(status, "state", params_.state);
      addValue(status, "scans not saved", c.scans - mapping_->saved_scans);
      addValue(status, "last saving [ms]", status_.save_ms);
    }
  }
  input_->report(status);
}

}  // namespace ngram_slam
