#include "selovis/ros/place_markers.hpp"

#include <algorithm>
#include <cmath>

#include "hyselam_common/ros/markers.hpp"

namespace selovis {
namespace {

using hyselam::color;
using visualization_msgs::Marker;

constexpr double kWidth = 0.5;        // of a bar [m]
constexpr double kTextHeight = 0.45;  // [m]

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
    Marker bar = hyselam::marker(map.frame_id, "bars", static_cast<int>(place.id), Marker::CUBE);
    bar.scale.x = bar.scale.y = kWidth;
    bar.scale.z = std::max(0.02, height * probabilities[i]);
    bar.pose.position.x = place.centre->x;
    bar.pose.position.y = place.centre->y;
    bar.pose.position.z = 0.5 * bar.scale.z;
    bar.color = !here       ? color(0.25, 0.45, 0.9, 0.85)
                : kidnapped ? color(1.0, 0.45, 0.05, 0.95)
                            : color(0.1, 0.7, 0.25, 0.95);
    array.markers.push_back(bar);
    // The map's own markers name the places.
    const long percent = std::lround(100.0 * probabilities[i]);
    if (percent == 0) continue;
    Marker text = bar;
    text.ns = "names";
    text.type = Marker::TEXT_VIEW_FACING;
    text.scale.x = text.scale.y = 0.0;
    text.scale.z = here ? 1.3 * kTextHeight : kTextHeight;
    // In front of the bar's foot, so that neither hides the other.
    text.pose.position.y -= 0.5 * kWidth + 0.8 * text.scale.z;
    text.pose.position.z = 0.3;
    text.color = here ? bar.color : color(0.1, 0.1, 0.1, 1.0);
    text.color.a = 1.0f;
    text.text = std::to_string(percent) + " %";
    array.markers.push_back(text);
  }
  return array;
}

}  // namespace selovis
