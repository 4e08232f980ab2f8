// The topics of SLAM, and its newest map for those who ask.
#pragma once

#include <hyselam_msgs/LocalizationStatus.h>
#include <hyselam_msgs/SemanticRegionArray.h>
#include <hyselam_msgs/WordArray.h>
#include <hyselam_msgs/WordMatchArray.h>
#include <nav_msgs/GetMap.h>
#include <nav_msgs/OccupancyGrid.h>
#include <ros/ros.h>

#include <mutex>
#include <optional>
#include <vector>

#include "ngram_slam/slam/present_map.hpp"
#include "ngram_slam/slam/region_graph.hpp"
#include "ngram_slam/slam/slam_types.hpp"

namespace ngram_slam {

/// `map`, `map_metadata`, `map_certainty`, `map_changes`, `map_change_markers`, `region_graph`,
/// `path` and `slam_markers` (latched), `words`, `word_matches`, `semantic_regions`. Any thread may
/// publish.
class SlamPublisher {
 public:
  explicit SlamPublisher(ros::NodeHandle nh);

  void publishWords(const hyselam_msgs::WordArray& words,
                    const hyselam_msgs::WordMatchArray& matches);
  void publishRegions(const hyselam_msgs::SemanticRegionArray& regions);
  void publishStatus(const hyselam_msgs::LocalizationStatus& status);
  /// @param shown as SlamEngine::shownRuns().
  /// @param header map frame; stamp of the newest scan.
  void publishMap(const PresentMap::Drawn& drawn, const std::vector<SlamKeyframe>& keyframes,
                  const std::vector<bool>& shown, const std::vector<SlamLoop>& loops,
                  const RegionGraph& graph, const std_msgs::Header& header);
  /// The service `dynamic_map`: false without a map.
  bool newestMap(nav_msgs::GetMap::Response& out) const;

 private:
  ros::Publisher map_, metadata_, words_, matches_, regions_, graph_, path_, markers_, status_,
      certainty_, changes_, change_markers_;
  mutable std::mutex mutex_;
  std::optional<nav_msgs::OccupancyGrid> newest_map_;
};

}  // namespace ngram_slam
