#include "ngram_slam/ros/slam_messages.hpp"

#include <algorithm>
#include <iomanip>
#include <limits>
#include <sstream>

#include "hyselam_common/ros/conversions.hpp"
#include "marker_parts.hpp"

namespace ngram_slam {

using visualization_msgs::Marker;

namespace {

/// Loops of less weight are drawn as contradicting, a while before they are not used (isUsed()).
constexpr double kDoubtfulWeight = 0.5;

/// The real word that an observation belongs to; the last one for observations without word yet.
std::uint32_t wordAt(const WordLattice& text, std::uint32_t observation) {
  Position low = 0, high = text.positions();
  while (low + 1 < high) {
    const Position middle = low + (high - low) / 2;
    if (text.observationBegin(text.realWord(middle)) <= observation)
      low = middle;
    else
      high = middle;
  }
  return text.positions() > 0 ? static_cast<std::uint32_t>(text.realWord(low)) : 0;
}

void addLine(Marker* m, const hyselam::Pose2& a, const hyselam::Pose2& b, double z,
             const std_msgs::ColorRGBA& c) {
  for (const hyselam::Pose2* p : {&a, &b}) {
    m->points.push_back(at(*p, z));
    m->colors.push_back(c);
  }
}

}  // namespace

hyselam_msgs::RegionGraph toMsg(const RegionGraph& graph, const std_msgs::Header& header) {
  hyselam_msgs::RegionGraph msg;
  msg.header = header;
  for (const RegionNode& node : graph.nodes) {
    hyselam_msgs::RegionNode n;
    n.id = static_cast<std::uint32_t>(msg.nodes.size());
    n.semantic_class = static_cast<std::uint8_t>(indexOf(node.semantic_class));
    n.class_name = toString(node.semantic_class);
    n.confidence = static_cast<float>(node.confidence);
    n.run = node.run;
    n.pose = hyselam::toPose2dMsg(node.pose);
    n.length = static_cast<float>(node.length);
    n.stamp_begin = hyselam::toRosTime(node.stamp_begin);
    n.stamp_end = hyselam::toRosTime(node.stamp_end);
    msg.nodes.push_back(n);
  }
  for (const RegionEdge& edge : graph.edges) {
    hyselam_msgs::RegionEdge e;
    e.a = edge.a;
    e.b = edge.b;
    e.kind = edge.kind == RegionEdge::Kind::kLoop ? hyselam_msgs::RegionEdge::LOOP
                                                  : hyselam_msgs::RegionEdge::CONSECUTIVE;
    msg.edges.push_back(e);
  }
  return msg;
}

nav_msgs::Path pathMsg(const std::vector<SlamKeyframe>& keyframes, const std_msgs::Header& header) {
  nav_msgs::Path path;
  path.header = header;
  for (const SlamKeyframe& k : keyframes) {
    if (k.run != keyframes.back().run) continue;
    geometry_msgs::PoseStamped p;
    p.header.frame_id = header.frame_id;
    p.header.stamp = hyselam::toRosTime(k.stamp);
    p.pose = hyselam::toPoseMsg(k.pose);
    path.poses.push_back(p);
  }
  return path;
}

hyselam_msgs::WordMatch matchMsg(const NgramRecognizer& recognizer, const SlamMatch& match) {
  const ObservationStore& observations = recognizer.observations();
  hyselam_msgs::WordMatch msg;
  msg.newer = wordAt(recognizer.text(), match.newer);
  msg.older = wordAt(recognizer.text(), match.older);
  msg.level = static_cast<std::uint8_t>(match.level);
  msg.n = static_cast<std::uint16_t>(std::clamp(match.n, 0, 65535));
  msg.direction = match.direction == Direction::kSame ? hyselam_msgs::WordMatch::SAME
                                                      : hyselam_msgs::WordMatch::REVERSE;
  msg.chance = -1.0;
  msg.probability = match.probability;
  msg.stamp_newer = hyselam::toRosTime(match.stamp_newer);
  msg.stamp_older = hyselam::toRosTime(match.stamp_older);
  msg.run_newer = observations.runOf(match.newer);
  msg.run_older = observations.runOf(match.older);
  msg.newer_in_odom = hyselam::toPose2dMsg(observations.pose(match.newer));
  msg.older_in_odom = hyselam::toPose2dMsg(observations.pose(match.older));
  msg.alignment_rms = -1.0f;
  return msg;
}

hyselam_msgs::LocalizationStatus statusMsg(const SlamEngine& engine, double update_ms,
                                           const std_msgs::Header& header) {
  using hyselam_msgs::LocalizationStatus;
  LocalizationStatus msg;
  msg.header = header;
  msg.match_quality = std::numeric_limits<float>::quiet_NaN();
  msg.travelled = engine.pathOfRun();
  msg.update_ms = static_cast<float>(update_ms);
  const RunPlace place = engine.runPlace();
  msg.converged = place != RunPlace::kSupposed;
  msg.phase = msg.converged ? LocalizationStatus::TRACKING : LocalizationStatus::GLOBAL;
  std::ostringstream text;
  text << std::fixed << std::setprecision(1);
  switch (place) {
    case RunPlace::kFirst:
      text << "a new map";
      break;
    case RunPlace::kSupposed:
      text << "not recognised in the known map after " << engine.pathOfRun()
           << " m: the pose is a guess";
      break;
    case RunPlace::kTied:
      text << "in the known map, since " << engine.pathUntilTied().value_or(0.0)
           << " m after the start";
      break;
    case RunPlace::kOwnMap:
      text << "a map of its own: nothing known was recognised in " << engine.pathOfRun() << " m";
      break;
  }
  if (engine.tiesWithdrawn() > 0) {
    text << "; taken elsewhere before, " << engine.tiesWithdrawn() << " times";
  }
  msg.text = text.str();
  return msg;
}

hyselam_msgs::MapChangeArray changesMsg(const std::vector<MapChange>& changes, double cell,
                                        const std_msgs::Header& header) {
  hyselam_msgs::MapChangeArray msg;
  msg.header = header;
  msg.cell = static_cast<float>(cell);
  for (const MapChange& change : changes) {
    hyselam_msgs::MapChange m;
    m.kind = change.kind == MapChange::Kind::kAppeared ? hyselam_msgs::MapChange::APPEARED
                                                       : hyselam_msgs::MapChange::GONE;
    m.again = change.again;
    for (const hyselam::Point2& p : change.cells) m.cells.push_back(hyselam::at(p.x, p.y, 0.0));
    m.center = hyselam::at(change.center.x, change.center.y, 0.0);
    m.size = static_cast<float>(change.size);
    m.probability = static_cast<float>(change.probability);
    msg.changes.push_back(std::move(m));
  }
  return msg;
}

visualization_msgs::MarkerArray changeMarkers(const std::vector<MapChange>& changes, double cell,
                                              const std_msgs::Header& header) {
  constexpr double kNamedSize = 0.3;     // [m]
  constexpr double kAround = 0.5;        // of a disc, beyond what it surrounds [m]
  constexpr double kAboveRegions = 1.7;  // [m]
  visualization_msgs::MarkerArray array;
  Marker clear;
  clear.header = header;
  clear.action = Marker::DELETEALL;
  array.markers.push_back(clear);
  const auto colorOf = [](MapChange::Kind kind, double alpha) {
    return kind == MapChange::Kind::kAppeared ? color(0.0, 0.65, 0.25, alpha)
                                              : color(0.9, 0.15, 0.15, alpha);
  };
  for (const auto kind : {MapChange::Kind::kAppeared, MapChange::Kind::kGone}) {
    Marker cells = marker(header, toString(kind), Marker::CUBE_LIST, cell);
    cells.scale.y = cell;
    cells.scale.z = 0.05;
    cells.color = colorOf(kind, 0.9);
    for (const MapChange& change : changes) {
      if (change.kind != kind) continue;
      for (const hyselam::Point2& p : change.cells) {
        cells.points.push_back(hyselam::at(p.x, p.y, 0.1));
      }
    }
    if (!cells.points.empty()) array.markers.push_back(std::move(cells));
  }
  // What is seen from far: a disc around each, and its name above all else.
  Marker disc = marker(header, "places", Marker::CYLINDER, 0.0);
  Marker name = marker(header, "names", Marker::TEXT_VIEW_FACING, 0.0);
  name.scale.z = 0.45;
  for (const MapChange& change : changes) {
    disc.scale.x = disc.scale.y = change.size + 2.0 * kAround;
    disc.scale.z = 0.02;
    disc.pose.position = hyselam::at(change.center.x, change.center.y, 0.03);
    disc.color = colorOf(change.kind, 0.3);
    array.markers.push_back(disc);
    ++disc.id;
    if (change.size < kNamedSize) continue;
    name.pose.position =
        hyselam::at(change.center.x, change.center.y + 0.5 * change.size + kAround, kAboveRegions);
    name.color = colorOf(change.kind, 1.0);
    name.text =
        change.again ? std::string(toString(change.kind)) + " again" : toString(change.kind);
    array.markers.push_back(name);
    ++name.id;
  }
  return array;
}

visualization_msgs::MarkerArray slamMarkers(const std::vector<SlamKeyframe>& keyframes,
                                            const std::vector<bool>& shown,
                                            const std::vector<SlamLoop>& loops,
                                            const RegionGraph& graph,
                                            const std_msgs::Header& header) {
  const auto isShown = [&](std::uint32_t run) {
    return (run < shown.size() && shown[run]) || run == keyframes.back().run;
  };
  const auto runOf = [&](int k) { return keyframes[static_cast<std::size_t>(k)].run; };
  visualization_msgs::MarkerArray array;
  Marker clear;
  clear.header = header;
  clear.action = Marker::DELETEALL;
  array.markers.push_back(clear);
  const auto add = [&](Marker m) {
    if (!m.points.empty()) array.markers.push_back(std::move(m));
  };

  Marker path = marker(header, "path", Marker::LINE_LIST, 0.06);
  for (std::size_t i = 1; i < keyframes.size(); ++i)
    if (keyframes[i].run == keyframes[i - 1].run && isShown(keyframes[i].run))
      addLine(&path, keyframes[i - 1].pose, keyframes[i].pose, 0.05,
              keyframes[i].run == keyframes.back().run ? color(0.15, 0.35, 0.85)
                                                       : color(0.55, 0.55, 0.6));
  add(std::move(path));

  Marker lines = marker(header, "loops", Marker::LINE_LIST, 0.05);
  for (const SlamLoop& l : loops) {
    if (!isShown(runOf(l.older)) || !isShown(runOf(l.newer))) continue;
    addLine(&lines, keyframes[static_cast<std::size_t>(l.older)].pose,
            keyframes[static_cast<std::size_t>(l.newer)].pose, 0.1,
            l.weight < kDoubtfulWeight           ? color(0.9, 0.1, 0.1)
            : l.source == LoopSource::kNgram     ? color(0.85, 0.1, 0.75)
            : l.source == LoopSource::kSignature ? color(0.95, 0.55, 0.1)
                                                 : color(0.1, 0.65, 0.25));
  }
  add(std::move(lines));

  Marker links = marker(header, "region_links", Marker::LINE_LIST, 0.08);
  for (const RegionEdge& link : graph.edges) {
    if (!isShown(graph.nodes[link.a].run) || !isShown(graph.nodes[link.b].run)) continue;
    addLine(&links, graph.nodes[link.a].pose, graph.nodes[link.b].pose, 1.0,
            link.kind == RegionEdge::Kind::kLoop ? color(0.85, 0.1, 0.75, 0.6)
                                                 : color(0.25, 0.25, 0.25, 0.6));
  }
  add(std::move(links));

  Marker balls = marker(header, "regions", Marker::SPHERE_LIST, 0.6);
  balls.scale.y = balls.scale.z = 0.6;
  for (const RegionNode& node : graph.nodes) {
    if (!isShown(node.run)) continue;
    balls.points.push_back(at(node.pose, 1.0));
    balls.colors.push_back(colorOf(node.semantic_class));
  }
  add(std::move(balls));

  Marker name = marker(header, "region_names", Marker::TEXT_VIEW_FACING, 0.0);
  name.scale.z = 0.5;
  for (const RegionNode& node : graph.nodes) {
    if (!isShown(node.run)) continue;
    name.id = static_cast<int>(&node - graph.nodes.data());
    name.pose.position = at(node.pose * hyselam::Pose2{0.0, 0.6, 0.0}, 1.3);
    name.text = toString(node.semantic_class);
    array.markers.push_back(name);
  }
  return array;
}

}  // namespace ngram_slam
