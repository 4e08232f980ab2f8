// The terms of the fitness as losses: 1 - f is a sum over names, pairs of names and relations, so
// that a part of an assignment has a loss of its own and more of the assignment only adds to it.
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "angles.hpp"
#include "hyselam_topo/topomerg/fitness.hpp"
#include "hyselam_topo/topomerg/topomerg_problem.hpp"

namespace hyselam_topo::merging {

/// The vertices that one name means, and what follows from them.
struct VertexSet {
  PlaceSet members;
  PlaceSet neighbors;   ///< of the members in the map, without the members
  double area = 0.0;    ///< [m^2]
  double weight = 0.0;  ///< of all positions
  double sx = 0.0;      ///< sum of weight * x
  double sy = 0.0;
  int count = 0;

  PlaceSet across_walls;  ///< what shares a wall with the members, without the members

  bool empty() const { return count == 0; }
  bool hasCenter() const { return weight > 0.0; }
  double x() const { return sx / weight; }
  double y() const { return sy / weight; }
  bool touches(const VertexSet& other) const { return neighbors.intersects(other.members); }
  bool sharesWall(const VertexSet& other) const { return across_walls.intersects(other.members); }
  void add(const MatchProblem& problem, std::size_t vertex);
};

/// How two names lie to each other in the map.
enum class Contact {
  kNone,
  kWall,  ///< not connected, but a wall that may hide a closed door
  kJoined
};

/// The robot's heading, known up to `slack`: angles count as right within it.
struct Heading {
  double value = 0.0;
  double slack = 0.0;
};

/// Kinds of terms, each with the most that one term of it loses.
enum class Term {
  kVertex,    ///< a name without vertices
  kArea,      ///< a wrong size
  kEdge,      ///< described, not in the map
  kSide,      ///< a wrong side
  kRelation,  ///< next to, opposite, ...
  kParts,
  kKind,
  kEvidence,
  kOrder,  ///< of two neighbors in a described row
  kRank,   ///< of one place in a described row
  kCount
};

class FitnessTerms {
 public:
  /// A relation, or a described order: about two or three names.
  struct Clause {
    RelationKind kind = RelationKind::kNextTo;
    int a = 0, b = 0, c = -1;  ///< of an order: first, then, seen from
    bool order = false;
    double turn = 0.0;  ///< of an order
  };

  FitnessTerms(const MatchProblem& problem, const FitnessParams& params);

  /// The weights of another problem, of which this one is a part.
  void copyWeights(const FitnessTerms& whole) {
    weights_ = whole.weights_;
    undescribed_edge = whole.undescribed_edge;
  }
  double weight(Term term) const { return weights_[static_cast<std::size_t>(term)]; }

  const MatchProblem& problem;
  double undescribed_edge = 0.0;  ///< loss of an edge in the map that is not described
  bool by_doors = false;
  /// Share of the value of an edge and its side that remains where a wall is shared; 0 without
  /// doors and walls.
  double closed_door_credit = 0.0;
  std::vector<std::vector<int>> sides_of;  ///< of each name, numbers in problem.sides
  std::vector<Clause> clauses;
  std::vector<std::vector<int>> clauses_of;  ///< of each name, numbers in `clauses`
  std::vector<char> has_evidence;            ///< of each name

