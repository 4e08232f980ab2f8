#include "fitness_terms.hpp"

#include <algorithm>

namespace hyselam_topo::merging {
namespace {

/// Rooms count as fully next to each other up to so many times the distance of the centers of two
/// rooms of their sizes that touch, and as fully opposite up to so many: a corridor lies between.
constexpr double kNextToReach = 1.25;
constexpr double kOppositeReach = 2.0;
/// What "opposite" is worth without a common neighbor, as a share of its value.
constexpr double kNotAcross = 0.5;
/// Doors whose directions add up to less than this (of 2) are not on the same side.
constexpr double kSameSide = 1.6;
/// Of the vectors through doors on the same side, their product is more than this.
constexpr double kParallel = 0.8;
/// More than any deviation.
constexpr double kNoDoor = 4.0;
/// Doors that are less apart are counted as neither before nor behind each other [m].
constexpr double kBeside = 0.3;
/// A door that lies as far behind another is certainly behind it [m].
constexpr double kClearlyAhead = 0.5;

double distance(const VertexSet& a, const VertexSet& b) {
  return std::hypot(a.x() - b.x(), a.y() - b.y());
}

/// About how far the middles of two rooms of these sizes are apart if they touch.
double reach(const VertexSet& a, const VertexSet& b) {
  return 0.5 * (std::sqrt(a.area) + std::sqrt(b.area));
}

double atMostOne(double value) {
  return std::min(1.0, value);
}

double angleBetween(double ax, double ay, double bx, double by) {
  return std::abs(std::atan2(ax * by - ay * bx, ax * bx + ay * by));
}

}  // namespace

void VertexSet::add(const MatchProblem& problem, std::size_t vertex) {
  members.insert(vertex);
  neighbors |= problem.neighbors[vertex];
  neighbors -= members;
  if (!problem.across_walls.empty()) {
    across_walls |= problem.across_walls[vertex];
    across_walls -= members;
  }
  area += problem.area[vertex];
  weight += problem.weight[vertex];
  sx += problem.weight[vertex] * problem.x[vertex];
  sy += problem.weight[vertex] * problem.y[vertex];
  ++count;
}

FitnessTerms::FitnessTerms(const MatchProblem& problem_in, const FitnessParams& params)
    : problem(problem_in),
      by_doors(params.sides == SideRule::kDoors && problem_in.has_doors),
      sides_of(problem_in.nameCount()),
      clauses_of(problem_in.nameCount()),
      has_evidence(problem_in.nameCount(), 0) {
  if (by_doors && !problem.across_walls.empty()) closed_door_credit = params.closed_door_credit;
  for (std::size_t s = 0; s < problem.sides.size(); ++s) {
    sides_of[static_cast<std::size_t>(problem.sides[s].from)].push_back(static_cast<int>(s));
    sides_of[static_cast<std::size_t>(problem.sides[s].to)].push_back(static_cast<int>(s));
  }
  const std::size_t m = problem.vertexCount();
  for (std::size_t i = 0; i < problem.nameCount() && !problem.evidence.empty(); ++i)
    for (std::size_t v = 0; v < m; ++v)
      if (problem.evidence[i * m + v] > 0.0) has_evidence[i] = 1;
  listClauses(params);
  shareWeights(params);
}

void FitnessTerms::listClauses(const FitnessParams& params) {
  for (const MatchProblem::Relation& r : problem.relations)
    clauses.push_back({r.kind, r.a, r.b, r.c, false, 0.0});
  if (by_doors && params.orders > 0.0)
    for (const MatchProblem::DescribedOrder& o : problem.orders)
      clauses.push_back({RelationKind::kNextTo, o.first, o.then, o.from, true, o.turn});
  for (std::size_t k = 0; k < clauses.size(); ++k)
    for (const int i : {clauses[k].a, clauses[k].b, clauses[k].c})
      if (i >= 0) clauses_of[static_cast<std::size_t>(i)].push_back(static_cast<int>(k));
}

void FitnessTerms::shareWeights(const FitnessParams& params) {
  const std::size_t n = problem.nameCount();
  std::size_t areas = 0, parts = 0, kinds = 0, ranks = 0;
  for (const MatchProblem::NameAttributes& described : problem.attributes) {
    areas += described.area > 0.0;
    parts += described.parts > 0;
    kinds += described.kind.has_value();
  }
  const bool ordered = by_doors && params.orders > 0.0;
  for (const MatchProblem::DescribedSide& s : problem.sides)
    ranks += ordered && s.before + s.after > 0;
  const std::size_t pairs = n * (n - (n > 0 ? 1 : 0)) / 2;  // N_e
  const auto evidence =
      static_cast<std::size_t>(std::count(has_evidence.begin(), has_evidence.end(), 1));
  struct Kind {
    Term term;
    double weight;
    std::size_t count;  ///< of what the description has
  };
  // The weight of orders is for pairs and for ranks, half of it each.
  const Kind all[] = {{Term::kVertex, params.vertices, n},
                      {Term::kArea, params.areas, areas},
                      {Term::kEdge, params.edges, pairs},
                      {Term::kSide, params.orientations, problem.sides.size()},
                      {Term::kRelation, params.relations, problem.relations.size()},
                      {Term::kParts, params.parts, parts},
                      {Term::kKind, params.kinds, kinds},
                      {Term::kEvidence, params.evidence, evidence},
                      {Term::kOrder, 0.5 * params.orders, ordered ? problem.orders.size() : 0},
                      {Term::kRank, 0.5 * params.orders, ranks}};
  double sum = 0.0;
  for (const Kind& kind : all)
    if (kind.count > 0) sum += kind.weight;
  for (const Kind& kind : all)
    weights_[static_cast<std::size_t>(kind.term)] =
        kind.count == 0 || sum <= 0.0 ? 0.0 : kind.weight / sum / static_cast<double>(kind.count);
  undescribed_edge = weight(Term::kEdge) * (1.0 - params.undescribed_edge_credit);
}

double FitnessTerms::unaryLoss(int name, const VertexSet& v) const {
  const auto i = static_cast<std::size_t>(name);
  const MatchProblem::NameAttributes& described = problem.attributes[i];
  double loss = v.empty() ? weight(Term::kVertex) : 0.0;
  if (described.area > 0.0)
    loss +=
        weight(Term::kArea) * std::abs(described.area - v.area) / std::max(described.area, v.area);
  if (described.parts > 0 && weight(Term::kParts) > 0.0)
    loss += weight(Term::kParts) * std::abs(described.parts - v.count) /
            static_cast<double>(std::max(described.parts, v.count));
  if (described.kind && weight(Term::kKind) > 0.0) {
    double right = 0.0, all = 0.0;
    v.members.forEach([&](std::size_t m) {
      all += problem.area[m];
      if (problem.kind[m] == *described.kind) right += problem.area[m];
    });
    loss += weight(Term::kKind) * (all > 0.0 ? 1.0 - right / all : 1.0);
  }
  if (has_evidence[i]) {
    double best = 0.0;
    v.members.forEach([&](std::size_t m) {
      best = std::max(best, problem.evidence[i * problem.vertexCount() + m]);
    });
    loss += weight(Term::kEvidence) * (1.0 - best);
  }
  return loss;
}

double FitnessTerms::relationValue(RelationKind what, const VertexSet& a, const VertexSet& b,
                                   const VertexSet* c) const {
  if (!a.hasCenter() || !b.hasCenter() || (c != nullptr && !c->hasCenter())) return 0.0;
  switch (what) {
    case RelationKind::kNextTo:
      return a.touches(b) ? 1.0
                          : atMostOne(kNextToReach * reach(a, b) / std::max(1e-9, distance(a, b)));
    case RelationKind::kOpposite: {
      const double near = atMostOne(kOppositeReach * reach(a, b) / std::max(1e-9, distance(a, b)));
      const bool across = !a.touches(b) && a.neighbors.intersects(b.neighbors);
      return across ? near : kNotAcross * near;
    }
    case RelationKind::kBetween:
      if (c == nullptr) return 0.0;
      return angleBetween(b.x() - a.x(), b.y() - a.y(), c->x() - a.x(), c->y() - a.y()) / kPi;
    case RelationKind::kAtEndOf: {
      if (!a.touches(b)) return 0.0;
      double farthest = distance(a, b);
      b.neighbors.forEach([&](std::size_t v) {
        if (problem.weight[v] > 0.0)
          farthest = std::max(farthest, std::hypot(problem.x[v] - b.x(), problem.y[v] - b.y()));
      });
      return farthest > 0.0 ? distance(a, b) / farthest : 1.0;
    }
    case RelationKind::kInside:
      return a.touches(b) ? static_cast<double>((a.neighbors & b.members).size()) /
                                static_cast<double>(a.neighbors.size())
                          : 0.0;
    default:
      break;
  }
  return 0.0;
}

double FitnessTerms::doorLoss(const MatchProblem::DescribedSide& side, const PlaceSet& from,
                              const PlaceSet& to, Heading heading) const {
  double least = kNoDoor;
  // Seen from the smaller set: it has fewer passages.
  const bool turned = from.size() > to.size();
  const PlaceSet &here = turned ? to : from, &there = turned ? from : to;
  const auto consider = [&](const MatchProblem::Passage& p) {
    const double bearing = turned ? wrapAngleOnce(p.bearing + kPi) : p.bearing;
    least = std::min(least, deviation(side, bearing, heading));
  };
  forEachPassage(here, there, consider);
  if (least < kNoDoor) return throughDoor(least);
  forEachWall(here, there, consider);
  return least < kNoDoor ? throughWall(least) : weight(Term::kSide);
}

double FitnessTerms::minDoorLoss(const MatchProblem::DescribedSide& side, const PlaceSet& from,
                                 const PlaceSet& to, Heading heading) const {
  const double doors = doorLoss(side, from, to, heading);
  if (!(closed_door_credit > 0.0)) return doors;
  double least = kNoDoor;
  forEachWall(from, to, [&](const MatchProblem::Passage& p) {
    least = std::min(least, deviation(side, p.bearing, heading));
  });
  return least < kNoDoor ? std::min(doors, throughWall(least)) : doors;
}

double FitnessTerms::rankLoss(const MatchProblem::DescribedSide& side, const PlaceSet& from,
                              const PlaceSet& to) const {
  if (side.before + side.after == 0 || weight(Term::kRank) <= 0.0) return 0.0;
  const double c = std::cos(side.turn), s = std::sin(side.turn);
  int least = side.before + side.after;
  forEachDoor(from, to, [&](const MatchProblem::Passage& own) {
    const double ax = c * own.dx - s * own.dy, ay = s * own.dx + c * own.dy;
    int before = 0, after = 0;
    from.forEach([&](std::size_t v) {
      for (const MatchProblem::Passage& other : problem.passages[v]) {
        if (from.contains(other.to) || other.dx * own.dx + other.dy * own.dy < kParallel) continue;
        const double ahead = ax * (other.x - own.x) + ay * (other.y - own.y);
        before += ahead < -kBeside;
        after += ahead > kBeside;
      }
    });
    least = std::min(least, std::max(0, side.before - before) + std::max(0, side.after - after));
  });
  return weight(Term::kRank) * least / (side.before + side.after);
}

double FitnessTerms::orderValue(const Clause& clause, const VertexSet& first, const VertexSet& then,
                                const VertexSet& from) const {
  struct Doors {
    double x = 0.0, y = 0.0, dx = 0.0, dy = 0.0;
    int count = 0;
  };
  const auto doorsInto = [&](const VertexSet& to) {
    Doors d;
    forEachDoor(from.members, to.members, [&d](const MatchProblem::Passage& p) {
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
  const double c = std::cos(clause.turn) / length, s = std::sin(clause.turn) / length;
  const double on = (c * dx - s * dy) * (b.x / b.count - a.x / a.count) +
                    (s * dx + c * dy) * (b.y / b.count - a.y / a.count);
  return std::clamp(0.5 + 0.5 * on / kClearlyAhead, 0.0, 1.0);
}

std::vector<VertexSet> verticesOf(const MatchProblem& problem, const Assignment& assignment) {
  std::vector<VertexSet> names(problem.nameCount());
  for (std::size_t v = 0; v < assignment.size(); ++v)
    if (assignment[v] >= 0) names[static_cast<std::size_t>(assignment[v])].add(problem, v);
  return names;
}

bool isConnected(const MatchProblem& problem, const PlaceSet& members) {
  if (members.empty()) return true;
  // From a confirmed vertex each, else from any one.
  PlaceSet front, reached;
  members.forEach([&](std::size_t v) {
    if (problem.confirmed_name[v] >= 0) front.insert(v);
  });
  if (front.empty()) front.insert(members.first());
  while (!front.empty()) {
    reached |= front;
    PlaceSet next;
    front.forEach([&](std::size_t v) { next |= problem.neighbors[v]; });
    front = (next & members) - reached;
  }
  return reached == members;
}

}  // namespace hyselam_topo::merging
