// Names that belong together, each group a problem of its own: what it loses at least.
#include <algorithm>

#include "exact_search.hpp"

namespace hyselam_topo::merging {
namespace {

/// A name with so many joined to it is worth a look at how well it fits with them.
constexpr int kHubEdges = 3;
/// Nodes of such a look.
constexpr std::uint64_t kGroupNodes = 1000;
/// Such a look is for what loses less than this, then than more by a factor.
constexpr double kFirstLoss = 0.02;
constexpr double kDeeper = 1.25;

/// The problem with these names only, without relations.
MatchProblem restricted(const MatchProblem& problem, const std::vector<int>& names) {
  const std::size_t n = problem.nameCount(), m = problem.vertexCount(), k = names.size();
  MatchProblem part = problem;
  part.names.clear();
  part.told.clear();
  part.allowed.clear();
  part.relations.clear();
  part.sides.clear();
  part.orders.clear();
  part.evidence.clear();
  part.joined.assign(k * k, 0);
  std::vector<int> number(n, -1);
  for (std::size_t i = 0; i < k; ++i) {
    const std::size_t name = at(names[i]);
    number[name] = static_cast<int>(i);
    part.names.push_back(problem.names[name]);
    part.told.push_back(problem.told[name]);
    part.allowed.push_back(problem.allowed[name]);
    for (std::size_t j = 0; j < k; ++j)
      part.joined[i * k + j] = problem.joined[name * n + at(names[j])];
    if (!problem.evidence.empty())
      part.evidence.insert(part.evidence.end(),
                           problem.evidence.begin() + static_cast<std::ptrdiff_t>(name * m),
                           problem.evidence.begin() + static_cast<std::ptrdiff_t>((name + 1) * m));
  }
  for (const MatchProblem::ToldSide& s : problem.sides)
    if (number[at(s.from)] >= 0 && number[at(s.to)] >= 0)
      part.sides.push_back(
          {number[at(s.from)], number[at(s.to)], s.angle, s.middle, s.turn, s.before, s.after});
  for (int& fixed : part.fixed) fixed = fixed >= 0 ? number[at(fixed)] : -1;
  return part;
}

}  // namespace

bool ExactSearch::untouched(const Group& group, const Growth* growth) const {
  return std::none_of(group.names.begin(), group.names.end(), [&](int i) {
    return is_closed_[at(i)] || (growth != nullptr && growth->name == i);
  });
}

std::vector<Group> ExactSearch::findGroups() const {
  std::vector<Group> groups;
  std::vector<int> group_of(at(n_), -1);
  for (int i = 0; i < n_; ++i) {
    if (told_edges_[at(i)] < kHubEdges || has_fixed_[at(i)]) continue;
    group_of[at(i)] = static_cast<int>(groups.size());
    groups.push_back({i, {i}, {}});
  }
  for (int i = 0; i < n_; ++i) {
    if (told_edges_[at(i)] >= kHubEdges || has_fixed_[at(i)]) continue;
    int best = -1;
    for (int j = 0; j < n_; ++j)
      if (problem_.areJoined(at(i), at(j)) && group_of[at(j)] >= 0 &&
          told_edges_[at(j)] >= kHubEdges &&
          (best < 0 || told_edges_[at(j)] > told_edges_[at(best)]))
        best = j;
    if (best >= 0) groups[at(group_of[at(best)])].names.push_back(i);
  }
  // A group that is all there is would be the problem itself.
  if (groups.size() == 1 && groups[0].names.size() == at(n_)) groups.clear();
  return groups;
}

double ExactSearch::leastOf(Group* group, const PlaceSet& taken) const {
  double known = 0.0;
  for (const Group::Least& least : group->least) {
    if (least.taken == taken) return least.loss;
    if (!taken.containsAll(least.taken)) continue;
    // What is possible with fewer vertices is possible with more.
    known = std::max(known, least.loss);
    if (!least.exact || least.used.intersects(taken)) continue;
    Group::Least same = least;
    same.taken = taken;
    group->least.push_back(same);
    return same.loss;
  }
  MatchParams params = params_;
  params.dummy = true;
  params.max_solutions = 1;
  params.keep_within = 0.0;
  params.time_limit = std::max(0.0, params_.time_limit - watch_.seconds());
  MatchProblem part = restricted(problem_, group->names);
  part.heading = heading_.value;
  for (PlaceSet& allowed : part.allowed) allowed -= taken;
  Terms terms(part, params.fitness);
  terms.weighAs(terms_);
  ExactSearch search(part, params, terms);
  search.slack_ = heading_.slack;
  group->least.push_back(search.leastLoss(kGroupNodes, known));
  group->least.back().taken = taken;
  return group->least.back().loss;
}

Group::Least ExactSearch::leastLoss(std::uint64_t max_nodes, double known) {
  listSectors(0.0);
  Group::Least least;
  least.loss = known;
  max_nodes_ = max_nodes;
  double loss = std::max(kFirstLoss, kDeeper * known);
  while (loss < 1.0) {
    solutions_.restart(1.0 - loss);
    if (!searchAll()) break;
    least.loss = loss;
    loss *= kDeeper;
    if (!solutions_.any()) continue;
    least.loss = std::max(0.0, 1.0 - solutions_.best() - kEqualFitness);
    least.exact = true;
    const Assignment& best = solutions_.kept().front().assignment;
    for (int v = 0; v < m_; ++v)
      if (best[at(v)] >= 0) least.used.insert(at(v));
    break;
  }
  return least;
}

}  // namespace hyselam_topo::merging
