#include "ngram_slam/ros/slam_graph_messages.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/ros/conversions.hpp"

namespace ngram_slam {

using hyselam::InputError;
using hyselam::Pose2;
using hyselam_pose_graph::PoseEdge;

namespace {

/// Where in an answer something is wrong.
struct Place {
  const std::string& source;
  std::string name;
  [[noreturn]] void refuse(const std::string& reason) const {
    throw InputError(source, name, reason);
  }
  double finite(double value) const {
    if (!std::isfinite(value)) refuse("holds a number that is not finite");
    return value;
  }
  double part(double value) const {
    if (!(value >= 0.0 && value <= 1.0)) refuse("holds a part that is not 0 to 1");
    return value;
  }
  Pose2 pose(const geometry_msgs::Pose2D& msg) const {
    return {finite(msg.x), finite(msg.y), finite(msg.theta)};
  }
};

int numberOf(std::uint32_t number, const Place& place) {
  if (number > static_cast<std::uint32_t>(std::numeric_limits<int>::max())) {
    place.refuse("names a keyframe that does not exist");
  }
  return static_cast<int>(number);
}

hyselam_msgs::SlamEdge toMsg(const PoseEdge& e) {
  hyselam_msgs::SlamEdge msg;
  msg.from = static_cast<std::uint32_t>(e.from);
  msg.to = static_cast<std::uint32_t>(e.to);
  msg.measured = hyselam::toPose2dMsg(e.measured);
  for (int i = 0; i < 9; ++i) {
    msg.information[static_cast<std::size_t>(i)] = e.information(i / 3, i % 3);
  }
  return msg;
}

PoseEdge fromMsg(const hyselam_msgs::SlamEdge& msg, const Place& place) {
  PoseEdge e;
  e.from = numberOf(msg.from, place);
  e.to = numberOf(msg.to, place);
  e.measured = place.pose(msg.measured);
  for (int i = 0; i < 9; ++i) {
    e.information(i / 3, i % 3) = place.finite(msg.information[static_cast<std::size_t>(i)]);
  }
  // What the optimizer needs: a matrix of certainty.
  const Eigen::Matrix3d& m = e.information;
  if (!m.isApprox(m.transpose(), 1e-6) || m.diagonal().minCoeff() < 0.0) {
    place.refuse("holds an information matrix that is none");
  }
  return e;
}

hyselam_msgs::SlamKeyframe toMsg(const SlamKeyframe& k) {
  hyselam_msgs::SlamKeyframe msg;
  msg.stamp = hyselam::toRosTime(k.stamp);
  msg.run = k.run;
  msg.path_length = k.path_length;
  msg.odometry = hyselam::toPose2dMsg(k.odometry);
  msg.pose = hyselam::toPose2dMsg(k.pose);
  const hyselam::LaserScan& scan = *k.scan;
  msg.laser = hyselam::toPose2dMsg(scan.laser_in_base);
  msg.angle_min = scan.angle_min;
  msg.angle_increment = scan.angle_increment;
  msg.range_min = scan.range_min;
  msg.range_max = scan.range_max;
  msg.ranges = scan.ranges;
  return msg;
}

SlamKeyframe fromMsg(const hyselam_msgs::SlamKeyframe& msg, const Place& place) {
  SlamKeyframe k;
  k.stamp = hyselam::toSeconds(msg.stamp);
  k.run = msg.run;
  k.path_length = place.finite(msg.path_length);
  k.odometry = place.pose(msg.odometry);
  k.pose = place.pose(msg.pose);
  hyselam::LaserScan scan;
  scan.stamp = k.stamp;
  scan.laser_in_base = place.pose(msg.laser);
  scan.angle_min = place.finite(msg.angle_min);
  scan.angle_increment = place.finite(msg.angle_increment);
  scan.range_min = place.finite(msg.range_min);
  scan.range_max = msg.range_max;  // may be infinite; the rest is checked with the graph
  scan.ranges = msg.ranges;
  k.scan = std::make_shared<const hyselam::LaserScan>(std::move(scan));
  return k;
}

hyselam_msgs::SlamLoop toMsg(const SlamLoop& l) {
  hyselam_msgs::SlamLoop msg;
  msg.edge = toMsg(PoseEdge{l.older, l.newer, l.measured, l.information});
  msg.source = static_cast<std::uint8_t>(l.source);
  msg.far = l.far;
  msg.inlier_ratio = l.inlier_ratio;
  msg.fit = l.fit;
  msg.weight = l.weight;
  return msg;
}

SlamLoop fromMsg(const hyselam_msgs::SlamLoop& msg, const Place& place) {
  const PoseEdge edge = fromMsg(msg.edge, place);
  SlamLoop l;
  l.older = edge.from;
  l.newer = edge.to;
  l.measured = edge.measured;
  l.information = edge.information;
  if (msg.source > static_cast<std::uint8_t>(LoopSource::kSignature)) {
    place.refuse("has an unknown source");
  }
  l.source = static_cast<LoopSource>(msg.source);
  l.far = msg.far != 0;
  l.inlier_ratio = place.part(msg.inlier_ratio);
  l.fit = place.part(msg.fit);
  l.weight = place.part(msg.weight);
  return l;
}

hyselam_msgs::SettledCells toMsg(const SettledMap& settled) {
  hyselam_msgs::SettledCells msg;
  if (settled.cells.empty()) return msg;
  msg.cell = settled.cell;
  for (const SettledCell& c : settled.cells) {
    msg.keyframes.push_back(static_cast<std::uint32_t>(c.keyframe));
    geometry_msgs::Point32 center;
    center.x = static_cast<float>(c.center.x);
    center.y = static_cast<float>(c.center.y);
    msg.centers.push_back(center);
    msg.log_odds.push_back(c.log_odds);
    msg.visits.push_back(c.visits);
    msg.changes.push_back(c.changes);
    msg.runs.push_back(c.run);
  }
  return msg;
}

SettledMap fromMsg(const hyselam_msgs::SettledCells& msg, const Place& place) {
  SettledMap settled;
  const std::size_t n = msg.keyframes.size();
  for (const std::size_t size : {msg.centers.size(), msg.log_odds.size(), msg.visits.size(),
                                 msg.changes.size(), msg.runs.size()}) {
    if (size != n) place.refuse("arrays of different lengths");
  }
  if (n == 0) return settled;
  settled.cell = place.finite(msg.cell);
  for (std::size_t i = 0; i < n; ++i) {
    SettledCell c;
    c.keyframe = numberOf(msg.keyframes[i], place);
    c.center = {place.finite(static_cast<double>(msg.centers[i].x)),
                place.finite(static_cast<double>(msg.centers[i].y))};
    c.log_odds = static_cast<float>(place.finite(static_cast<double>(msg.log_odds[i])));
    c.visits = msg.visits[i];
    c.changes = msg.changes[i];
    c.run = msg.runs[i];
    settled.cells.push_back(c);
  }
  return settled;
}

/// Each of an array; `name` of one in messages of errors.
template <typename Msgs, typename Values>
void allFromMsg(const Msgs& msgs, const std::string& source, const char* name, Values* values) {
  for (std::size_t i = 0; i < msgs.size(); ++i) {
    values->push_back(fromMsg(msgs[i], Place{source, name + std::to_string(i)}));
  }
}

}  // namespace

GraphQuestion fromMsg(const hyselam_msgs::SlamGraph::Request& msg) {
  return {msg.map, msg.keyframes, msg.version, msg.max_keyframes};
}

void toMsg(const GraphQuestion& question, hyselam_msgs::SlamGraph::Request* msg) {
  msg->map = question.map;
  msg->keyframes = question.keyframes;
  msg->version = question.version;
  msg->max_keyframes = question.max_keyframes;
}

void toMsg(const GraphPart& part, hyselam_msgs::SlamGraph::Response* msg) {
  msg->map = part.map;
  msg->first = part.first;
  msg->complete = part.complete;
  msg->version = part.version;
  for (const SlamKeyframe& k : part.keyframes) msg->new_keyframes.push_back(toMsg(k));
  for (const PoseEdge& e : part.odometry) msg->odometry.push_back(toMsg(e));
  for (const Pose2& p : part.poses) msg->poses.push_back(hyselam::toPose2dMsg(p));
  for (const SlamLoop& l : part.loops) msg->loops.push_back(toMsg(l));
  msg->settled = toMsg(part.settled);
}

GraphPart fromMsg(const hyselam_msgs::SlamGraph::Response& msg, const std::string& source) {
  GraphPart part;
  part.map = msg.map;
  part.first = msg.first;
  part.complete = msg.complete != 0;
  part.version = msg.version;
  part.changed = !msg.poses.empty();
  allFromMsg(msg.new_keyframes, source, "new keyframe ", &part.keyframes);
  allFromMsg(msg.odometry, source, "edge ", &part.odometry);
  for (std::size_t i = 0; i < msg.poses.size(); ++i) {
    part.poses.push_back(Place{source, "pose " + std::to_string(i)}.pose(msg.poses[i]));
  }
  allFromMsg(msg.loops, source, "loop ", &part.loops);
  part.settled = fromMsg(msg.settled, Place{source, "settled cells"});
  return part;
}

}  // namespace ngram_slam
