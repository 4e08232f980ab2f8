#include "exact_search.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace hyselam_topo::merging {
namespace {

/// The clock is asked once in as many nodes.
constexpr std::uint64_t kClockEvery = 16;
/// Whoever takes a vertex with as many neighbours is in the way of names with many joined to them.
constexpr std::size_t kBusy = 3;

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

}  // namespace hyselam_topo::merging