  /// What a name on its own loses.
  double unaryLoss(int name, const VertexSet& v) const;
  Contact contact(const VertexSet& a, const VertexSet& b) const {
    if (a.touches(b)) return Contact::kJoined;
    return closed_door_credit > 0.0 && a.sharesWall(b) ? Contact::kWall : Contact::kNone;
  }
  /// Of two names: connected as described or not.
  double edgeLoss(int i, int j, Contact contact) const {
    if (problem.areConnected(static_cast<std::size_t>(i), static_cast<std::size_t>(j)))
      return describedEdgeLoss(contact);
    return contact == Contact::kJoined ? undescribed_edge : 0.0;
  }
  /// Of two names that are described as connected.
  double describedEdgeLoss(Contact contact) const {
    const double missing_edge = weight(Term::kEdge);
    return contact == Contact::kJoined ? 0.0
           : contact == Contact::kWall ? (1.0 - closed_door_credit) * missing_edge
                                       : missing_edge;
  }
  /// Difference of a described side and a bearing in the map, 0 .. pi.
  double deviation(const MatchProblem::DescribedSide& side, double bearing, Heading heading) const {
    const double described = by_doors ? side.side_angle : side.angle;
    const double off =
        std::abs(wrapAngleOnce(wrapAngleOnce(bearing - described) - heading.value)) - heading.slack;
    return off > 0.0 ? off : 0.0;
  }
  /// Whether a side can be compared: both are there, connected, and have positions.
  static bool comparable(const VertexSet& from, const VertexSet& to) {
    return from.hasCenter() && to.hasCenter() && from.touches(to);
  }
  static double bearing(const VertexSet& from, const VertexSet& to) {
    return std::atan2(to.y() - from.y(), to.x() - from.x());
  }
  double sideLoss(const MatchProblem::DescribedSide& side, const VertexSet& from,
                  const VertexSet& to, Heading heading) const {
    if (by_doors)
      return doorLoss(side, from.members, to.members, heading) +
             rankLoss(side, from.members, to.members);
    if (!comparable(from, to)) return missingSideLoss(side);
    return weight(Term::kSide) * deviation(side, bearing(from, to), heading) / kPi;
  }
  /// Of the door that fits best, or the wall where there is no door.
  double doorLoss(const MatchProblem::DescribedSide& side, const PlaceSet& from, const PlaceSet& to,
                  Heading heading) const;
  /// The same of any parts of these sets: doors and walls, whatever fits best.
  double minDoorLoss(const MatchProblem::DescribedSide& side, const PlaceSet& from,
                     const PlaceSet& to, Heading heading) const;
  /// Of the described order: as many doors as described must lie before and behind on that side of
  /// `from`.
  double rankLoss(const MatchProblem::DescribedSide& side, const PlaceSet& from,
                  const PlaceSet& to) const;
  /// Loss of a side that cannot be compared.
  double missingSideLoss(const MatchProblem::DescribedSide& side) const {
    return weight(Term::kSide) + (side.before + side.after > 0 ? weight(Term::kRank) : 0.0);
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
  double throughDoor(double off) const { return weight(Term::kSide) * off / kPi; }
  double throughWall(double off) const {
    return weight(Term::kSide) * (1.0 - closed_door_credit * (1.0 - off / kPi));
  }
  /// The same of walls that closed doors may be in.
  template <typename Visit>
  void forEachWall(const PlaceSet& from, const PlaceSet& to, Visit&& visit) const {
    if (!(closed_door_credit > 0.0)) return;
    from.forEach([&](std::size_t v) {
      if (!problem.across_walls[v].intersects(to)) return;
      for (const MatchProblem::Passage& p : problem.walls[v])
        if (to.contains(p.to)) visit(p);
    });
  }
  /// Passages, and walls if there are none; returns the credit: `closed_door_credit`, or 1 for
  /// passages.
  template <typename Visit>
  double forEachDoor(const PlaceSet& from, const PlaceSet& to, Visit&& visit) const {
    bool any = false;
    forEachPassage(from, to, [&](const MatchProblem::Passage& p) {
      any = true;
      visit(p);
    });
    if (!any) forEachWall(from, to, visit);
    return any ? 1.0 : closed_door_credit;
  }
  /// `of` gives the vertices of a name.
  template <typename Of>
  double clauseLoss(const Clause& clause, Of&& of) const {
    if (clause.order) {
      return weight(Term::kOrder) *
             (1.0 - orderValue(clause, of(clause.a), of(clause.b), of(clause.c)));
    }
    const VertexSet* c = clause.c >= 0 ? &of(clause.c) : nullptr;
    return weight(Term::kRelation) *
           (1.0 - relationValue(clause.kind, of(clause.a), of(clause.b), c));
  }

 private:
  void listClauses(const FitnessParams& params);
  void shareWeights(const FitnessParams& params);
  double orderValue(const Clause& clause, const VertexSet& first, const VertexSet& then,
                    const VertexSet& from) const;
  double relationValue(RelationKind kind, const VertexSet& a, const VertexSet& b,
                       const VertexSet* c) const;

  std::array<double, static_cast<std::size_t>(Term::kCount)> weights_{};
};

/// The vertices of each name.
std::vector<VertexSet> verticesOf(const MatchProblem& problem, const Assignment& assignment);

/// Fitness of a whole assignment and the heading that it holds for.
double evaluate(const FitnessTerms& terms, const std::vector<VertexSet>& names, double* heading);

/// Whether the places of a name are connected as SolverParams::connected asks.
bool isConnected(const MatchProblem& problem, const PlaceSet& members);

}  // namespace hyselam_topo::merging
