// What the SLAM server does beside the scans: one thread for loops and poses, one for maps and
// savings.
#include <nav_msgs/Path.h>

#include <chrono>
#include <utility>

#include "hyselam_common/ros/conversions.hpp"
#include "ngram_slam/ros/slam_messages.hpp"
#include "ngram_slam/ros/slam_server.hpp"
#include "wall_milliseconds.hpp"

namespace ngram_slam {

using Lock = std::unique_lock<std::mutex>;

namespace {

constexpr double kLookEvery = 0.1;  // [s] of the drawer, for savings

}  // namespace

// ---- loops and optimisation

void SlamServer::optimise() {
  Lock lock(mutex_);
  while (!ending_) {
    const auto job = mapping_->engine.takeJob();
    if (!job) {
      work_.wait(lock);
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
      ROS_ERROR_STREAM(who_ << " loops are not taken in: " << error);
    }
    lock.lock();
    if (epoch != epoch_) continue;
    try {
      mapping_->engine.apply(result);
    } catch (const std::exception& e) {
      error = e.what();
      ROS_ERROR_STREAM(who_ << " loops are not taken in: " << error);
    }
    job_error_ = error;
    job_ms_ = millisecondsSince(begin);
  }
}

// ---- the map

void SlamServer::publish(const hyselam::OccupancyGrid& grid,
                         const std::vector<SlamKeyframe>& keyframes,
                         const std::vector<SlamLoop>& loops, const RegionGraph& graph,
                         const std_msgs::Header& in_map) {
  nav_msgs::OccupancyGrid map = hyselam::toMsg(grid, in_map.frame_id, in_map.stamp);
  map.info.map_load_time = in_map.stamp;
  map_publisher_.publish(map);
  metadata_publisher_.publish(map.info);
  {
    const Lock lock(map_mutex_);
    map_ = std::move(map);
  }
  graph_publisher_.publish(toMsg(graph, in_map));
  path_publisher_.publish(pathMsg(keyframes, in_map));
  marker_publisher_.publish(slamMarkers(keyframes, loops, graph, in_map));
}

void SlamServer::draw() {
  KeyframeMapper mapper(params_.map);
  long epoch = -1;
  ros::WallTime saved = ros::WallTime::now();
  while (true) {
    std::vector<SlamKeyframe> keyframes;
    std::vector<SlamLoop> loops;
    RegionGraph graph;
    std_msgs::Header in_map;
    long revision = 0;
    {
      Lock lock(mutex_);
      work_.wait_for(lock, std::chrono::duration<double>(kLookEvery),
                     [this] { return map_due_ || ending_; });
      if (ending_) return;
      if (map_due_) {
        map_due_ = false;
        const SlamEngine& engine = mapping_->engine;
        keyframes = engine.keyframes();
        loops = engine.loops();
        revision = engine.revision();
        graph = regionGraph(engine, mapping_->regions);
        in_map = header(params_.global_frame_id);
        if (epoch != epoch_) mapper = KeyframeMapper(params_.map);
        epoch = epoch_;
      }
    }
    if (!keyframes.empty()) {
      const ros::WallTime begin = ros::WallTime::now();
      std::string error;
      const auto attempt = [&](const auto& work) {
        try {
          work();
        } catch (const std::exception& e) {
          error = e.what();
          ROS_ERROR_STREAM_THROTTLE(10.0, who_ << " the map is not complete: " << error);
        }
      };
      attempt([&] { mapper.update(keyframes, revision); });
      attempt([&] { publish(mapper.grid(), keyframes, loops, graph, in_map); });  // what fits
      const Lock lock(mutex_);
      map_error_ = error;
      map_ms_ = millisecondsSince(begin);
    }
    if (!params_.state.empty() && params_.save_period > 0.0 &&
        (ros::WallTime::now() - saved).toSec() >= params_.save_period) {
      saveNow("now and then");
      saved = ros::WallTime::now();
    }
  }
}

}  // namespace ngram_slam
