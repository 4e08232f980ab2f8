// The thesis' tree search (Alg. 3). The names are visited from those that are confirmed outwards,
// those with most attributes first; each takes the vertex that fits best, and then neighbors of
// its vertices while the number of edges or the size asks for more.
#include <algorithm>
#include <cstdlib>
#include <set>

#include "fitness_terms.hpp"
#include "hyselam_topo/topomerg/topomerg.hpp"
#include "solutions.hpp"

namespace hyselam_topo {
namespace {

using merging::FitnessTerms;
using merging::VertexSet;

/// epsilon_A: a size that is met this closely needs no more places.
constexpr double kAreaTolerance = 0.1;

class TreeSearch {
 public:
  TreeSearch(const MatchProblem& problem, const SolverParams& params)
      : problem_(problem), params_(params), terms_(problem, params.fitness) {}

  PlaceAssignment run(std::size_t max_revisits) {
    const merging::Stopwatch watch;
    merging::Solutions best(params_);
    std::vector<State> waiting{first()};
    for (std::size_t round = 0; !waiting.empty() && round <= max_revisits; ++round) {
      if (round > 0 && watch.seconds() > params_.time_limit) break;
      State state = std::move(waiting.back());
      waiting.pop_back();
      finish(&state, &waiting);
      if (!params_.dummy) takeRest(&state);
      if (!allowedAnswer(state.assignment) || !seen_.insert(state.assignment).second) continue;
      MatchSolution s;
      s.fitness = value(state.assignment, &s.heading);
      s.vertices = static_cast<std::size_t>(std::count_if(
          state.assignment.begin(), state.assignment.end(), [](int i) { return i >= 0; }));
      s.assignment = std::move(state.assignment);
      best.offer(std::move(s));
    }
    PlaceAssignment match = best.finish();
    match.scale = terms_.scale();
    match.nodes = nodes_;
    match.gap = match.found() ? 1.0 - match.best().fitness : 1.0;
    match.microseconds = watch.seconds() * 1e6;
    return match;
  }

 private:
  struct State {
    Assignment assignment;
    std::vector<char> visited;  ///< of each name
    int name = -1;              ///< being built; -1: the next one is to be chosen
  };

  State first() const {
    return {problem_.confirmed_name, std::vector<char>(problem_.nameCount(), 0), -1};
  }

  double value(const Assignment& assignment, double* heading = nullptr) {
    ++nodes_;
    return merging::evaluate(terms_, merging::verticesOf(problem_, assignment), heading);
  }

  int attributes(int i) const {
    const auto& described = problem_.attributes[static_cast<std::size_t>(i)];
    return (described.area > 0.0) + (described.parts > 0) +
           static_cast<int>(terms_.sides_of[static_cast<std::size_t>(i)].size());
  }

  /// Graphexplorer: connected to what has been visited, with most attributes, with most such edges.
  int nextName(const State& state) const {
    const int n = static_cast<int>(problem_.nameCount());
    int best = -1;
    std::array<int, 4> best_key{};
    for (int i = 0; i < n; ++i) {
      if (state.visited[static_cast<std::size_t>(i)]) continue;
      const bool confirmed =
          std::find(problem_.confirmed_name.begin(), problem_.confirmed_name.end(), i) !=
          problem_.confirmed_name.end();
      int edges = 0;
      for (int j = 0; j < n; ++j)
        edges += state.visited[static_cast<std::size_t>(j)] &&
                 problem_.areConnected(static_cast<std::size_t>(i), static_cast<std::size_t>(j));
      const std::array<int, 4> key{confirmed, edges > 0, attributes(i), edges};
      if (best < 0 || key > best_key) {
        best = i;
        best_key = key;
      }
    }
    return best;
  }

  /// Difference of the numbers of edges, of the name and of its vertices to others.
  int edgeError(int i, const VertexSet& v) const {
    int described = 0;
    for (std::size_t j = 0; j < problem_.nameCount(); ++j)
      described += problem_.areConnected(static_cast<std::size_t>(i), j);
    return std::abs(described - static_cast<int>(v.neighbors.size()));
  }

