#include "ngram_slam/ros/shared_map_messages.hpp"

#include <array>
#include <optional>

#include "hyselam_common/ros/conversions.hpp"
#include "marker_parts.hpp"

namespace ngram_slam {

using hyselam::Pose2;
using visualization_msgs::Marker;

namespace {

std_msgs::ColorRGBA colorOfRobot(std::size_t robot) {
  const std::array<std_msgs::ColorRGBA, 6> colors = {
      color(0.15, 0.35, 0.85), color(0.90, 0.45, 0.05), color(0.10, 0.60, 0.30),
      color(0.60, 0.20, 0.70), color(0.00, 0.60, 0.70), color(0.55, 0.45, 0.10)};
  return colors[robot % colors.size()];
}

/// "a, b and c"
std::string listed(const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0) text += i + 1 == words.size() ? " and " : ", ";
    text += words[i];
  }
  return text;
}

}  // namespace

hyselam_msgs::SharedMapStatus sharedMapStatusMsg(const std::vector<RobotAnswers>& answers,
                                                 const std::vector<RobotInSharedMap>& robots,
                                                 const std_msgs::Header& header) {
  hyselam_msgs::SharedMapStatus msg;
  msg.header = header;
  std::vector<std::string> in, out, silent;
  for (std::size_t i = 0; i < answers.size(); ++i) {
    hyselam_msgs::SharedMapRobot robot;
    robot.name = answers[i].name;
    robot.frame = answers[i].frame;
    robot.answers = answers[i].reason.empty();
    robot.reason = answers[i].reason;
    robot.keyframes = static_cast<std::uint32_t>(robots[i].keyframes);
    robot.in_map = robots[i].map_in_shared.has_value();
    if (const auto& pose = robots[i].map_in_shared) robot.pose = hyselam::toPose2dMsg(*pose);
    robot.ties = static_cast<std::uint32_t>(robots[i].ties);
    if (robot.in_map) in.push_back(robot.name);
    if (!robot.in_map && robot.keyframes > 0) out.push_back(robot.name);
    if (!robot.answers) silent.push_back(robot.name);
    msg.robots.push_back(robot);
  }
  const auto add = [&](const std::string& text) {
    msg.text += (msg.text.empty() ? "" : "; ") + text;
  };
  if (in.size() > 1) add(listed(in) + " are in one map");
  if (in.size() == 1) add("the map is that of " + in.front());
  if (!out.empty()) {
    add(listed(out) + (out.size() > 1 ? " are" : " is") + " not recognized in it");
  }
  if (!silent.empty()) {
    add(listed(silent) + (silent.size() > 1 ? " do" : " does") + " not answer");
  }
  if (msg.text.empty()) add("there is no map yet");
  return msg;
}

visualization_msgs::MarkerArray sharedMapMarkers(const SharedMapState& shared,
                                                 const std::vector<std::string>& names,
                                                 const std_msgs::Header& header) {
  const std::vector<SlamKeyframe>& keyframes = shared.state.keyframes;
  visualization_msgs::MarkerArray array;
  Marker clear;
  clear.header = header;
  clear.action = Marker::DELETEALL;
  array.markers.push_back(clear);
  const auto robotOf = [&](const SlamKeyframe& k) { return shared.robot_of_run[k.run]; };
  for (std::size_t robot = 0; robot < names.size(); ++robot) {
    Marker path = marker(header, "path", Marker::LINE_LIST, 0.08);
    path.id = static_cast<int>(robot);
    path.color = colorOfRobot(robot);
    const SlamKeyframe* newest = nullptr;
    for (std::size_t i = 0; i < keyframes.size(); ++i) {
      if (robotOf(keyframes[i]) != robot) continue;
      if (newest == nullptr || keyframes[i].stamp >= newest->stamp) newest = &keyframes[i];
      if (i == 0 || keyframes[i].run != keyframes[i - 1].run) continue;
      path.points.push_back(at(keyframes[i - 1].pose, 0.05));
      path.points.push_back(at(keyframes[i].pose, 0.05));
    }
    if (newest == nullptr) continue;
    if (!path.points.empty()) array.markers.push_back(path);
    Marker body = marker(header, "robots", Marker::ARROW, 0.9);
    body.id = static_cast<int>(robot);
    body.scale.y = body.scale.z = 0.35;
    body.color = colorOfRobot(robot);
    body.pose = hyselam::toPoseMsg(newest->pose);
    body.pose.position.z = 0.3;
    array.markers.push_back(body);
    Marker name = marker(header, "names", Marker::TEXT_VIEW_FACING, 0.0);
    name.id = static_cast<int>(robot);
    name.scale.z = 0.8;
    name.color = colorOfRobot(robot);
    name.pose.position = at({newest->pose.x, newest->pose.y + 0.9, 0.0}, 0.6);
    name.text = names[robot];
    array.markers.push_back(name);
  }
  Marker ties = marker(header, "ties", Marker::LINE_LIST, 0.06);
  ties.color = color(0.85, 0.1, 0.55, 0.8);
  for (const SlamLoop& l : shared.state.loops) {
    const SlamKeyframe& older = keyframes[static_cast<std::size_t>(l.older)];
    const SlamKeyframe& newer = keyframes[static_cast<std::size_t>(l.newer)];
    if (!isUsed(l) || robotOf(older) == robotOf(newer)) continue;
    ties.points.push_back(at(older.pose, 0.15));
    ties.points.push_back(at(newer.pose, 0.15));
  }
  if (!ties.points.empty()) array.markers.push_back(ties);
  return array;
}

}  // namespace ngram_slam
