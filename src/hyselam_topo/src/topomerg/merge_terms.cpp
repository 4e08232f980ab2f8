#include "merge_terms.hpp"

#include <algorithm>

namespace hyselam_topo::merging {
namespace {

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
  area += problem.area[vertex];
  weight += problem.weight[vertex];
  sx += problem.weight[vertex] * problem.x[vertex];
  sy += problem.weight[vertex] * problem.y[vertex];
  ++count;
}

Terms::Terms(const MatchProblem& problem_in, const FitnessParams& params)
    : problem(problem_in),
      sides_of(problem_in.nameCount()),
      relations_of(problem_in.nameCount()),
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
  for (std::size_t r = 0; r < problem.relations.size(); ++r)
    for (const int i : {problem.relations[r].a, problem.relations[r].b, problem.relations[r].c})
      if (i >= 0) relations_of[static_cast<std::size_t>(i)].push_back(static_cast<int>(r));

  const std::size_t pairs = n * (n - (n > 0 ? 1 : 0)) / 2;  // N_e
  const std::pair<double, std::size_t> kinds_of_terms[] = {
      {params.vertices, n},
      {params.areas, areas},
      {params.edges, pairs},
      {params.orientations, problem.sides.size()},
      {params.relations, problem.relations.size()},
      {params.parts, told_parts},
      {params.kinds, kinds},
      {params.evidence, with_evidence}};
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

double Terms::relationLoss(const MatchProblem::Relation& r, const Vertices& a, const Vertices& b,
                           const Vertices* c) const {
  return relation * (1.0 - relationValue(r.kind, a, b, c));
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
    for (int j = i + 1; j < n; ++j) loss += terms.edge(i, j, of(i).touches(of(j)));
  for (const MatchProblem::Relation& r : problem.relations)
    loss += terms.relationLoss(r, of(r.a), of(r.b), r.c >= 0 ? &of(r.c) : nullptr);

  if (problem.heading) {
    for (const MatchProblem::ToldSide& s : problem.sides)
      loss += terms.sideLoss(s, of(s.from), of(s.to), {*problem.heading, 0.0});
    if (heading != nullptr) *heading = *problem.heading;
  } else {
    // The sum of deviations is piecewise linear in the heading and bends upwards only where one of
    // them is 0: the best heading is there.
    std::vector<double> exact;
    for (const MatchProblem::ToldSide& s : problem.sides) {
      if (Terms::comparable(of(s.from), of(s.to)))
        exact.push_back(wrapped(Terms::bearing(of(s.from), of(s.to)) - s.angle));
      else
        loss += terms.side;
    }
    double least = 0.0, at = 0.0;
    for (std::size_t k = 0; k < exact.size(); ++k) {
      double sum = 0.0;
      for (const double other : exact) sum += std::abs(wrapped(other - exact[k]));
      if (k == 0 || sum < least - 1e-12) {
        least = sum;
        at = exact[k];
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
