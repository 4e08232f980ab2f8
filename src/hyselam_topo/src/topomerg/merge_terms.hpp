// The terms of the fitness as losses: 1 - f is a sum over names, pairs of names and relations, so
// that a part of an answer has a loss of its own and more of the answer only adds to it.
#pragma once

#include <cmath>
#include <vector>

#include "hyselam_common/pose2.hpp"
#include "hyselam_topo/topomerg/topomerg_problem.hpp"

namespace hyselam_topo::merging {

using hyselam::kPi;

/// To -pi .. pi, for angles within -3 pi .. 3 pi: the search does this all the time, and
/// hyselam::wrapAngle() divides.
inline double wrapped(double angle) {
  if (angle > kPi) return angle - 2.0 * kPi;
  if (angle < -kPi) return angle + 2.0 * kPi;
  return angle;
}

/// The same line seen from its other end.
inline double turned(double bearing) {
  return bearing > 0.0 ? bearing - kPi : bearing + kPi;
}

/// The vertices that one name means, and what follows from them.
struct Vertices {
  PlaceSet members;
  PlaceSet around;      ///< neighbours of the members in the map, without the members
  double area = 0.0;    ///< [m^2]
  double weight = 0.0;  ///< of all positions
  double sx = 0.0;      ///< sum of weight * x
  double sy = 0.0;
  int count = 0;

  PlaceSet behind;  ///< what shares a wall with the members, without the members

  bool empty() const { return count == 0; }
  bool hasCentre() const { return weight > 0.0; }
  double x() const { return sx / weight; }
  double y() const { return sy / weight; }
  bool touches(const Vertices& other) const { return around.intersects(other.members); }
  bool sharesWall(const Vertices& other) const { return behind.intersects(other.members); }
  void add(const MatchProblem& problem, std::size_t vertex);
};

/// How two names lie to each other in the map.
enum class Contact {
  kNone,
  kWall,  ///< no way, but a wall that may hide a shut door
  kJoined
};

/// The robot's heading, known up to `slack`: angles count as right within it.
struct Heading {
  double value = 0.0;
  double slack = 0.0;
};

class Terms {
 public:
  /// A relation, or an order told: about two or three names.
  struct Clause {
    RelationKind kind = RelationKind::kNextTo;
    int a = 0, b = 0, c = -1;  ///< of an order: first, then, seen from
    bool order = false;
    double turn = 0.0;  ///< of an order
  };

  Terms(const MatchProblem& problem, const FitnessParams& params);

  /// The weights of another problem, of which this one is a part.
  void weighAs(const Terms& whole);

  const MatchProblem& problem;
  double empty_name = 0.0;      ///< loss of a name without vertices
  double area = 0.0;            ///< the most one wrong size costs
  double missing_edge = 0.0;    ///< told, not in the map
  double forgotten_edge = 0.0;  ///< in the map, not told
  double side = 0.0;            ///< the most one wrong side costs
  double relation = 0.0;
  double order = 0.0;  ///< of two neighbours in a row told
  double rank = 0.0;   ///< of one place in a row told
  bool by_doors = false;
  double shut_door = 0.0;  ///< of the value of an edge and its side, left where a wall is shared
  double parts = 0.0;
  double kind = 0.0;
  double evidence = 0.0;
  std::vector<std::vector<int>> sides_of;  ///< of each name, numbers in problem.sides
  std::vector<Clause> clauses;
  std::vector<std::vector<int>> clauses_of;  ///< of each name, numbers in `clauses`
  std::vector<char> has_evidence;            ///< of each name