  /// GraphAddVertice: the vertices that are equally good to add, none if there is no reason to.
  std::vector<std::size_t> choices(const State& state) {
    const int i = state.name;
    const std::vector<VertexSet> names = merging::verticesOf(problem_, state.assignment);
    const VertexSet& mine = names[static_cast<std::size_t>(i)];
    std::vector<std::size_t> equal;
    double best = 0.0;
    int best_error = 0;
    const double now = value(state.assignment);
    for (std::size_t v = 0; v < problem_.vertexCount(); ++v) {
      if (state.assignment[v] >= 0 || !problem_.allowed[static_cast<std::size_t>(i)].contains(v))
        continue;
      if (!mine.empty() && !mine.neighbors.contains(v)) continue;
      Assignment with = state.assignment;
      with[v] = i;
      VertexSet grown = mine;
      grown.add(problem_, v);
      const int error = mine.empty() ? 0 : edgeError(i, grown);
      const double f = value(with);
      if (!mine.empty() && f <= now + kEqualFitness) continue;  // the set is large enough
      const bool better =
          equal.empty() || error < best_error || (error == best_error && f > best + kEqualFitness);
      const bool as_good = !better && error == best_error && f >= best - kEqualFitness;
      if (better) {
        equal.clear();
        best = f;
        best_error = error;
      }
      if (better || as_good) equal.push_back(v);
    }
    return equal;
  }

  bool wantsMore(const State& state) const {
    const auto names = merging::verticesOf(problem_, state.assignment);
    const VertexSet& mine = names[static_cast<std::size_t>(state.name)];
    if (mine.empty()) return true;
    const double described = problem_.attributes[static_cast<std::size_t>(state.name)].area;
    if (described > 0.0 && mine.area < (1.0 - kAreaTolerance) * described) return true;
    return edgeError(state.name, mine) != 0;
  }

  void finish(State* state, std::vector<State>* waiting) {
    while (true) {
      if (state->name < 0) state->name = nextName(*state);
      if (state->name < 0) return;
      while (wantsMore(*state)) {
        const std::vector<std::size_t> equal = choices(*state);
        if (equal.empty()) break;
        for (std::size_t k = equal.size(); k-- > 1;) {
          State other = *state;
          other.assignment[equal[k]] = other.name;
          waiting->push_back(std::move(other));
        }
        state->assignment[equal.front()] = state->name;
      }
      state->visited[static_cast<std::size_t>(state->name)] = 1;
      state->name = -1;
    }
  }

  /// Without dummy each vertex needs a name: that of the neighbors that fits best.
  void takeRest(State* state) {
    for (std::size_t rounds = 0; rounds < problem_.vertexCount(); ++rounds) {
      double best = -1.0;
      std::size_t at = problem_.vertexCount();
      int name = -1;
      for (std::size_t v = 0; v < problem_.vertexCount(); ++v) {
        if (state->assignment[v] >= 0) continue;
        for (int i = 0; i < static_cast<int>(problem_.nameCount()); ++i) {
          if (!problem_.allowed[static_cast<std::size_t>(i)].contains(v)) continue;
          Assignment with = state->assignment;
          with[v] = i;
          if (!allowedAnswer(with, false)) continue;
          const double f = value(with);
          if (f > best) {
            best = f;
            at = v;
            name = i;
          }
        }
      }
      if (name < 0) return;
      state->assignment[at] = name;
    }
  }

  bool allowedAnswer(const Assignment& assignment, bool whole = true) const {
    if (whole && !params_.dummy &&
        std::find(assignment.begin(), assignment.end(), -1) != assignment.end())
      return false;
    if (!params_.connected) return true;
    const auto names = merging::verticesOf(problem_, assignment);
    return std::all_of(names.begin(), names.end(), [&](const VertexSet& v) {
      return merging::isConnected(problem_, v.members);
    });
  }

  const MatchProblem& problem_;
  const SolverParams& params_;
  const FitnessTerms terms_;
  std::set<Assignment> seen_;
  std::uint64_t nodes_ = 0;
};

}  // namespace

PlaceAssignment treeSearch(const MatchProblem& problem, const SolverParams& params,
                           std::size_t max_revisits) {
  params.validate();
  return TreeSearch(problem, params).run(max_revisits);
}

}  // namespace hyselam_topo
