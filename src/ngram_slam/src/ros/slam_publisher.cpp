#include "ngram_slam/ros/slam_publisher.hpp"

#include <hyselam_msgs/RegionGraph.h>
#include <nav_msgs/Path.h>

#include <utility>

#include "hyselam_common/ros/conversions.hpp"
#include "ngram_slam/ros/slam_messages.hpp"

namespace ngram_slam {

namespace {
constexpr std::uint32_t kQueue = 1000;
}

SlamPublisher::SlamPublisher(ros::NodeHandle nh)
    : map_(nh.advertise<nav_msgs::OccupancyGrid>("map", 1, true)),
      metadata_(nh.advertise<nav_msgs::MapMetaData>("map_metadata", 1, true)),
      words_(nh.advertise<hyselam_msgs::WordArray>("words", kQueue)),
      matches_(nh.advertise<hyselam_msgs::WordMatchArray>("word_matches", kQueue)),
      regions_(nh.advertise<hyselam_msgs::SemanticRegionArray>("semantic_regions", kQueue)),
      graph_(nh.advertise<hyselam_msgs::RegionGraph>("region_graph", 1, true)),
      path_(nh.advertise<nav_msgs::Path>("path", 1, true)),
      markers_(nh.advertise<visualization_msgs::MarkerArray>("slam_markers", 1, true)),
      status_(nh.advertise<hyselam_msgs::LocalizationStatus>("localization_status", 1, true)),
      certainty_(nh.advertise<nav_msgs::OccupancyGrid>("map_certainty", 1, true)),
      changes_(nh.advertise<hyselam_msgs::MapChangeArray>("map_changes", 1, true)),
      change_markers_(
          nh.advertise<visualization_msgs::MarkerArray>("map_change_markers", 1, true)) {}

void SlamPublisher::publishWords(const hyselam_msgs::WordArray& words,
                                 const hyselam_msgs::WordMatchArray& matches) {
  words_.publish(words);
  matches_.publish(matches);
}

void SlamPublisher::publishRegions(const hyselam_msgs::SemanticRegionArray& regions) {
  regions_.publish(regions);
}

void SlamPublisher::publishStatus(const hyselam_msgs::LocalizationStatus& status) {
  status_.publish(status);
}

void SlamPublisher::publishMap(const PresentMap::Drawn& drawn,
                               const std::vector<SlamKeyframe>& keyframes,
                               const std::vector<bool>& shown, const std::vector<SlamLoop>& loops,
                               const RegionGraph& graph, const std_msgs::Header& header) {
  nav_msgs::OccupancyGrid map = hyselam::toMsg(drawn.grid, header.frame_id, header.stamp);
  map.info.map_load_time = header.stamp;
  map_.publish(map);
  metadata_.publish(map.info);
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    newest_map_ = std::move(map);
  }
  certainty_.publish(hyselam::toMsg(drawn.probabilities, header.frame_id, header.stamp));
  const double cell = drawn.grid.geometry.resolution;
  changes_.publish(changesMsg(drawn.changes, cell, header));
  change_markers_.publish(changeMarkers(drawn.changes, cell, header));
  graph_.publish(toMsg(graph, header));
  path_.publish(pathMsg(keyframes, header));
  markers_.publish(slamMarkers(keyframes, shown, loops, graph, header));
}

bool SlamPublisher::newestMap(nav_msgs::GetMap::Response& out) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (newest_map_) out.map = *newest_map_;
  return newest_map_.has_value();
}

}  // namespace ngram_slam
