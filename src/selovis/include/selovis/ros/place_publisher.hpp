// Publishes what was recognized: `visual_place`, and `place_markers` for rviz.
#pragma once

#include <ros/ros.h>

#include <string>

#include "hyselam_topological_map/topological_map.hpp"
#include "selovis/recognition/image_recognizer.hpp"

namespace selovis {

class PlacePublisher {
 public:
  /// @param marker_height [m] of a bar of probability 1.
  PlacePublisher(ros::NodeHandle nh, double marker_height);

  /// @param map may be null: ids of places are then 0, and there are no markers.
  void publish(const Recognition& recognition, const ImageRecognizer& recognizer,
               const std_msgs::Header& header, const hyselam_topo::AugmentedTopologicalMap* map,
               bool kidnapped);
  /// Name of the last place; empty: unknown.
  const std::string& lastPlace() const { return last_place_; }

 private:
  double marker_height_;
  std::string last_place_;
  ros::Publisher places_, markers_;
};

}  // namespace selovis
