#include "exact_search.hpp"

#include <algorithm>
#include <cmath>

namespace hyselam_topo::merging {
namespace {

/// The clock is asked once in as many nodes.
constexpr std::uint64_t kClockEvery = 16;
/// A name with as many described edges to names without vertices is tried before others.
constexpr int kManyEdges = 2;
/// A vertex whose sets are not listed counts as so many choices.
constexpr int kChoicesOfLooseAnchor = 4;

}  // namespace

ExactSearch::ExactSearch(const MatchProblem& problem, const SolverParams& params,
                         const FitnessTerms& terms)
    : problem_(problem),
      params_(params),
      terms_(terms),
      tables_(problem, terms),
      state_(problem),
      sets_(problem, params.connected, state_.free() - tables_.confirmedVertices()),
      losses_(problem, terms, tables_, state_),
      groups_(problem, params, terms, tables_, watch_),
      bound_(problem, terms, tables_, sets_, state_, losses_, groups_),
      solutions_(params) {}

SearchNode& ExactSearch::node(std::size_t depth) {
  while (nodes_.size() <= depth) nodes_.emplace_back();
  return nodes_[depth];
}

double ExactSearch::bound(SearchNode& node, const PartialSet* partial) {
  return bound_.compute(node, partial, sector_->groups, 1.0 - solutions_.needed());
}

bool ExactSearch::stopped() {
  if (visited_ > max_nodes_) stopped_ = true;
  if (!stopped_ && visited_ % kClockEvery == 0 && std::isfinite(params_.time_limit))
    stopped_ = watch_.seconds() > params_.time_limit;
  return stopped_;
}

bool ExactSearch::canPrune(double bound, std::size_t min_named_vertices) const {
  if (1.0 - bound < solutions_.needed()) return true;
  return solutions_.full() && min_named_vertices >= solutions_.fewest() &&
         1.0 - bound <= solutions_.best() + kEqualFitness;
}

std::size_t ExactSearch::minNamedVertices(const SearchNode& here) const {
  std::size_t more = 0;
  for (std::size_t r = 0; r < here.rows.size(); ++r)
    more += here.table.reducedWithout(static_cast<int>(r)) > room(here);
  return state_.namedVertices() + more;
}

void ExactSearch::leaf() {
  if (!params_.dummy && !state_.free().empty()) return;
  MatchSolution s;
  s.assignment = state_.assignment();
  // With a heading that is only known up to a slack, what counts is what no heading in it can
  // undercut.
  s.fitness = heading_slack_ > 0.0
                  ? 1.0 - state_.loss()
                  : evaluate(terms_, verticesOf(problem_, state_.assignment()), &s.heading);
  s.vertices = state_.namedVertices();
  if (!problem_.heading && !(s.heading >= sector_->low && s.heading < sector_->high)) return;
  solutions_.offer(std::move(s));
}

void ExactSearch::close(int name, const VertexSet& vertices, std::size_t depth, double known) {
  const double loss_before = state_.loss();
  state_.close(name, vertices, losses_.exactLoss(name, vertices));
  search(depth, known);
  state_.reopen(loss_before);
}

void ExactSearch::closeLast(int name, std::size_t depth, double known) {
  VertexSet all;
  state_.free().forEach([&](std::size_t v) { all.add(problem_, v); });
  if (!problem_.allowed[at(name)].containsAll(all.members)) return;
  if (params_.connected && !isConnected(problem_, all.members)) return;
  close(name, all, depth, known);
}

int ExactSearch::nextName(const SearchNode& here) const {
  // Confirmed names first, then those that others depend on, then that with the fewest choices.
  int name = nextConfirmedName();
  if (name < 0) name = nextHub(here);
  return name >= 0 ? name : nameOfFewestChoices(here);
}

int ExactSearch::nextConfirmedName() const {
  int best = -1, best_edges = -1;
  for (int i = 0; i < tables_.nameCount(); ++i) {
    if (state_.isClosed(i) || !tables_.isConfirmed(i) || tables_.degree(i) <= best_edges) continue;
    best = i;
    best_edges = tables_.degree(i);
  }
  return best;
}

int ExactSearch::nextHub(const SearchNode& here) const {
  int best = -1, best_edges = -1;
  for (const int i : here.rows) {
    if (state_.closedNeighbors(i) == 0 && !state_.closed().empty()) continue;
    int edges = 0;
    for (const int j : here.rows) edges += problem_.areConnected(at(i), at(j));
    if (edges >= kManyEdges && edges > best_edges) {
      best = i;
      best_edges = edges;
    }
  }
  return best;
}

int ExactSearch::nameOfFewestChoices(const SearchNode& here) const {
  const double max_cost = room(here);
  int best = -1, fewest = std::numeric_limits<int>::max();
  for (std::size_t r = 0; r < here.rows.size(); ++r) {
    const int row = static_cast<int>(r);
    int count = here.table.reducedWithout(row) <= max_cost;
    for (std::size_t s = 0; s < here.setCount() && count < fewest; ++s) {
      const double cost = here.cost[r * here.setCount() + s];
      count += cost < kNever && here.table.reduced(row, here.column_of[at(sets_.anchorOf(here, s))],
                                                   cost) <= max_cost;
    }
    for (const LooseAnchor& loose : here.loose) {
      const int column = here.column_of[at(loose.anchor)];
      const double cost = here.table.cost(row, column);
      const bool possible = cost < kNever && here.table.reduced(row, column, cost) <= max_cost;
      count += possible ? kChoicesOfLooseAnchor : 0;
    }
    if (count < fewest) {
      best = here.rows[r];
      fewest = count;
    }
  }
  return best;
}

std::vector<ExactSearch::Choice> ExactSearch::choicesOf(const SearchNode& here, int name) const {
  std::vector<Choice> out;
  const int row = here.row_of[at(name)];
  const auto add = [&](double reduced, int set, int seed, std::size_t vertices) {
    const Choice c{std::max(here.bound, here.table_bound + std::max(0.0, reduced)), set, seed};
    if (!canPrune(c.bound, state_.namedVertices() + vertices)) out.push_back(c);
  };
  for (std::size_t s = 0; s < here.setCount(); ++s) {
    const double cost = here.cost[at(row) * here.setCount() + s];
    if (cost < kNever)
      add(here.table.reduced(row, here.column_of[at(sets_.anchorOf(here, s))], cost),
          static_cast<int>(s), -1, at(sets_.setOf(here, s).count));
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
  if (stopped()) return noteUnexplored(known);
  const std::size_t names = problem_.nameCount();
  if (state_.closed().size() == names) return leaf();
  SearchNode& here = node(depth);
  const double least = std::max(known, bound(here, nullptr));
  if (canPrune(least, minNamedVertices(here))) return;
  const int name = nextName(here);
  if (!params_.dummy && state_.closed().size() + 1 == names)
    return closeLast(name, depth + 1, least);
  if (!tables_.isConfirmed(name)) return branch(here, name, depth);
  VertexSet has;
  for (std::size_t v = 0; v < problem_.vertexCount(); ++v)
    if (problem_.confirmed_name[v] == name) has.add(problem_, v);
  startFrom(name, has, state_.free() - tables_.confirmedVertices(), depth + 1, least);
}

void ExactSearch::branch(SearchNode& here, int name, std::size_t depth) {
  for (const Choice& choice : choicesOf(here, name)) {
    if (canPrune(choice.bound, state_.namedVertices())) continue;
    if (stopped_) {
      noteUnexplored(choice.bound);
      continue;
    }
    if (choice.set >= 0) {
      const VertexSet vertices = sets_.setOf(here, at(choice.set));
      close(name, vertices, depth + 1, choice.bound);
    } else if (choice.seed >= 0) {
      VertexSet has;
      has.add(problem_, at(choice.seed));
      const PlaceSet open = state_.free() - tables_.confirmedVertices();
      startFrom(name, has, open & sets_.rankedBelow(choice.seed), depth + 1, choice.bound);
    } else {
      close(name, VertexSet(), depth + 1, choice.bound);
    }
  }
}

void ExactSearch::boundPartial(PartialSet& partial) const {
  if (params_.connected) keepReachable(problem_, partial);
  boundCenter(problem_, partial);
}

void ExactSearch::startFrom(int name, const VertexSet& has, const PlaceSet& open, std::size_t depth,
                            double known) {
  PartialSet partial;
  partial.name = name;
  partial.has = has;
  partial.open = (open & problem_.allowed[at(name)]) - has.members;
  boundPartial(partial);
  grow(partial, depth, known);
}

void ExactSearch::grow(const PartialSet& partial, std::size_t depth, double known) {
  const PlaceSet next = params_.connected ? partial.has.neighbors & partial.open : partial.open;
  if (next.empty()) return close(partial.name, partial.has, depth, known);
  ++visited_;
  if (stopped()) return noteUnexplored(known);
  // The vertex first that would move the center most.
  std::size_t vertex = next.first();
  double most = -1.0;
  next.forEach([&](std::size_t v) {
    const double pull = partial.has.hasCenter()
                            ? problem_.weight[v] * std::hypot(problem_.x[v] - partial.has.x(),
                                                              problem_.y[v] - partial.has.y())
                            : 0.0;
    if (pull > most) {
      most = pull;
      vertex = v;
    }
  });
  PartialSet children[2] = {partial, partial};  // without and with the vertex
  double bounds[2];
  for (int k = 0; k < 2; ++k) {
    children[k].open.erase(vertex);
    if (k == 1) children[k].has.add(problem_, vertex);
    boundPartial(children[k]);
    bounds[k] = std::max(known, bound(node(depth), &children[k]));
  }
  const int first = bounds[1] < bounds[0] ? 1 : 0;
  for (const int k : {first, 1 - first}) {
    if (canPrune(bounds[k], state_.namedVertices() + at(children[k].has.count))) continue;
    if (stopped_)
      noteUnexplored(bounds[k]);
    else
      grow(children[k], depth, bounds[k]);
  }
}

}  // namespace hyselam_topo::merging
