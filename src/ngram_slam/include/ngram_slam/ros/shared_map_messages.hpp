// What the shared map says of itself.
#pragma once

#include <hyselam_msgs/SharedMapStatus.h>
#include <visualization_msgs/MarkerArray.h>

#include <string>
#include <vector>

#include "ngram_slam/slam/shared_map.hpp"

namespace ngram_slam {

/// What is known of a robot besides its graph.
struct RobotAnswers {
  std::string name;
  std::string frame;   ///< of its map; empty: not known yet
  std::string reason;  ///< why it does not answer, or its answer was refused; empty: it answers
};

hyselam_msgs::SharedMapStatus sharedMapStatusMsg(const std::vector<RobotAnswers>& answers,
                                                 const std::vector<RobotInSharedMap>& robots,
                                                 const std_msgs::Header& header);

/// A color for each robot: its path, where it is, its name; loops between robots.
visualization_msgs::MarkerArray sharedMapMarkers(const SharedMapState& shared,
                                                 const std::vector<std::string>& names,
                                                 const std_msgs::Header& header);

}  // namespace ngram_slam
