// How well a statement about several names holds of their vertices, 0 .. 1.
#include <algorithm>

#include "fitness_terms.hpp"

namespace hyselam_topo::merging {
namespace {

using Passage = MatchProblem::Passage;

/// Rooms count as fully next to each other up to so many times the distance of the centers of two
/// rooms of their sizes that touch, and as fully opposite up to so many: a corridor lies between.
constexpr double kNextToReach = 1.25;
constexpr double kOppositeReach = 2.0;
/// What "next to" is worth if the walls are known and no wall is common.
constexpr double kNoCommonWall = 0.7;
/// What "opposite" is worth without a common neighbor, as a share of its value.
constexpr double kNotAcross = 0.5;
/// The same of two doors of the neighbor that do not face each other.
constexpr double kNotFacing = 0.25;
/// Doors whose directions add up to less than this (of 2) are not on the same side.
constexpr double kSameSide = 1.6;
/// Of the vectors through doors on the same side, their product is more than this; of such that
/// face each other it is less than minus this.
constexpr double kParallel = 0.8;
/// Doors that are less apart are counted as neither before nor behind each other [m].
constexpr double kBeside = 0.3;
/// A door that lies as far behind another is certainly behind it [m].
constexpr double kClearlyAhead = 0.5;
/// The same of centers of rooms [m].
constexpr double kClearlyFarther = 1.5;
/// Of "A, then B": each door between them costs this, and so many at most.
constexpr double kSkippedDoor = 0.1;
constexpr int kMostSkipped = 3;
/// What "the second door" is worth if it may be the second, but walls where a door may be come
/// before it, and if it is the first or the third, or still farther off.
constexpr double kUncertainNumber = 0.9;
constexpr double kNextNumber = 0.2;
constexpr double kSecondNextNumber = 0.05;
/// Told distances are right within this share and as many metres.
constexpr double kDistanceShare = 0.25;
constexpr double kDistanceError = 1.0;

double distance(const VertexSet& a, const VertexSet& b) {
  return std::hypot(a.x() - b.x(), a.y() - b.y());
}

/// About how far the middles of two rooms of these sizes are apart if they touch.
double reach(const VertexSet& a, const VertexSet& b) {
  return 0.5 * (std::sqrt(a.area) + std::sqrt(b.area));
}

double within(double value) {
  return std::clamp(value, 0.0, 1.0);
}

double angleBetween(double ax, double ay, double bx, double by) {
  return std::abs(std::atan2(ax * by - ay * bx, ax * bx + ay * by));
}

/// The unit vector that is `turn` to the left of the direction through a door.
hyselam::Point2 turned(const Passage& p, double turn) {
  const double c = std::cos(turn), s = std::sin(turn);
  return {c * p.dx - s * p.dy, s * p.dx + c * p.dy};
}

}  // namespace

double FitnessTerms::clauseValue(const Clause& clause, const VertexSet& a, const VertexSet& b,
                                 const VertexSet* c) const {
  switch (clause.what) {
    case Clause::What::kOrder:
      return orderValue(clause, a, b, *c);
    case Clause::What::kNumber:
      return numberValue(clause, a, b);
    case Clause::What::kDistance:
      return distanceValue(clause, a, b);
    case Clause::What::kRelation:
      break;
  }
  return relationValue(clause, a, b, c);
}

double FitnessTerms::orderValue(const Clause& clause, const VertexSet& first, const VertexSet& then,
                                const VertexSet& from) const {
  struct Doors {
    double x = 0.0, y = 0.0, dx = 0.0, dy = 0.0;
    int count = 0;
  };
  const auto doorsInto = [&](const VertexSet& to) {
    Doors d;
    forEachDoor(from.members, to.members, [&d](const Passage& p) {
      d.x += p.x;
      d.y += p.y;
      d.dx += p.dx;
      d.dy += p.dy;
      ++d.count;
    });
    return d;
  };
  const Doors a = doorsInto(first), b = doorsInto(then);
  if (a.count == 0 || b.count == 0) return 0.0;
  const double dx = a.dx / a.count + b.dx / b.count, dy = a.dy / a.count + b.dy / b.count;
  const double length = std::hypot(dx, dy);
  if (length < kSameSide) return 0.5;
  const double c = std::cos(*clause.turn) / length, s = std::sin(*clause.turn) / length;
  const double ax = c * dx - s * dy, ay = s * dx + c * dy;
  const double start = ax * a.x / a.count + ay * a.y / a.count;
  const double on = ax * b.x / b.count + ay * b.y / b.count - start;
  int between = 0;
  from.members.forEach([&](std::size_t v) {
    for (const Passage& p : problem.passages[v]) {
      if (from.members.contains(p.to) || first.members.contains(p.to) ||
          then.members.contains(p.to) || p.dx * dx + p.dy * dy < kParallel * length)
        continue;
      const double at = ax * p.x + ay * p.y - start;
      between += at > kBeside && at < on - kBeside;
    }
  });
  return within(0.5 + 0.5 * on / kClearlyAhead) - kSkippedDoor * std::min(between, kMostSkipped);
}

double FitnessTerms::numberAt(const Clause& clause, const Passage& own, const VertexSet& from,
                              const PlaceSet& to) const {
  const bool far_end = clause.value < 0.0;
  const int told = static_cast<int>(std::abs(clause.value));
  const hyselam::Point2 on = turned(own, *clause.turn);
  const auto ahead = [&](double x, double y) { return on.x * (x - own.x) + on.y * (y - own.y); };
  const double robot = clause.position ? ahead(clause.position->x, clause.position->y) : 0.0;
  if (clause.position && robot > kClearlyAhead) return 0.0;  // it lies behind the robot
  int doors = 0, perhaps = 0;
  const auto count = [&](const Passage& p, bool seen) {
    if (p.dx * own.dx + p.dy * own.dy < kParallel) return;
    const double at = ahead(p.x, p.y);
    if (far_end ? at <= kBeside : at >= -kBeside) return;
    if (clause.position && at < robot - kClearlyAhead) return;
    // Beside the robot a door counts for some people and not for others.
    const bool beside = clause.position && at < robot + kClearlyAhead;
    ++(seen && !beside ? doors : perhaps);
  };
  from.members.forEach([&](std::size_t v) {
    for (const Passage& p : problem.passages[v])
      if (!from.members.contains(p.to) && !to.contains(p.to)) count(p, true);
    if (closed_door_credit > 0.0)
      for (const Passage& p : problem.walls[v])
        if (!from.members.contains(p.to) && !to.contains(p.to)) count(p, false);
    if (!problem.gaps.empty())
      for (const Passage& p : problem.gaps[v]) count(p, false);
  });
  const int off = std::max({told - (doors + perhaps + 1), doors + 1 - told, 0});
  return off == 0   ? (perhaps == 0 ? 1.0 : kUncertainNumber)
         : off == 1 ? kNextNumber
         : off == 2 ? kSecondNextNumber
                    : 0.0;
}

double FitnessTerms::numberValue(const Clause& clause, const VertexSet& to,
                                 const VertexSet& from) const {
  double best = 0.0;
  forEachDoor(from.members, to.members, [&](const Passage& own) {
    best = std::max(best, numberAt(clause, own, from, to.members));
  });
  return best;
}

double FitnessTerms::unseenNumberValue(const Clause& clause, const VertexSet& from) const {
  double best = 0.0;
  forEachHiddenDoor(from.members, clause.side_angle, [&](const Passage& own) {
    best = std::max(best, numberAt(clause, own, from, PlaceSet()));
  });
  return best;
}

double FitnessTerms::distanceValue(const Clause& clause, const VertexSet& to,
                                   const VertexSet& from) const {
  if (!clause.position) return 0.0;
  if (clause.value == 0.0 && clause.turn) return nearestValue(clause, to, from);
  const double error = kDistanceShare * clause.value + kDistanceError;
  double best = 0.0;
  forEachDoor(from.members, to.members, [&](const Passage& p) {
    const double dx = p.x - clause.position->x, dy = p.y - clause.position->y;
    double way = std::hypot(dx, dy);
    if (clause.turn) {
      const hyselam::Point2 on = turned(p, *clause.turn);
      way = on.x * dx + on.y * dy;
    }
    best = std::max(best, within(2.0 - std::abs(way - clause.value) / error));
  });
  return best;
}

double FitnessTerms::nearestValue(const Clause& clause, const VertexSet& to,
                                  const VertexSet& from) const {
  double best = 0.0;
  forEachDoor(from.members, to.members, [&](const Passage& own) {
    const hyselam::Point2 on = turned(own, *clause.turn);
    const auto way = [&](const Passage& p) {
      return std::abs(on.x * (p.x - clause.position->x) + on.y * (p.y - clause.position->y));
    };
    int nearer = 0;
    from.members.forEach([&](std::size_t v) {
      for (const Passage& p : problem.passages[v]) {
        const bool other = !from.members.contains(p.to) && !to.members.contains(p.to);
        const bool same_side = p.dx * own.dx + p.dy * own.dy >= kParallel;
        nearer += other && same_side && way(p) < way(own) - kBeside;
      }
    });
    best = std::max(best, nearer == 0 ? 1.0 : nearer == 1 ? kNextNumber : 0.0);
  });
  return best;
}

double FitnessTerms::relationValue(const Clause& clause, const VertexSet& a, const VertexSet& b,
                                   const VertexSet* c) const {
  if (clause.kind == RelationKind::kJoined) return a.touches(b) ? 1.0 : 0.0;
  if (clause.kind == RelationKind::kLarger)
    return b.area > 0.0 ? within((a.area / b.area - 0.7) / 0.4) : 0.5;
  if (clause.kind == RelationKind::kAtSide) return atSideValue(clause.side_angle, a, b);
  if (!a.hasCenter() || !b.hasCenter() || (c != nullptr && !c->hasCenter())) return 0.0;
  switch (clause.kind) {
    case RelationKind::kNextTo:
      return nearValue(a, b);
    case RelationKind::kOpposite:
      return oppositeValue(a, b);
    case RelationKind::kBetween:
      return c == nullptr ? 0.0 : betweenValue(a, b, *c);
    case RelationKind::kAtEndOf:
      return endValue(a, b);
    case RelationKind::kInside:
      return a.touches(b) ? static_cast<double>((a.neighbors & b.members).size()) /
                                static_cast<double>(a.neighbors.size())
                          : 0.0;
    case RelationKind::kAfter:
      return afterValue(clause, a, b, c);
    case RelationKind::kBehind:
      return behindValue(clause, a, b);
    case RelationKind::kLarger:
    case RelationKind::kJoined:
    case RelationKind::kAtSide:
      break;
  }
  return 0.0;
}

double FitnessTerms::nearValue(const VertexSet& a, const VertexSet& b) const {
  if (a.touches(b) || a.sharesWall(b)) return 1.0;
  const double near = within(kNextToReach * reach(a, b) / std::max(1e-9, distance(a, b)));
  return problem.across_walls.empty() ? near : kNoCommonWall * near;
}

double FitnessTerms::oppositeValue(const VertexSet& a, const VertexSet& b) const {
  const double near = within(kOppositeReach * reach(a, b) / std::max(1e-9, distance(a, b)));
  const PlaceSet common = a.neighbors & b.neighbors;
  if (a.touches(b) || common.empty()) return kNotAcross * near;
  if (!problem.has_doors) return near;
  // Doors of the common neighbor that face each other, not far apart along its walls.
  double facing = kNotFacing;
  common.forEach([&](std::size_t v) {
    for (const Passage& p : problem.passages[v]) {
      if (!a.members.contains(p.to)) continue;
      for (const Passage& q : problem.passages[v]) {
        if (!b.members.contains(q.to) || p.dx * q.dx + p.dy * q.dy > -kParallel) continue;
        const double doors = std::abs(p.dx * (q.y - p.y) - p.dy * (q.x - p.x));
        const double rooms = std::abs(p.dx * (b.y() - a.y()) - p.dy * (b.x() - a.x()));
        const double off = std::min(doors, rooms) / std::max(1e-9, reach(a, b));
        facing = std::max(facing, within(1.5 - 1.25 * off));
      }
    }
  });
  return near * facing;
}

double FitnessTerms::betweenValue(const VertexSet& a, const VertexSet& b,
                                  const VertexSet& c) const {
  const double angle = angleBetween(b.x() - a.x(), b.y() - a.y(), c.x() - a.x(), c.y() - a.y());
  const double straight = within((angle - kPi / 3.0) / (0.5 * kPi));
  return straight * (0.5 + 0.25 * (nearValue(a, b) + nearValue(a, c)));
}

double FitnessTerms::endValue(const VertexSet& a, const VertexSet& b) const {
  if (!a.touches(b)) return 0.0;
  double farthest = distance(a, b);
  b.neighbors.forEach([&](std::size_t v) {
    if (problem.weight[v] > 0.0)
      farthest = std::max(farthest, std::hypot(problem.x[v] - b.x(), problem.y[v] - b.y()));
  });
  return farthest > 0.0 ? distance(a, b) / farthest : 1.0;
}

double FitnessTerms::afterValue(const Clause& clause, const VertexSet& a, const VertexSet& b,
                                const VertexSet* c) const {
  const double near = nearValue(a, b);
  if (c == nullptr && !clause.position) return near;
  double dx = b.x() - (c != nullptr ? c->x() : clause.position->x);
  double dy = b.y() - (c != nullptr ? c->y() : clause.position->y);
  if (c == nullptr && clause.looked) {
    // Beside the robot it goes on to where it looks.
    const double ahead_x = std::cos(*clause.looked), ahead_y = std::sin(*clause.looked);
    if (std::abs(ahead_x * dx + ahead_y * dy) < kClearlyFarther) {
      dx = ahead_x;
      dy = ahead_y;
    }
  }
  const double way = std::hypot(dx, dy);
  if (way < kBeside) return near;
  const double on = (dx * (a.x() - b.x()) + dy * (a.y() - b.y())) / way;
  return within(0.5 + 0.5 * on / kClearlyFarther) * (0.5 + 0.5 * near);
}

double FitnessTerms::behindValue(const Clause& clause, const VertexSet& a,
                                 const VertexSet& b) const {
  const double near = nearValue(a, b);
  if (!clause.position) return near;
  const double angle = angleBetween(b.x() - clause.position->x, b.y() - clause.position->y,
                                    a.x() - b.x(), a.y() - b.y());
  return std::max(0.0, std::cos(angle)) * (0.5 + 0.5 * near);
}

double FitnessTerms::atSideValue(double side_angle, const VertexSet& a, const VertexSet& b) const {
  if (!problem.heading) return 0.0;
  const auto off = [&](double bearing) {
    return std::abs(wrapAngleOnce(wrapAngleOnce(bearing - side_angle) - *problem.heading));
  };
  double least = kPi;
  bool any = false;
  if (by_doors)
    forEachDoor(b.members, a.members, [&](const Passage& p) {
      least = std::min(least, off(p.bearing));
      any = true;
    });
  if (!any && a.hasCenter() && b.hasCenter()) least = off(bearing(b, a));
  return 1.0 - lostShare(least);
}

}  // namespace hyselam_topo::merging
