#include "hyselam_topo/ros/dialogue_markers.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "hyselam_common/ros/markers.hpp"
#include "hyselam_topological_map/place_labels.hpp"

namespace hyselam_topo {
namespace {

using hyselam::at;
using hyselam::color;
using visualization_msgs::Marker;

std_msgs::ColorRGBA colourOf(NameState state) {
  switch (state) {
    case NameState::kNone:
      return color(0.0, 0.45, 0.1);
    case NameState::kUnconfirmed:
      return color(0.75, 0.05, 0.05);
    case NameState::kConfirmed:
      break;
  }
  return color(0.05, 0.15, 0.75);
}

Marker make(const std::string& frame, const std::string& ns, int id, int type) {
  Marker m = hyselam::marker(frame, ns, id, type);
  m.scale.x = m.scale.y = m.scale.z = 0.06;
  return m;
}

Marker ring(const AugmentedTopologicalMap& map, const Place& place) {
  constexpr int kPieces = 24;
  constexpr double kRadius = 0.3, kHeight = 0.12;  // [m]
  Marker m = make(map.frame_id, "name_states", static_cast<int>(place.id), Marker::LINE_STRIP);
  m.color = colourOf(nameStateOf(place));
  for (int i = 0; i <= kPieces; ++i) {
    const double angle = 2.0 * hyselam::kPi * i / kPieces;
    m.points.push_back(at(place.centre->x + kRadius * std::cos(angle),
                          place.centre->y + kRadius * std::sin(angle), kHeight));
  }
  return m;
}

Marker text(const AugmentedTopologicalMap& map, const Place& place, const CellBox* box) {
  Marker m = make(map.frame_id, "names", static_cast<int>(place.id), Marker::TEXT_VIEW_FACING);
  const std::vector<std::string> names = namesOf(place);
  const PlaceLabel label =
      placeLabel(map, place, box, codeOf(place), names.empty() ? std::string() : names.front());
  m.scale.z = label.height;
  m.pose.position = at(label.position.x, label.position.y, 0.3);
  m.color = colourOf(nameStateOf(place));
  m.text = label.text;
  return m;
}

}  // namespace

visualization_msgs::MarkerArray namedMapMarkers(const AugmentedTopologicalMap& map,
                                                const MapMarkerParams& params) {
  MapMarkerParams without_names = params;
  without_names.names = false;
  visualization_msgs::MarkerArray array = mapMarkers(map, without_names);
  for (visualization_msgs::Marker& marker : array.markers) {
    // Drawn into the grid map, glass is found as a solid wall, too: it shall lie above that one.
    if (marker.ns == "walls" && marker.id == static_cast<int>(WallKind::kGlass)) {
      marker.pose.position.z = 0.06;
      marker.scale.x = 0.16;
    }
  }
  const auto boxes = params.names && map.grid ? placeBoxes(*map.grid) : std::map<Id, CellBox>{};
  for (const Place& place : map.places) {
    if (!place.centre) continue;
    array.markers.push_back(ring(map, place));
    if (!params.names) continue;
    const auto box = boxes.find(place.id);
    array.markers.push_back(text(map, place, box == boxes.end() ? nullptr : &box->second));
  }
  return array;
}

visualization_msgs::MarkerArray questionMarkers(const Question& question,
                                                const std::string& frame_id) {
  constexpr double kHeight = 0.15;
  visualization_msgs::MarkerArray array;
  Marker all = make(frame_id, "glass_wall", 0, Marker::CUBE);
  all.action = Marker::DELETEALL;
  array.markers.push_back(all);
  if (!question.search) return array;
  Marker seen = make(frame_id, "glass_wall", 1, Marker::LINE_STRIP);
  seen.scale.x = 0.03;
  seen.color = color(0.2, 0.8, 0.2);
  const hyselam::Pose2& robot = question.search->robot();
  seen.points.push_back(at(robot.x, robot.y, kHeight));
  for (const auto& p : question.search->seen()) seen.points.push_back(at(p.x, p.y, kHeight));
  seen.points.push_back(at(robot.x, robot.y, kHeight));
  array.markers.push_back(seen);
  if (!question.search->corners().empty()) {
    Marker corners = make(frame_id, "glass_wall", 2, Marker::CUBE_LIST);
    corners.scale.x = corners.scale.y = 0.15;
    corners.color = color(0.9, 0.1, 0.1);
    for (const auto& p : question.search->corners()) {
      corners.points.push_back(at(p.x, p.y, kHeight));
    }
    array.markers.push_back(corners);
  }
  if (question.kind == Question::Kind::kWall) {
    Marker wall = make(frame_id, "glass_wall", 3, Marker::LINE_STRIP);
    wall.scale.x = 0.12;
    wall.color = color(0.1, 0.3, 0.95);
    wall.points.push_back(at(question.wall.line.a.x, question.wall.line.a.y, kHeight));
    wall.points.push_back(at(question.wall.line.b.x, question.wall.line.b.y, kHeight));
    array.markers.push_back(wall);
  }
  return array;
}

}  // namespace hyselam_topo
