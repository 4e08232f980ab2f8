#include "hyselam_topo/dialogue/topo_state.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "hyselam_topological_map/map_geometry.hpp"
#include "plane.hpp"

namespace hyselam_topo {
namespace {

/// From a point to the nearest opening of two places, or of any door of the first if `b` is 0.
double doorDistance(const AugmentedTopologicalMap& map, Id a, Id b, hyselam::Point2 point) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Edge& edge : map.edges) {
    const bool touches = edge.a == a || edge.b == a;
    const bool joins = touches && (b == 0 || edge.a == b || edge.b == b);
    if (!joins) continue;
    for (const Door& door : edge.doors) {
      const Segment opening = ends(door);
      nearest = std::min(nearest, distanceToSegment(point, opening.first, opening.second));
    }
  }
  return nearest;
}

}  // namespace

void TopoStateParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit.renamed("doorway", "doorway_distance");
  visit.renamed("reach", "max_place_distance");
  visit.renamed("settle", "settle_time");
  visit.renamed("jump", "max_pose_step");
  visit("doorway_distance", doorway_distance, Range::between(0.0, 5.0), "m",
        "within this of a door the robot is in the doorway and its place does not change");
  visit("max_place_distance", max_place_distance, Range::between(0.0, 5.0), "m",
        "a pose on no place counts to the nearest one within this");
  visit("settle_time", settle_time, Range::between(0.0, 3600.0), "s",
        "after this the place changes in a doorway, too");
  visit("max_pose_step", max_pose_step, Range::between(0.01, 100.0), "m",
        "a longer step is a new pose: no doorway holds the place");
}

void TopoStateParams::validate() const {
  hyselam::checkParameters(*this);
}

TopoState::TopoState(const TopoStateParams& params) : params_(params) {
  params.validate();
}

bool TopoState::set(Id place, bool in_doorway) {
  const bool changed = place != robot_.place || in_doorway != robot_.in_doorway;
  if (place != robot_.place && robot_.place != 0) robot_.previous = robot_.place;
  robot_.place = place;
  robot_.in_doorway = in_doorway;
  if (place != 0 && !in_doorway) candidate_ = 0;
  return changed;
}

bool TopoState::lost(double stamp) {
  robot_.stamp = stamp;
  robot_.has_pose = false;
  candidate_ = 0;
  return set(0, false);
}

bool TopoState::mapChanged(const AugmentedTopologicalMap& map) {
  if (robot_.previous != 0 && map.findPlace(robot_.previous) == nullptr) robot_.previous = 0;
  candidate_ = 0;
  if (robot_.place == 0 || map.findPlace(robot_.place) != nullptr) return false;
  robot_.place = 0;
  robot_.in_doorway = false;
  return true;
}

bool TopoState::update(const AugmentedTopologicalMap& map, double stamp,
                       const hyselam::Pose2& pose) {
  if (!pose.isFinite()) return lost(stamp);
  const bool jumped = !robot_.has_pose || stamp < robot_.stamp ||
                      hyselam::distance(pose, robot_.pose) > params_.max_pose_step;
  robot_.stamp = stamp;
  robot_.pose = pose;
  robot_.has_pose = true;
  const hyselam::Point2 point{pose.x, pose.y};
  const auto here = placeAt(map, point, params_.max_place_distance);
  const Id held = robot_.place;
  if (!here) {
    // Thresholds may belong to no place: a held place ends where its doors are no longer near.
    const bool at_door =
        held != 0 && !jumped && doorDistance(map, held, 0, point) <= params_.doorway_distance;
    candidate_ = 0;
    return set(at_door ? held : 0, at_door);
  }
  const Id now = here->place;
  const bool near_door = doorDistance(map, now, 0, point) <= params_.doorway_distance;
  if (now == held || held == 0 || jumped || map.findPlace(held) == nullptr) {
    candidate_ = 0;
    return set(now, near_door);
  }
  if (candidate_ != now) {
    candidate_ = now;
    candidate_since_ = stamp;
  }
  // Without a door on record the robot came through an opening that is not: there is none to be
  // near to, so the place changes at once.
  const bool between = doorDistance(map, now, held, point) <= params_.doorway_distance;
  if (between && stamp - candidate_since_ < params_.settle_time) return set(held, true);
  return set(now, near_door);
}

}  // namespace hyselam_topo
