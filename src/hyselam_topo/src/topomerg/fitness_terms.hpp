// The terms of the fitness as losses: 1 - f is a sum over names, pairs of names and relations, so
// that a part of an assignment has a loss of its own and more of the assignment only adds to it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
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
  kOrder,   ///< of two neighbors in a described row
  kRank,    ///< of one place in a described row
  kNumber,  ///< the second on the left, in ten metres
  kDoors,   ///< number of doors
  kSizeWord,
  kPiece,  ///< a further place of a name
  kCount
};

class FitnessTerms {
 public:
  /// A statement about two or three names: a relation, a described order, number or distance.
  struct Clause {
    enum class What { kRelation, kOrder, kNumber, kDistance };
    What what = What::kRelation;
    RelationKind kind = RelationKind::kNextTo;
    /// Names; of an order: first, then, seen from; of a number or distance: of which, seen from.
    int a = 0, b = 0, c = -1;
    bool denied = false;
    std::optional<double> turn;  ///< of an order, a number and a distance
    double value = 0.0;          ///< number or distance [m]
    double side_angle = 0.0;     ///< of a number and of a denied side
    /// Where the robot stood when a number, distance or relation was told; nothing: not known.
    std::optional<hyselam::Point2> position;
    std::optional<double> looked = std::nullopt;  ///< of kAfter: where it looked then
    double strength = 1.0;                        ///< share of the weight
  };

  FitnessTerms(const MatchProblem& problem, const FitnessParams& params);

  /// The weights of another problem, of which this one is a part.
  void copyWeights(const FitnessTerms& whole) {
    weights_ = whole.weights_;
    scale_ = whole.scale_;
    undescribed_edge = whole.undescribed_edge;
    heading_is_exact_ = false;
  }
  double weight(Term term) const { return weights_[static_cast<std::size_t>(term)]; }
  /// A loss of 1 / scale makes an assignment e times less likely; 0: nobody knows.
  double scale() const { return scale_; }
  /// Of one statement that may be weaker than others.
  double sideWeight(const MatchProblem::DescribedSide& side) const {
    return side.strength * weight(Term::kSide);
  }
  double rankWeight(const MatchProblem::DescribedSide& side) const {
    return side.strength * weight(Term::kRank);
  }
  double clauseWeight(const Clause& clause) const {
    return clause.strength * weight(termOf(clause.what));
  }
  /// Of a statement about a name without vertices.
  double absentLoss(Term term) const { return absent_share * weight(term); }

