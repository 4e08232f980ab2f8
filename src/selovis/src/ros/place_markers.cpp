#include "selovis/ros/place_markers.hpp"

#include <algorithm>
#include <cmath>

namespace selovis {
namespace {

using visualization_msgs::Marker;

constexpr double kWidth = 0.5;        // of a bar [m]
constexpr double kTextHeight = 0.45;  // [m]

std_msgs::ColorRGBA colour(float r, float g, float b, float a) {
  std_msgs::ColorRGBA c;
  c.r = r;
  c.g = g;
  c.b = b;
  c.a = a;
  return c;
}

}  // namespace

visualization_msgs::MarkerArray placeMarkers(const hyselam_topo::AugmentedTopologicalMap& map,
                                             const std::vector<std::string>& names,
                                             const std::vector<double>& probabilities,
                                             int likeliest, bool kidnapped, double height) {
  visualization_msgs::MarkerArray array;
  Marker all;
  all.header.frame_id = map.frame_id;
  all.action = Marker::DELETEALL;
  array.markers.push_back(all);
  for (const auto& place : map.places) {
    if (!place.centre) continue;
    const auto at = std::find(names.begin(), names.end(), hyselam_topo::nameOf(place));
    if (at == names.end()) continue;
    const auto i = static_cast<std::size_t>(at - names.begin());
    const bool here = static_cast<int>(i) == likeliest;
    Marker bar;
    bar.header.frame_id = map.frame_id;
    bar.ns = "bars";
    bar.id = static_cast<int>(place.id);
    bar.type = Marker::CUBE;
    bar.pose.orientation.w = 1.0;
    bar.scale.x = bar.scale.y = kWidth;
    bar.scale.z = std::max(0.02, height * probabilities[i]);
    bar.pose.position.x = place.centre->x;
    bar.pose.position.y = place.centre->y;
    bar.pose.position.z = 0.5 * bar.scale.z;
    bar.color = !here       ? colour(0.25f, 0.45f, 0.9f, 0.85f)
                : kidnapped ? colour(1.0f, 0.45f, 0.05f, 0.95f)
                            : colour(0.1f, 0.7f, 0.25f, 0.95f);
    array.markers.push_back(bar);
    Marker text = bar;
    text.ns = "names";
    text.type = Marker::TEXT_VIEW_FACING;
    text.scale.x = text.scale.y = 0.0;
    text.scale.z = here ? 1.3 * kTextHeight : kTextHeight;
    // In front of the bar's foot, so that neither hides the other.
    text.pose.position.y -= 0.5 * kWidth + 0.8 * text.scale.z;
    text.pose.position.z = 0.3;
    text.color = here ? bar.color : colour(0.1f, 0.1f, 0.1f, 1.0f);
    text.color.a = 1.0f;
    const long percent = std::lround(100.0 * probabilities[i]);
    text.text = names[i] + (percent > 0 ? " " + std::to_string(percent) + " %" : "");
    array.markers.push_back(text);
  }
  return array;
}

}  // namespace selovis
