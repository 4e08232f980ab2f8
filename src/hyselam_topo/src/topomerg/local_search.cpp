#include "local_search.hpp"

#include <algorithm>

#include "solutions.hpp"

namespace hyselam_topo::merging {
namespace {

class Improver {
 public:
  Improver(const MatchProblem& problem, const SolverParams& params, const FitnessTerms& terms,
           MatchSolution start, double seconds)
      : problem_(problem),
        params_(params),
        terms_(terms),
        best_(std::move(start)),
        names_(verticesOf(problem, best_.assignment)),
        seconds_(seconds) {}

  MatchSolution run() {
    bool better = true;
    while (better && !late()) {
      better = false;
      for (std::size_t v = 0; v < problem_.vertexCount() && !late(); ++v)
        better = moveVertex(v) || better;
      for (std::size_t i = 0; i < problem_.nameCount() && !late(); ++i)
        for (std::size_t j = 0; j < i; ++j) better = exchange(i, j) || better;
    }
    best_.vertices = static_cast<std::size_t>(std::count_if(
        best_.assignment.begin(), best_.assignment.end(), [](int i) { return i >= 0; }));
    return best_;
  }

 private:
  bool late() const { return watch_.seconds() > seconds_; }

  VertexSet collect(const PlaceSet& members) const {
    VertexSet out;
    members.forEach([&](std::size_t v) { out.add(problem_, v); });
    return out;
  }
  bool fits(int name, const PlaceSet& members) const {
    return problem_.allowed[static_cast<std::size_t>(name)].containsAll(members) &&
           (!params_.connected || isConnected(problem_, members));
  }
  /// Keeps `names_` as they are now if that is better.
  bool keep(const std::vector<std::pair<int, VertexSet>>& before) {
    double heading = 0.0;
    const double f = evaluate(terms_, names_, &heading);
    if (f <= best_.fitness + kEqualFitness) {
      for (const auto& [name, vertices] : before) names_[static_cast<std::size_t>(name)] = vertices;
      return false;
    }
    best_.fitness = f;
    best_.heading = heading;
    for (const auto& [name, vertices] : before)
      vertices.members.forEach([&](std::size_t v) { best_.assignment[v] = -1; });
    for (const auto& [name, vertices] : before)
      names_[static_cast<std::size_t>(name)].members.forEach(
          [&, i = name](std::size_t v) { best_.assignment[v] = i; });
    return true;
  }

  bool moveVertex(std::size_t v) {
    if (problem_.confirmed_name[v] >= 0) return false;
    bool better = false;
    for (int to = params_.dummy ? -1 : 0; to < static_cast<int>(problem_.nameCount()); ++to) {
      const int from = best_.assignment[v];
      if (to == from) continue;
      std::vector<std::pair<int, VertexSet>> before;
      bool good = true;
      if (from >= 0) {
        before.emplace_back(from, names_[static_cast<std::size_t>(from)]);
        PlaceSet left = before.back().second.members;
        left.erase(v);
        good = fits(from, left);
        if (good) names_[static_cast<std::size_t>(from)] = collect(left);
      }
      if (good && to >= 0) {
        PlaceSet more = names_[static_cast<std::size_t>(to)].members;
        more.insert(v);
        good = fits(to, more);
        if (good) {
          before.emplace_back(to, names_[static_cast<std::size_t>(to)]);
          names_[static_cast<std::size_t>(to)] = collect(more);
        }
      }
      if (!good) {
        for (const auto& [name, vertices] : before)
          names_[static_cast<std::size_t>(name)] = vertices;
        continue;
      }
      if (keep(before)) {
        // What had no name is not in `before` and needs none now.
        if (to < 0) best_.assignment[v] = -1;
        better = true;
      }
    }
    return better;
  }

  bool exchange(std::size_t i, std::size_t j) {
    const VertexSet a = names_[i], b = names_[j];
    if (!fits(static_cast<int>(i), b.members) || !fits(static_cast<int>(j), a.members))
      return false;
    const auto confirmed = [&](const VertexSet& v) {
      bool any = false;
      v.members.forEach([&](std::size_t m) { any = any || problem_.confirmed_name[m] >= 0; });
      return any;
    };
    if (confirmed(a) || confirmed(b)) return false;
    names_[i] = b;
    names_[j] = a;
    return keep({{static_cast<int>(i), a}, {static_cast<int>(j), b}});
  }

  const MatchProblem& problem_;
  const SolverParams& params_;
  const FitnessTerms& terms_;
  MatchSolution best_;
  std::vector<VertexSet> names_;
  const double seconds_;
  const Stopwatch watch_;
};

}  // namespace

MatchSolution searchLocally(const MatchProblem& problem, const SolverParams& params,
                            const FitnessTerms& terms, MatchSolution start, double seconds) {
  return Improver(problem, params, terms, std::move(start), seconds).run();
}

}  // namespace hyselam_topo::merging