  /// What a name alone loses.
  double alone(int name, const Vertices& v) const;
  Contact contact(const Vertices& a, const Vertices& b) const {
    if (a.touches(b)) return Contact::kJoined;
    return shut_door > 0.0 && a.sharesWall(b) ? Contact::kWall : Contact::kNone;
  }
  /// Of two names: joined as told or not.
  double edge(int i, int j, Contact is) const {
    const bool told = problem.areJoined(static_cast<std::size_t>(i), static_cast<std::size_t>(j));
    if (!told) return is == Contact::kJoined ? forgotten_edge : 0.0;
    return toldEdge(is);
  }
  /// Of two names that are told to be joined.
  double toldEdge(Contact is) const {
    return is == Contact::kJoined ? 0.0
           : is == Contact::kWall ? (1.0 - shut_door) * missing_edge
                                  : missing_edge;
  }
  /// Difference of what was told and a bearing in the map, 0 .. pi.
  double deviation(const MatchProblem::ToldSide& told, double bearing, Heading heading) const {
    const double said = by_doors ? told.middle : told.angle;
    const double off = std::abs(wrapped(wrapped(bearing - said) - heading.value)) - heading.slack;
    return off > 0.0 ? off : 0.0;
  }
  /// Whether a side can be compared: both are there, joined, and have positions.
  static bool comparable(const Vertices& from, const Vertices& to) {
    return from.hasCentre() && to.hasCentre() && from.touches(to);
  }
  static double bearing(const Vertices& from, const Vertices& to) {
    return std::atan2(to.y() - from.y(), to.x() - from.x());
  }
  double sideLoss(const MatchProblem::ToldSide& told, const Vertices& from, const Vertices& to,
                  Heading heading) const {
    if (by_doors)
      return doorLoss(told, from.members, to.members, heading) +
             rankLoss(told, from.members, to.members);
    if (!comparable(from, to)) return lostSide(told);
    return side * deviation(told, bearing(from, to), heading) / kPi;
  }
  /// Of the door that fits best, or the wall where there is no door.
  double doorLoss(const MatchProblem::ToldSide& told, const PlaceSet& from, const PlaceSet& to,
                  Heading heading) const;
  /// The same of any parts of these sets: doors and walls, whatever fits best.
  double leastDoorLoss(const MatchProblem::ToldSide& told, const PlaceSet& from, const PlaceSet& to,
                       Heading heading) const;
  /// Of the order told: as many doors as told must lie before and behind on that side of `from`.
  double rankLoss(const MatchProblem::ToldSide& told, const PlaceSet& from,
                  const PlaceSet& to) const;
  /// What is lost of a side that cannot be compared.
  double lostSide(const MatchProblem::ToldSide& told) const {
    return side + (told.before + told.after > 0 ? rank : 0.0);
  }
  /// All passages from one set into the other: visit(passage).
  template <typename Visit>
  void forEachPassage(const PlaceSet& from, const PlaceSet& to, Visit&& visit) const {
    from.forEach([&](std::size_t v) {
      for (const MatchProblem::Passage& p : problem.passages[v])
        if (to.contains(p.to)) visit(p);
    });
  }
  /// Of the sides' loss through a door, or through a wall that may hide one.
  double throughDoor(double off) const { return side * off / kPi; }
  double throughWall(double off) const { return side * (1.0 - shut_door * (1.0 - off / kPi)); }
  /// The same of walls that shut doors may be in.
  template <typename Visit>
  void forEachWall(const PlaceSet& from, const PlaceSet& to, Visit&& visit) const {
    if (!(shut_door > 0.0)) return;
    from.forEach([&](std::size_t v) {
      if (!problem.behind[v].intersects(to)) return;
      for (const MatchProblem::Passage& p : problem.walls[v])
        if (to.contains(p.to)) visit(p);
    });
  }
  /// Passages, and walls if there are none; tells which: `shut_door`, or 1 for passages.
  template <typename Visit>
  double forEachDoor(const PlaceSet& from, const PlaceSet& to, Visit&& visit) const {
    bool any = false;
    forEachPassage(from, to, [&](const MatchProblem::Passage& p) {
      any = true;
      visit(p);
    });
    if (!any) forEachWall(from, to, visit);
    return any ? 1.0 : shut_door;
  }
  /// `of` gives the vertices of a name.
  template <typename Of>
  double clauseLoss(const Clause& clause, Of&& of) const {
    if (clause.order) {
      return order * (1.0 - orderValue(clause, of(clause.a), of(clause.b), of(clause.c)));
    }
    const Vertices* c = clause.c >= 0 ? &of(clause.c) : nullptr;
    return relation * (1.0 - relationValue(clause.kind, of(clause.a), of(clause.b), c));
  }

 private:
  double orderValue(const Clause& clause, const Vertices& first, const Vertices& then,
                    const Vertices& from) const;
  double relationValue(RelationKind kind, const Vertices& a, const Vertices& b,
                       const Vertices* c) const;
};

/// The vertices of each name.
std::vector<Vertices> verticesOf(const MatchProblem& problem, const Assignment& assignment);

/// Fitness of a whole answer and the heading that it holds for.
double evaluate(const Terms& terms, const std::vector<Vertices>& names, double* heading);

/// Whether places of each name hang together as MatchParams::connected asks.
bool hangTogether(const MatchProblem& problem, const PlaceSet& members);

}  // namespace hyselam_topo::merging
