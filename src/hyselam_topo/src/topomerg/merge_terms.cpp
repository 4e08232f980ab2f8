#include "merge_terms.hpp"

#include <algorithm>

namespace hyselam_topo::merging {
namespace {

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

double distance(const Vertices& a, const Vertices& b) {
  return std::hypot(a.x() - b.x(), a.y() - b.y());
}

/// About how far the middles of two rooms of these sizes are apart if they touch.
double reach(const Vertices& a, const Vertices& b) {
  return 0.5 * (std::sqrt(a.area) + std::sqrt(b.area));
}

double atMostOne(double value) {
  return std::min(1.0, value);
}

double angleBetween(double ax, double ay, double bx, double by) {
  return std::abs(std::atan2(ax * by - ay * bx, ax * bx + ay * by));
}

}  // namespace

void Vertices::add(const MatchProblem& problem, std::size_t vertex) {
  members.insert(vertex);
  around |= problem.neighbours[vertex];
  around -= members;
  if (!problem.behind.empty()) {
    behind |= problem.behind[vertex];
    behind -= members;
  }
  area += problem.area[vertex];
  weight += problem.weight[vertex];
  sx += problem.weight[vertex] * problem.x[vertex];
  sy += problem.weight[vertex] * problem.y[vertex];
  ++count;
}

Terms::Terms(const MatchProblem& problem_in, const FitnessParams& params)
    : problem(problem_in),
      sides_of(problem_in.nameCount()),
      clauses_of(problem_in.nameCount()),
      has_evidence(problem_in.nameCount(), 0) {
  const std::size_t n = problem.nameCount();
  const std::size_t m = problem.vertexCount();
  std::size_t areas = 0, told_parts = 0, kinds = 0, with_evidence = 0;
  for (std::size_t i = 0; i < n; ++i) {
    areas += problem.told[i].area > 0.0;
    told_parts += problem.told[i].parts > 0;
    kinds += problem.told[i].kind.has_value();
    if (problem.evidence.empty()) continue;
    for (std::size_t v = 0; v < m; ++v)
      if (problem.evidence[i * m + v] > 0.0) has_evidence[i] = 1;
    with_evidence += has_evidence[i] != 0;
  }
  for (std::size_t s = 0; s < problem.sides.size(); ++s) {
    sides_of[static_cast<std::size_t>(problem.sides[s].from)].push_back(static_cast<int>(s));
    sides_of[static_cast<std::size_t>(problem.sides[s].to)].push_back(static_cast<int>(s));
  }
  by_doors = params.sides == SideRule::kDoors && problem.has_doors;
  if (by_doors && !problem.behind.empty()) shut_door = params.shut_door;
  for (const MatchProblem::Relation& r : problem.relations)
    clauses.push_back({r.kind, r.a, r.b, r.c, false, 0.0});
  std::size_t orders = 0, ranks = 0;
  if (by_doors && params.orders > 0.0) {
    orders = problem.orders.size();
    for (const MatchProblem::ToldSide& s : problem.sides) ranks += s.before + s.after > 0;
  }
  for (std::size_t k = 0; k < orders; ++k) {
    const MatchProblem::ToldOrder& o = problem.orders[k];
    clauses.push_back({RelationKind::kNextTo, o.first, o.then, o.from, true, o.turn});
  }
  for (std::size_t k = 0; k < clauses.size(); ++k)
    for (const int i : {clauses[k].a, clauses[k].b, clauses[k].c})
      if (i >= 0) clauses_of[static_cast<std::size_t>(i)].push_back(static_cast<int>(k));

  const std::size_t pairs = n * (n - (n > 0 ? 1 : 0)) / 2;  // N_e
  const std::pair<double, std::size_t> kinds_of_terms[] = {
      {params.vertices, n},
      {params.areas, areas},
      {params.edges, pairs},
      {params.orientations, problem.sides.size()},
      {params.relations, problem.relations.size()},
      {params.parts, told_parts},
      {params.kinds, kinds},
      {params.evidence, with_evidence},
      {0.5 * params.orders, orders},
      {0.5 * params.orders, ranks}};
  double sum = 0.0;
  for (const auto& [weight, count] : kinds_of_terms)
    if (count > 0) sum += weight;
  const auto share = [&](std::size_t term) {
    const auto& [weight, count] = kinds_of_terms[term];
    return count == 0 || sum <= 0.0 ? 0.0 : weight / sum / static_cast<double>(count);
  };
  empty_name = share(0);
  area = share(1);
  missing_edge = share(2);
  forgotten_edge = missing_edge * (1.0 - params.forgotten_edge);
  side = share(3);
  relation = share(4);
  parts = share(5);
  kind = share(6);
  evidence = share(7);
  order = share(8);
  rank = share(9);
}

void Terms::weighAs(const Terms& whole) {
  empty_name = whole.empty_name;
  area = whole.area;
  missing_edge = whole.missing_edge;
  forgotten_edge = whole.forgotten_edge;
  side = whole.side;
  relation = whole.relation;
  parts = whole.parts;
  kind = whole.kind;
  evidence = whole.evidence;
  order = whole.order;
  rank = whole.rank;
}

double Terms::alone(int name, const Vertices& v) const {
  const auto i = static_cast<std::size_t>(name);
  const MatchProblem::Told& told = problem.told[i];
  double loss = v.empty() ? empty_name : 0.0;
  if (told.area > 0.0) loss += area * std::abs(told.area - v.area) / std::max(told.area, v.area);
  if (told.parts > 0 && parts > 0.0)
    loss +=
        parts * std::abs(told.parts - v.count) / static_cast<double>(std::max(told.parts, v.count));
  if (told.kind && kind > 0.0) {
    double right = 0.0, all = 0.0;
    v.members.forEach([&](std::size_t m) {
      all += problem.area[m];
      if (problem.kind[m] == *told.kind) right += problem.area[m];
    });
    loss += kind * (all > 0.0 ? 1.0 - right / all : 1.0);
  }
  if (has_evidence[i]) {
    double best = 0.0;
    v.members.forEach([&](std::size_t m) {
      best = std::max(best, problem.evidence[i * problem.vertexCount() + m]);
    });
    loss += evidence * (1.0 - best);
  }
  return loss;
}

double Terms::relationValue(RelationKind what, const Vertices& a, const Vertices& b,
                            const Vertices* c) const {
  if (!a.hasCentre() || !b.hasCentre() || (c != nullptr && !c->hasCentre())) return 0.0;
  switch (what) {
    case RelationKind::kNextTo:
      return a.touches(b) ? 1.0 : atMostOne(1.25 * reach(a, b) / std::max(1e-9, distance(a, b)));
    case RelationKind::kOpposite: {
      const double near = atMostOne(2.0 * reach(a, b) / std::max(1e-9, distance(a, b)));
      const bool across = !a.touches(b) && a.around.intersects(b.around);
      return across ? near : 0.5 * near;
    }
    case RelationKind::kBetween:
      if (c == nullptr) return 0.0;
      return angleBetween(b.x() - a.x(), b.y() - a.y(), c->x() - a.x(), c->y() - a.y()) / kPi;
    case RelationKind::kAtEndOf: {
      if (!a.touches(b)) return 0.0;
      double farthest = distance(a, b);
      b.around.forEach([&](std::size_t v) {
        if (problem.weight[v] > 0.0)
          farthest = std::max(farthest, std::hypot(problem.x[v] - b.x(), problem.y[v] - b.y()));
      });
      return farthest > 0.0 ? distance(a, b) / farthest : 1.0;
    }
    case RelationKind::kInside:
      return a.touches(b) ? static_cast<double>((a.around & b.members).size()) /
                                static_cast<double>(a.around.size())
                          : 0.0;
  }
  return 0.0;
}

double Terms::doorLoss(const MatchProblem::ToldSide& told, const PlaceSet& from, const PlaceSet& to,
                       Heading heading) const {
  double least = kNoDoor;
  // Seen from the smaller set: it has fewer passages.
  const bool turned = from.size() > to.size();
  const PlaceSet &here = turned ? to : from, &there = turned ? from : to;
  const auto look = [&](const MatchProblem::Passage& p) {
    const double bearing = turned ? wrapped(p.bearing + kPi) : p.bearing;
    least = std::min(least, deviation(told, bearing, heading));
  };
  forEachPassage(here, there, look);
  if (least < kNoDoor) return throughDoor(least);
  forEachWall(here, there, look);
  return least < kNoDoor ? throughWall(least) : side;
}

double Terms::leastDoorLoss(const MatchProblem::ToldSide& told, const PlaceSet& from,
                            const PlaceSet& to, Heading heading) const {
  const double doors = doorLoss(told, from, to, heading);
  if (!(shut_door > 0.0)) return doors;
  double least = kNoDoor;
  forEachWall(from, to, [&](const MatchProblem::Passage& p) {
    least = std::min(least, deviation(told, p.bearing, heading));
  });
  return least < kNoDoor ? std::min(doors, throughWall(least)) : doors;
}

double Terms::rankLoss(const MatchProblem::ToldSide& told, const PlaceSet& from,
                       const PlaceSet& to) const {
  if (told.before + told.after == 0 || rank <= 0.0) return 0.0;
  const double c = std::cos(told.turn), s = std::sin(told.turn);
  int least = told.before + told.after;
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
    least = std::min(least, std::max(0, told.before - before) + std::max(0, told.after - after));
  });
  return rank * least / (told.before + told.after);
}

