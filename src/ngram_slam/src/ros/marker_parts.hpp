// What the markers of this package have in common.
#pragma once

#include <std_msgs/Header.h>

#include "hyselam_common/pose2.hpp"
#include "hyselam_common/ros/markers.hpp"
#include "ngram_slam/semantics/semantic_class.hpp"

namespace ngram_slam {

using hyselam::color;

inline std_msgs::ColorRGBA colorOf(SemanticClass c) {
  switch (c) {
    case SemanticClass::kBifurcation:
      return color(0.95, 0.75, 0.10);
    case SemanticClass::kCorner:
      return color(0.90, 0.35, 0.10);
    case SemanticClass::kCorridor:
      return color(0.45, 0.65, 0.90);
    case SemanticClass::kDeadEnd:
      return color(0.55, 0.30, 0.70);
    case SemanticClass::kHall:
      return color(0.35, 0.75, 0.40);
  }
  return color(0.6, 0.6, 0.6);
}

inline geometry_msgs::Point at(const hyselam::Pose2& pose, double z) {
  return hyselam::at(pose.x, pose.y, z);
}

inline visualization_msgs::Marker marker(const std_msgs::Header& header, const char* name, int type,
                                         double width) {
  visualization_msgs::Marker m = hyselam::marker(header.frame_id, name, 0, type);
  m.header = header;
  m.scale.x = width;
  m.scale.y = m.scale.z = 0.0;
  m.color = color(0.1, 0.1, 0.1);
  return m;
}

}  // namespace ngram_slam
