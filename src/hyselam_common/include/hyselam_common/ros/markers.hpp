// What the markers of all layers have in common. For packages that depend on visualization_msgs.
#pragma once

#include <visualization_msgs/Marker.h>

#include <string>

namespace hyselam {

/// Parts of red, green and blue, and opacity, each 0..1.
inline std_msgs::ColorRGBA color(double r, double g, double b, double a = 1.0) {
  std_msgs::ColorRGBA c;
  c.r = static_cast<float>(r);
  c.g = static_cast<float>(g);
  c.b = static_cast<float>(b);
  c.a = static_cast<float>(a);
  return c;
}

/// [m]
inline geometry_msgs::Point at(double x, double y, double z) {
  geometry_msgs::Point point;
  point.x = x;
  point.y = y;
  point.z = z;
  return point;
}

/// A marker to be added, at the frame's origin, of size 1 m. `type` of visualization_msgs/Marker.
inline visualization_msgs::Marker marker(const std::string& frame_id, const std::string& ns, int id,
                                         int type) {
  visualization_msgs::Marker m;
  m.header.frame_id = frame_id;
  m.ns = ns;
  m.id = id;
  m.type = type;
  m.action = visualization_msgs::Marker::ADD;
  m.pose.orientation.w = 1.0;
  m.scale.x = m.scale.y = m.scale.z = 1.0;
  return m;
}

}  // namespace hyselam