double Terms::orderValue(const Clause& clause, const Vertices& first, const Vertices& then,
                         const Vertices& from) const {
  struct Doors {
    double x = 0.0, y = 0.0, dx = 0.0, dy = 0.0;
    int count = 0;
  };
  const auto doorsInto = [&](const Vertices& to) {
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

std::vector<Vertices> verticesOf(const MatchProblem& problem, const Assignment& assignment) {
  std::vector<Vertices> names(problem.nameCount());
  for (std::size_t v = 0; v < assignment.size(); ++v)
    if (assignment[v] >= 0) names[static_cast<std::size_t>(assignment[v])].add(problem, v);
  return names;
}

double evaluate(const Terms& terms, const std::vector<Vertices>& names, double* heading) {
  const MatchProblem& problem = terms.problem;
  const auto of = [&names](int i) -> const Vertices& { return names[static_cast<std::size_t>(i)]; };
  const int n = static_cast<int>(names.size());
  double loss = 0.0;
  for (int i = 0; i < n; ++i) loss += terms.alone(i, of(i));
  for (int i = 0; i < n; ++i)
    for (int j = i + 1; j < n; ++j) loss += terms.edge(i, j, terms.contact(of(i), of(j)));
  for (const Terms::Clause& clause : terms.clauses) loss += terms.clauseLoss(clause, of);

  if (problem.heading) {
    for (const MatchProblem::ToldSide& s : problem.sides)
      loss += terms.sideLoss(s, of(s.from), of(s.to), {*problem.heading, 0.0});
    if (heading != nullptr) *heading = *problem.heading;
  } else {
    // The sum of deviations is piecewise linear in the heading and bends upwards only where one of
    // them is 0: the best heading is there.
    struct Right {
      std::vector<double> headings;  ///< where the side is right
      double share = 1.0;            ///< of its value, that it has there
    };
    std::vector<Right> exact;  // of each side
    for (const MatchProblem::ToldSide& s : problem.sides) {
      Right right;
      if (terms.by_doors)
        right.share = terms.forEachDoor(of(s.from).members, of(s.to).members,
                                        [&](const MatchProblem::Passage& p) {
                                          right.headings.push_back(wrapped(p.bearing - s.middle));
                                        });
      else if (Terms::comparable(of(s.from), of(s.to)))
        right.headings.push_back(wrapped(Terms::bearing(of(s.from), of(s.to)) - s.angle));
      if (right.headings.empty()) {
        loss += terms.lostSide(s);
        continue;
      }
      if (terms.by_doors) loss += terms.rankLoss(s, of(s.from).members, of(s.to).members);
      loss += terms.side * (1.0 - right.share);
      exact.push_back(std::move(right));
    }
    double least = 0.0, at = 0.0;
    bool first = true;
    for (const Right& tried : exact) {
      for (const double value : tried.headings) {
        double sum = 0.0;
        for (const Right& others : exact) {
          double off = kPi;
          for (const double other : others.headings)
            off = std::min(off, std::abs(wrapped(other - value)));
          sum += others.share * off;
        }
        if (!first && !(sum < least - 1e-12)) continue;
        first = false;
        least = sum;
        at = value;
      }
    }
    loss += terms.side * least / kPi;
    if (heading != nullptr) *heading = at;
  }
  return 1.0 - loss;
}

bool hangTogether(const MatchProblem& problem, const PlaceSet& members) {
  if (members.empty()) return true;
  // From a confirmed vertex each, else from any one.
  PlaceSet front, reached;
  members.forEach([&](std::size_t v) {
    if (problem.fixed[v] >= 0) front.insert(v);
  });
  if (front.empty()) front.insert(members.first());
  while (!front.empty()) {
    reached |= front;
    PlaceSet next;
    front.forEach([&](std::size_t v) { next |= problem.neighbours[v]; });
    front = (next & members) - reached;
  }
  return reached == members;
}

}  // namespace hyselam_topo::merging

namespace hyselam_topo {

double fitness(const MatchProblem& problem, const FitnessParams& params,
               const Assignment& assignment, double* heading) {
  const merging::Terms terms(problem, params);
  return merging::evaluate(terms, merging::verticesOf(problem, assignment), heading);
}

}  // namespace hyselam_topo