  const MatchProblem& problem;
  double undescribed_edge = 0.0;  ///< loss of an edge in the map that is not described
  bool by_doors = false;
  double absent_share = 1.0;  ///< of a statement's weight, see FitnessParams
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
  double edgeLoss(int i, int j, const VertexSet& a, const VertexSet& b) const {
    const bool none = a.empty() || b.empty();
    if (problem.areConnected(static_cast<std::size_t>(i), static_cast<std::size_t>(j)))
      return none ? absentLoss(Term::kEdge) : describedEdgeLoss(contact(a, b));
    return !none && a.touches(b) ? undescribed_edge : 0.0;
  }
  /// Of two names that are described as connected and have vertices.
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
    if (from.empty() || to.empty()) return absentSideLoss(side, from, to);
    if (by_doors)
      return doorLoss(side, from.members, to.members, heading) +
             rankLoss(side, from.members, to.members);
    if (!comparable(from, to)) return missingSideLoss(side);
    return sideWeight(side) * deviation(side, bearing(from, to), heading) / kPi;
  }
  /// Of the door that fits best, or the wall where there is no door.
  double doorLoss(const MatchProblem::DescribedSide& side, const PlaceSet& from, const PlaceSet& to,
                  Heading heading) const;
  /// The same of any parts of these sets: doors and walls, whatever fits best.
  double minDoorLoss(const MatchProblem::DescribedSide& side, const PlaceSet& from,
                     const PlaceSet& to, Heading heading) const;
  /// Of the described order: as many doors as described must lie before and behind on that side of
  /// `from`, or walls where doors may be that the robot has not seen.
  double rankLoss(const MatchProblem::DescribedSide& side, const PlaceSet& from,
                  const PlaceSet& to) const;
  /// Of a side of which one name has no vertices: at least absent_share * missingSideLoss(). If
  /// only the name that lies there has none, its row needs a wall where its door may be.
  double absentSideLoss(const MatchProblem::DescribedSide& side, const VertexSet& from,
                        const VertexSet& to) const;
  /// Loss of a side that cannot be compared.
  double missingSideLoss(const MatchProblem::DescribedSide& side) const {
    return sideWeight(side) + (side.before + side.after > 0 ? rankWeight(side) : 0.0);
  }
  /// All passages from one set into the other: visit(passage).
  template <typename Visit>
  void forEachPassage(const PlaceSet& from, const PlaceSet& to, Visit&& visit) const {
    from.forEach([&](std::size_t v) {
      for (const MatchProblem::Passage& p : problem.passages[v])
        if (to.contains(p.to)) visit(p);
    });
  }
  /// Share of a side's value that is lost if a direction is off by so much [rad]. People tell sides
  /// roughly: a door is on the left if it lies more to the left than ahead.
  double lostShare(double off) const {
    if (!by_doors) return off / kPi;
    return std::min(1.0, std::max(0.0, (off - kRightWithin) / (kWrongFrom - kRightWithin)));
  }
  /// Of the sides' loss through a door, or through a wall that may hide one.
  double throughDoor(const MatchProblem::DescribedSide& side, double off) const {
    return sideWeight(side) * lostShare(off);
  }
  double throughWall(const MatchProblem::DescribedSide& side, double off) const {
    return sideWeight(side) * (1.0 - closed_door_credit * (1.0 - lostShare(off)));
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
    const VertexSet &a = of(clause.a), &b = of(clause.b);
    const VertexSet* c = clause.c >= 0 ? &of(clause.c) : nullptr;
    if (clause.what == Clause::What::kNumber && a.empty() && !b.empty())
      return clauseWeight(clause) * std::max(absent_share, 1.0 - unseenNumberValue(clause, b));
    if (a.empty() || b.empty() || (c != nullptr && c->empty()))
      return absent_share * clauseWeight(clause);
    const double value = clauseValue(clause, a, b, c);
    return clauseWeight(clause) * (clause.denied ? value : 1.0 - value);
  }

  /// Directions that are off by up to this are on the described side, from that on another [rad].
  static constexpr double kRightWithin = kPi / 6.0;
  static constexpr double kWrongFrom = kPi / 2.5;

 private:
  static Term termOf(Clause::What what) {
    return what == Clause::What::kRelation ? Term::kRelation
           : what == Clause::What::kOrder  ? Term::kOrder
                                           : Term::kNumber;
  }
  /// Something the description may have: how often, and the weight of one or of all of them.
  struct Statements {
    Term term;
    double weight;
    std::size_t count;
  };
  void listClauses(const FitnessParams& params);
  std::vector<Statements> countStatements(const FitnessParams& params) const;
  void shareWeights(const FitnessParams& params);
  /// 0 .. 1, of names that all have vertices.
  double clauseValue(const Clause& clause, const VertexSet& a, const VertexSet& b,
                     const VertexSet* c) const;
  double sizeWordValue(SizeWord word, const VertexSet& v) const;
  int doorCount(const VertexSet& v) const;
  /// How many doors are missing before and behind this one in a described row.
  int missingInRow(const MatchProblem::DescribedSide& side, const MatchProblem::Passage& own,
                   const PlaceSet& from) const;
  double rankShare(const MatchProblem::DescribedSide& side, int missing) const;
  /// Walls of `from` where a door may be that the robot has not seen, on the side with this angle
  /// if the heading is known, else on any: visit(passage).
  template <typename Visit>
  void forEachHiddenDoor(const PlaceSet& from, double side_angle, Visit&& visit) const {
    const auto consider = [&](const MatchProblem::Passage& p) {
      const bool there =
          !heading_is_exact_ ||
          std::abs(wrapAngleOnce(wrapAngleOnce(p.bearing - side_angle) - *problem.heading)) <
              kWrongFrom;
      if (there && !from.contains(p.to)) visit(p);
    };
    from.forEach([&](std::size_t v) {
      if (!problem.gaps.empty())
        for (const MatchProblem::Passage& gap : problem.gaps[v]) consider(gap);
      if (closed_door_credit > 0.0)
        for (const MatchProblem::Passage& wall : problem.walls[v]) consider(wall);
    });
  }
  // clause_values.cpp
  double orderValue(const Clause& clause, const VertexSet& first, const VertexSet& then,
                    const VertexSet& from) const;
  double numberValue(const Clause& clause, const VertexSet& to, const VertexSet& from) const;
  /// The same of a name without vertices, behind any wall of `from` where its door may be.
  double unseenNumberValue(const Clause& clause, const VertexSet& from) const;
  double numberAt(const Clause& clause, const MatchProblem::Passage& own, const VertexSet& from,
                  const PlaceSet& to) const;
  double distanceValue(const Clause& clause, const VertexSet& to, const VertexSet& from) const;
  /// Of "here on the left": no door of that side is nearer to where the robot stood.
  double nearestValue(const Clause& clause, const VertexSet& to, const VertexSet& from) const;
  double relationValue(const Clause& clause, const VertexSet& a, const VertexSet& b,
                       const VertexSet* c) const;
  double nearValue(const VertexSet& a, const VertexSet& b) const;
  double oppositeValue(const VertexSet& a, const VertexSet& b) const;
  double betweenValue(const VertexSet& a, const VertexSet& b, const VertexSet& c) const;
  double endValue(const VertexSet& a, const VertexSet& b) const;
  double afterValue(const Clause& clause, const VertexSet& a, const VertexSet& b,
                    const VertexSet* c) const;
  double behindValue(const Clause& clause, const VertexSet& a, const VertexSet& b) const;
  double atSideValue(double side_angle, const VertexSet& a, const VertexSet& b) const;

  std::array<double, static_cast<std::size_t>(Term::kCount)> weights_{};
  double scale_ = 0.0;
  bool heading_is_exact_ = false;  ///< known, and not only up to a sector of the circle
};

/// The vertices of each name.
std::vector<VertexSet> verticesOf(const MatchProblem& problem, const Assignment& assignment);

/// Fitness of a whole assignment and the heading that it holds for.
double evaluate(const FitnessTerms& terms, const std::vector<VertexSet>& names, double* heading);

/// Whether the places of a name are connected as SolverParams::connected asks.
bool isConnected(const MatchProblem& problem, const PlaceSet& members);

}  // namespace hyselam_topo::merging
