#include "name_groups.hpp"

#include <algorithm>

#include "exact_search.hpp"

namespace hyselam_topo::merging {
namespace {

/// A name of this degree or more is the hub of a group.
constexpr int kHubDegree = 3;
/// Nodes of the search for what a group loses.
constexpr std::uint64_t kGroupNodes = 1000;

/// The problem with these names only, without relations.
MatchProblem restricted(const MatchProblem& problem, const std::vector<int>& names) {
  const std::size_t n = problem.nameCount(), m = problem.vertexCount(), k = names.size();
  MatchProblem part = problem;
  part.names.clear();
  part.attributes.clear();
  part.allowed.clear();
  part.relations.clear();
  part.sides.clear();
  part.orders.clear();
  part.numbers.clear();
  part.evidence.clear();
  part.described_edges.assign(k * k, 0);
  std::vector<int> number(n, -1);
  for (std::size_t i = 0; i < k; ++i) {
    const std::size_t name = at(names[i]);
    number[name] = static_cast<int>(i);
    part.names.push_back(problem.names[name]);
    part.attributes.push_back(problem.attributes[name]);
    part.allowed.push_back(problem.allowed[name]);
    for (std::size_t j = 0; j < k; ++j)
      part.described_edges[i * k + j] = problem.described_edges[name * n + at(names[j])];
    if (!problem.evidence.empty())
      part.evidence.insert(part.evidence.end(),
                           problem.evidence.begin() + static_cast<std::ptrdiff_t>(name * m),
                           problem.evidence.begin() + static_cast<std::ptrdiff_t>((name + 1) * m));
  }
  for (const MatchProblem::DescribedSide& s : problem.sides)
    if (number[at(s.from)] >= 0 && number[at(s.to)] >= 0)
      part.sides.push_back({number[at(s.from)], number[at(s.to)], s.angle, s.side_angle, s.turn,
                            s.before, s.after, s.strength});
  for (int& fixed : part.confirmed_name) fixed = fixed >= 0 ? number[at(fixed)] : -1;
  return part;
}

}  // namespace

std::vector<NameGroup> NameGroups::find() const {
  const int n = tables_.nameCount();
  std::vector<NameGroup> groups;
  std::vector<int> group_of(at(n), -1);
  for (int i = 0; i < n; ++i) {
    if (tables_.degree(i) < kHubDegree || tables_.isConfirmed(i)) continue;
    group_of[at(i)] = static_cast<int>(groups.size());
    groups.push_back({i, {i}, {}});
  }
  for (int i = 0; i < n; ++i) {
    if (tables_.degree(i) >= kHubDegree || tables_.isConfirmed(i)) continue;
    int best = -1;
    for (int j = 0; j < n; ++j)
      if (problem_.areConnected(at(i), at(j)) && group_of[at(j)] >= 0 &&
          tables_.degree(j) >= kHubDegree && (best < 0 || tables_.degree(j) > tables_.degree(best)))
        best = j;
    if (best >= 0) groups[at(group_of[at(best)])].names.push_back(i);
  }
  // A group of all names would be the problem itself.
  if (groups.size() == 1 && groups[0].names.size() == at(n)) groups.clear();
  return groups;
}

double NameGroups::minLoss(NameGroup& group, const PlaceSet& taken, Heading heading) const {
  double known = 0.0;
  for (const NameGroup::MinLoss& each : group.known) {
    if (each.taken == taken) return each.loss;
    if (!taken.containsAll(each.taken)) continue;
    // What is possible with fewer vertices is possible with more.
    known = std::max(known, each.loss);
    if (!each.exact || each.used.intersects(taken)) continue;
    NameGroup::MinLoss same = each;
    same.taken = taken;
    group.known.push_back(same);
    return same.loss;
  }
  SolverParams params = params_;
  params.dummy = true;
  params.max_solutions = 1;
  params.keep_within = 0.0;
  params.time_limit = std::max(0.0, params_.time_limit - watch_.seconds());
  MatchProblem part = restricted(problem_, group.names);
  part.heading = heading.value;
  for (PlaceSet& allowed : part.allowed) allowed -= taken;
  FitnessTerms terms(part, params.fitness);
  terms.copyWeights(terms_);
  ExactSearch search(part, params, terms);
  search.setHeadingSlack(heading.slack);
  group.known.push_back(search.minLoss(kGroupNodes, known));
  group.known.back().taken = taken;
  return group.known.back().loss;
}

}  // namespace hyselam_topo::merging
