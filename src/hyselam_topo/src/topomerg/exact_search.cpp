#include "exact_search.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "improve.hpp"

namespace hyselam_topo {
namespace merging {
namespace {

/// An unknown heading is searched in as many parts of the circle.
constexpr int kSectors = 16;
/// The clock is asked once in as many nodes.
constexpr std::uint64_t kClockEvery = 16;
/// Of the quick first answer where the heading is not known or time is short.
constexpr std::size_t kFirstRevisits = 20;

/// A name with so many joined to it is worth a look at how well it fits with them.
constexpr int kHubEdges = 3;
/// Whoever takes a vertex with as many neighbours is in the way of such names.
constexpr std::size_t kBusy = 3;
/// Nodes of such a look.
constexpr std::uint64_t kGroupNodes = 1000;
/// Nodes before the search goes about it step by step.
constexpr std::uint64_t kFirstNodes = 40;
/// The first step is to look for answers that lose less than this; each next one more by a factor.
constexpr double kFirstLoss = 0.02;
constexpr double kDeeper = 1.15;
/// Names times vertices from which a first answer is made better before.
constexpr int kLarge = 1000;
constexpr double kLongest = 4.0;  ///< [s]
constexpr double kAnyHeading = 10.0;

std::size_t at(int i) {
  return static_cast<std::size_t>(i);
}

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

ExactSearch::ExactSearch(const MatchProblem& problem, const MatchParams& params, const Terms& terms)
    : problem_(problem),
      params_(params),
      terms_(terms),
      n_(static_cast<int>(problem.nameCount())),
      m_(static_cast<int>(problem.vertexCount())),
      lower_(problem.vertexCount()),
      has_fixed_(problem.nameCount(), 0),
      closed_(problem.nameCount()),
      is_closed_(problem.nameCount(), 0),
      owner_(problem.vertexCount(), -1),
      told_edges_(problem.nameCount(), 0),
      side_between_(problem.nameCount() * problem.nameCount(), -1),
      told_closed_(problem.nameCount(), 0),
      solutions_(params) {
  for (int i = 0; i < n_; ++i)
    for (int j = 0; j < n_; ++j) told_edges_[at(i)] += problem.areJoined(at(i), at(j));
  std::vector<int> order(problem.vertexCount());
  std::iota(order.begin(), order.end(), 0);
  const auto degree = [&](int v) { return problem.neighbours[at(v)].size(); };
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return degree(a) != degree(b) ? degree(a) > degree(b)
                                  : problem.area[at(a)] > problem.area[at(b)];
  });
  PlaceSet below;
  for (auto v = order.rbegin(); v != order.rend(); ++v) {
    lower_[at(*v)] = below;
    below.insert(at(*v));
  }
  for (int v = 0; v < m_; ++v) {
    free_.insert(at(v));
    if (problem.neighbours[at(v)].size() >= kBusy) busy_.insert(at(v));
    if (problem.fixed[at(v)] < 0) continue;
    fixed_.insert(at(v));
    has_fixed_[at(problem.fixed[at(v)])] = 1;
  }
  listOnce();
}

Node& ExactSearch::node(std::size_t depth) {
  while (nodes_.size() <= depth) nodes_.emplace_back();
  return nodes_[depth];
}

bool ExactSearch::stopped() {
  if (visited_ > max_nodes_) stopped_ = true;
  if (!stopped_ && visited_ % kClockEvery == 0 && std::isfinite(params_.time_limit))
    stopped_ = watch_.seconds() > params_.time_limit;
  return stopped_;
}

bool ExactSearch::hopeless(double bound, std::size_t at_least) const {
  if (1.0 - bound < solutions_.needed()) return true;
  return solutions_.full() && at_least >= solutions_.fewest() &&
         1.0 - bound <= solutions_.best() + kEqualFitness;
}

std::size_t ExactSearch::taken(const Node& here) const {
  std::size_t more = 0;
  const double room = 1.0 - solutions_.needed() - here.table_bound;
  for (std::size_t r = 0; r < here.rows.size(); ++r)
    more += here.table.reducedWithout(static_cast<int>(r)) > room;
  return taken_ + more;
}

void ExactSearch::leaf() {
  if (!params_.dummy && !free_.empty()) return;
  MatchSolution s;
  s.assignment = owner_;
  // With a heading that is only known up to `slack_`, what counts is what no heading in it can
  // undercut.
  s.fitness =
      slack_ > 0.0 ? 1.0 - base_ : evaluate(terms_, verticesOf(problem_, owner_), &s.heading);
  s.vertices = taken_;
  if (!problem_.heading && !(s.heading >= sector_low_ && s.heading < sector_high_)) return;
  solutions_.offer(std::move(s));
}

void ExactSearch::close(int name, const Vertices& vertices, std::size_t depth, double known) {
  const double base = base_;
  base_ += exactLoss(name, vertices);
  closed_[at(name)] = vertices;
  is_closed_[at(name)] = 1;
  closed_list_.push_back(name);
  free_ -= vertices.members;
  taken_ += at(vertices.count);
  vertices.members.forEach([&](std::size_t v) { owner_[v] = name; });
  for (int i = 0; i < n_; ++i) told_closed_[at(i)] += problem_.areJoined(at(i), at(name));

  search(depth, known);

  for (int i = 0; i < n_; ++i) told_closed_[at(i)] -= problem_.areJoined(at(i), at(name));
  vertices.members.forEach([&](std::size_t v) { owner_[v] = -1; });
  taken_ -= at(vertices.count);
  free_ |= vertices.members;
  closed_list_.pop_back();
  is_closed_[at(name)] = 0;
  base_ = base;
}

void ExactSearch::closeLast(int name, std::size_t depth, double known) {
  Vertices all;
  free_.forEach([&](std::size_t v) { all.add(problem_, v); });
  PlaceSet allowed = problem_.allowed[at(name)];
  if (!allowed.containsAll(all.members)) return;
  if (params_.connected && !hangTogether(problem_, all.members)) return;
  close(name, all, depth, known);
}

int ExactSearch::nextName(const Node& here) const {
  // Confirmed names first, then those that others hang on, then that with the fewest choices.
  int best = -1, best_edges = -1;
  for (int i = 0; i < n_; ++i) {
    if (is_closed_[at(i)] || !has_fixed_[at(i)]) continue;
    int edges = 0;
    for (int j = 0; j < n_; ++j) edges += problem_.areJoined(at(i), at(j));
    if (edges > best_edges) {
      best = i;
      best_edges = edges;
    }
  }
  if (best >= 0) return best;
  for (const int i : here.rows) {
    if (told_closed_[at(i)] == 0 && !closed_list_.empty()) continue;
    int edges = 0;
    for (const int j : here.rows) edges += problem_.areJoined(at(i), at(j));
    if (edges >= 2 && edges > best_edges) {
      best = i;
      best_edges = edges;
    }
  }
  if (best >= 0) return best;
  const double room = 1.0 - solutions_.needed() - here.table_bound;
  int fewest = std::numeric_limits<int>::max();
  for (std::size_t r = 0; r < here.rows.size(); ++r) {
    const int row = static_cast<int>(r);
    int count = here.table.reducedWithout(row) <= room;
    for (std::size_t s = 0; s < here.setCount() && count < fewest; ++s) {
      const double cost = here.cost[r * here.setCount() + s];
      count += cost < kNever &&
               here.table.reduced(row, here.column_of[at(anchorOf(here, s))], cost) <= room;
    }
    for (const LooseAnchor& piece : here.loose) {
      const int column = here.column_of[at(piece.anchor)];
      const double cost = here.table.cost(row, column);
      count += cost < kNever && here.table.reduced(row, column, cost) <= room ? 4 : 0;
    }
    if (count < fewest) {
      best = here.rows[r];
      fewest = count;
    }
  }
  return best;
}

std::vector<ExactSearch::Choice> ExactSearch::choicesOf(const Node& here, int name) const {
  std::vector<Choice> out;
  const int row = here.row_of[at(name)];
  const auto add = [&](double reduced, int set, int seed, std::size_t vertices) {
    const Choice c{std::max(here.bound, here.table_bound + std::max(0.0, reduced)), set, seed};
    if (!hopeless(c.bound, taken_ + vertices)) out.push_back(c);
  };
  for (std::size_t s = 0; s < here.setCount(); ++s) {
    const double cost = here.cost[at(row) * here.setCount() + s];
    if (cost < kNever)
      add(here.table.reduced(row, here.column_of[at(anchorOf(here, s))], cost), static_cast<int>(s),
          -1, at(setOf(here, s).count));
  }
  for (const LooseAnchor& loose : here.loose) {
    const int column = here.column_of[at(loose.anchor)];
    const double cost = here.table.cost(row, column);
    if (cost < kNever) add(here.table.reduced(row, column, cost), -1, loose.anchor, 1);
  }
  add(here.table.reducedWithout(row), -1, -1, 0);
  std::stable_sort(out.begin(), out.end(),
                   [](const Choice& a, const Choice& b) { return a.bound < b.bound; });
  return out;
}

void ExactSearch::search(std::size_t depth, double known) {
  ++visited_;
  if (stopped()) return note(known);
  if (closed_list_.size() == at(n_)) return leaf();
  Node& here = node(depth);
  const double least = std::max(known, bound(&here, nullptr));
  if (hopeless(least, taken(here))) return;
  const int name = nextName(here);
  if (!params_.dummy && closed_list_.size() + 1 == at(n_)) return closeLast(name, depth + 1, least);
  if (!has_fixed_[at(name)]) return branch(&here, name, depth);
  Vertices has;
  for (int v = 0; v < m_; ++v)
    if (problem_.fixed[at(v)] == name) has.add(problem_, at(v));
  startFrom(name, has, free_ - fixed_, depth + 1, least);
}

void ExactSearch::branch(Node* here, int name, std::size_t depth) {
  for (const Choice& choice : choicesOf(*here, name)) {
    if (hopeless(choice.bound, taken_)) continue;
    if (stopped_) {
      note(choice.bound);
      continue;
    }
    if (choice.set >= 0) {
      const Vertices vertices = setOf(*here, at(choice.set));
      close(name, vertices, depth + 1, choice.bound);
    } else if (choice.seed >= 0) {
      Vertices has;
      has.add(problem_, at(choice.seed));
      startFrom(name, has, (free_ - fixed_) & lower_[at(choice.seed)], depth + 1, choice.bound);
    } else {
      close(name, Vertices(), depth + 1, choice.bound);
    }
  }
}

void ExactSearch::startFrom(int name, const Vertices& has, PlaceSet open, std::size_t depth,
                            double known) {
  Growth growth;
  growth.name = name;
  growth.has = has;
  growth.open = (open & problem_.allowed[at(name)]) - has.members;
  keepReachable(&growth);
  locate(&growth);
  grow(growth, depth, known);
}

void ExactSearch::grow(const Growth& growth, std::size_t depth, double known) {
  const PlaceSet next = params_.connected ? growth.has.around & growth.open : growth.open;
  if (next.empty()) return close(growth.name, growth.has, depth, known);
  ++visited_;
  if (stopped()) return note(known);
  // The vertex first that would move the centre most.
  std::size_t vertex = next.first();
  double most = -1.0;
  next.forEach([&](std::size_t v) {
    const double pull = growth.has.hasCentre()
                            ? problem_.weight[v] * std::hypot(problem_.x[v] - growth.has.x(),
                                                              problem_.y[v] - growth.has.y())
                            : 0.0;
    if (pull > most) {
      most = pull;
      vertex = v;
    }
  });
  Growth children[2] = {growth, growth};
  double bounds[2];
  for (int k = 0; k < 2; ++k) {
    children[k].open.erase(vertex);
    if (k == 1) children[k].has.add(problem_, vertex);
    keepReachable(&children[k]);
    locate(&children[k]);
    bounds[k] = std::max(known, bound(&node(depth), &children[k]));
  }
  const int first = bounds[1] < bounds[0] ? 1 : 0;
  for (const int k : {first, 1 - first}) {
    if (hopeless(bounds[k], taken_ + at(children[k].has.count))) continue;
    if (stopped_)
      note(bounds[k]);
    else
      grow(children[k], depth, bounds[k]);
  }
}

Group::Least ExactSearch::leastLoss(std::uint64_t max_nodes, double known) {
  listSectors(0.0);
  Group::Least least;
  least.loss = known;
  max_nodes_ = max_nodes;
  for (double loss = std::max(kFirstLoss, 1.25 * known); loss < 1.0; loss *= 1.25) {
    solutions_.restart(1.0 - loss);
    if (!searchAll()) break;
    least.loss = loss;
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

void ExactSearch::listSectors(double start) {
  if (problem_.heading || problem_.sides.empty()) {
    all_sectors_ = {{{problem_.heading.value_or(0.0), slack_}, -kAnyHeading, kAnyHeading, {}}};
    return;
  }
  const double width = 2.0 * kPi / kSectors;
  const auto edge = [&](int k) { return -kPi + k * width; };
  for (int k = 0; k < kSectors; ++k)
    // Each heading belongs to one sector, the ends of the circle too.
    all_sectors_.push_back({{edge(k) + 0.5 * width, 0.5 * width + 1e-9},
                            k == 0 ? -kAnyHeading : edge(k),
                            k + 1 == kSectors ? kAnyHeading : edge(k + 1),
                            {}});
  std::stable_sort(all_sectors_.begin(), all_sectors_.end(), [&](const Sector& a, const Sector& b) {
    return std::abs(wrapped(a.heading.value - start)) < std::abs(wrapped(b.heading.value - start));
  });
}

bool ExactSearch::searchAll() {
  unexplored_ = std::numeric_limits<double>::infinity();
  for (Sector& sector : all_sectors_) {
    heading_ = sector.heading;
    sector_low_ = sector.low;
    sector_high_ = sector.high;
    groups_ = &sector.groups;
    if (stopped_)
      note(proven_);
    else
      search(0, proven_);
  }
  return !stopped_;
}

void ExactSearch::deepen(double known_fitness) {
  // All that may lose less than so much, then than more, until the best answers are among it: so
  // little time is lost on what a bad first answer would let pass.
  const double known = std::min(1.0, 1.0 - known_fitness);
  for (Sector& sector : all_sectors_) sector.groups = findGroups();
  for (double loss = kFirstLoss; !stopped_; loss *= kDeeper) {
    const bool last = loss >= known;
    const double limit = std::min(loss, known);
    solutions_.restart(1.0 - limit);
    const bool all = searchAll();
    const double found = solutions_.any() ? 1.0 - solutions_.best() : 1.0;
    if (!all) {
      proven_ = std::max(proven_, std::min(unexplored_, limit));
      return;
    }
    proven_ = std::min(limit, found);
    if (last || found <= limit + kEqualFitness) return;
    if (found < 1.0) loss = found / kDeeper;  // within keep_within of the limit: once more
  }
}

Match ExactSearch::run() {
  Match first;
  if (!problem_.heading && !problem_.sides.empty()) {
    first = treeSearch(problem_, params_, kFirstRevisits);
    if (first.found()) solutions_.expect(first.best().fitness);
  }
  listSectors(first.found() ? first.best().heading : 0.0);
  max_nodes_ = kFirstNodes;
  if (!searchAll()) {
    stopped_ = watch_.seconds() > params_.time_limit;
    max_nodes_ = std::numeric_limits<std::uint64_t>::max();
    for (const MatchSolution& s : solutions_.kept())
      if (!first.found() || s.fitness > first.best().fitness) first.solutions = {s};
    // In large problems the first answers are far from good.
    if (!first.found()) first = treeSearch(problem_, params_, 0);
    if (first.found() && n_ * m_ > kLarge)
      first.solutions[0] = improved(problem_, params_, terms_, first.best(),
                                    0.25 * std::min(params_.time_limit, kLongest));
    if (first.found()) solutions_.expect(first.best().fitness);
    const double known = first.found() ? first.best().fitness : -1.0;
    deepen(known);
    unexplored_ = proven_;
  }
  if (first.found() && first.best().fitness > solutions_.best() + kEqualFitness) {
    solutions_.restart(first.best().fitness);
    solutions_.offer(first.best());
  }
  Match match = solutions_.finish();
  match.optimal = !stopped_;
  if (stopped_)
    match.gap = std::max(
        0.0, 1.0 - std::min(1.0, unexplored_) - (match.found() ? match.best().fitness : 0.0));
  if (stopped_ && match.found() && match.gap <= kEqualFitness) match.optimal = true;
  match.nodes = visited_;
  match.microseconds = watch_.seconds() * 1e6;
  return match;
}

}  // namespace merging

Match solveExact(const MatchProblem& problem, const MatchParams& params) {
  checkMatchParams(params);
  const merging::Terms terms(problem, params.fitness);
  return merging::ExactSearch(problem, params, terms).run();
}

}  // namespace hyselam_topo
