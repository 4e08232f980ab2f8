// What the markers of this package have in common.
#pragma once

#include <std_msgs/Header.h>
#include <visualization_msgs/Marker.h>

#include "hyselam_common/pose2.hpp"
#include "ngram_slam/semantic_class.hpp"

namespace ngram_slam {

inline std_msgs::ColorRGBA colour(double r, double g, double b, double a = 1.0) {
  std_msgs::ColorRGBA c;
  c.r = static_cast<float>(r);
  c.g = static_cast<float>(g);
  c.b = static_cast<float>(b);
  c.a = static_cast<float>(a);
  return c;
}

inline std_msgs::ColorRGBA colourOf(SemanticClass c) {
  switch (c) {
    case SemanticClass::kBifurcation:
      return colour(0.95, 0.75, 0.10);
    case SemanticClass::kCorner:
      return colour(0.90, 0.35, 0.10);
    case SemanticClass::kCorridor:
      return colour(0.45, 0.65, 0.90);
    case SemanticClass::kDeadEnd:
      return colour(0.55, 0.30, 0.70);
    case SemanticClass::kHall:
      return colour(0.35, 0.75, 0.40);
  }
  return colour(0.6, 0.6, 0.6);
}

inline geometry_msgs::Point at(const hyselam::Pose2& pose, double z) {
  geometry_msgs::Point p;
  p.x = pose.x;
  p.y = pose.y;
  p.z = z;
  return p;
}

inline visualization_msgs::Marker marker(const std_msgs::Header& header, const char* name, int type,
                                         double width) {
  visualization_msgs::Marker m;
  m.header = header;
  m.ns = name;
  m.type = type;
  m.action = visualization_msgs::Marker::ADD;
  m.pose.orientation.w = 1.0;
  m.scale.x = width;
  m.color = colour(0.1, 0.1, 0.1);
  return m;
}

}  // namespace ngram_slam
