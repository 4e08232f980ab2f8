// TopoMergExplorer (Alg. 2): a number system with a digit for each place that is not confirmed.
#include <algorithm>
#include <cmath>

#include "fitness_terms.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_topo/topomerg/topomerg.hpp"
#include "solutions.hpp"

namespace hyselam_topo {
namespace {

using merging::FitnessTerms;
using merging::VertexSet;

/// The losses of names and pairs; only those of names that have changed are computed again.
class Ledger {
 public:
  explicit Ledger(const FitnessTerms& terms)
      : terms_(terms),
        n_(static_cast<int>(terms.problem.nameCount())),
        names_(terms.problem.nameCount()),
        pairs_(terms.problem.nameCount() * terms.problem.nameCount()) {
    for (std::size_t s = 0; s < terms.problem.sides.size(); ++s) {
      const auto& side = terms.problem.sides[s];
      pairs_[at(side.from, side.to)].side = static_cast<int>(s);
    }
  }

  void assign(const Assignment& assignment, const std::vector<char>& changed) {
    const std::size_t m = assignment.size();
    for (int i = 0; i < n_; ++i)
      if (changed[static_cast<std::size_t>(i)]) names_[static_cast<std::size_t>(i)] = {};
    for (std::size_t v = 0; v < m; ++v)
      if (assignment[v] >= 0 && changed[static_cast<std::size_t>(assignment[v])])
        names_[static_cast<std::size_t>(assignment[v])].add(terms_.problem, v);
    for (int i = 0; i < n_; ++i) {
      for (int j = i; j < n_; ++j) {
        if (!changed[static_cast<std::size_t>(i)] && !changed[static_cast<std::size_t>(j)])
          continue;
        pairs_[at(i, j)].loss = i == j ? terms_.unaryLoss(i, of(i)) : pairLoss(i, j);
      }
    }
  }

  double loss() const {
    double sum = 0.0;
    for (int i = 0; i < n_; ++i)
      for (int j = i; j < n_; ++j) sum += pairs_[at(i, j)].loss;
    for (const FitnessTerms::Clause& clause : terms_.clauses)
      sum += terms_.clauseLoss(clause, [this](int i) -> const VertexSet& { return of(i); });
    return sum;
  }

 private:
  struct Pair {
    double loss = 0.0;
    int side = -1;  ///< described of this pair in this order
  };
  std::size_t at(int i, int j) const {
    return static_cast<std::size_t>(i) * names_.size() + static_cast<std::size_t>(j);
  }
  const VertexSet& of(int i) const { return names_[static_cast<std::size_t>(i)]; }
  double pairLoss(int i, int j) const {
    double loss = terms_.edgeLoss(i, j, of(i), of(j));
    for (const int s : {pairs_[at(i, j)].side, pairs_[at(j, i)].side}) {
      if (s < 0) continue;
      const auto& side = terms_.problem.sides[static_cast<std::size_t>(s)];
      loss += terms_.sideLoss(side, of(side.from), of(side.to), {*terms_.problem.heading, 0.0});
    }
    return loss;
  }

  const FitnessTerms& terms_;
  const int n_;
  std::vector<VertexSet> names_;
  std::vector<Pair> pairs_;
};

}  // namespace

double countAssignments(const MatchProblem& problem, const SolverParams& params) {
  const auto free = std::count(problem.confirmed_name.begin(), problem.confirmed_name.end(), -1);
  return std::pow(static_cast<double>(problem.nameCount()) + (params.dummy ? 1.0 : 0.0),
                  static_cast<double>(free));
}

PlaceAssignment exploreAll(const MatchProblem& problem, const SolverParams& params,
                           std::uint64_t max_assignments) {
  params.validate();
  const double count = countAssignments(problem, params);
  if (count > static_cast<double>(max_assignments))
    throw hyselam::InputError("map", "", "has too many places to explore all assignments");
  const merging::Stopwatch watch;
  const FitnessTerms terms(problem, params.fitness);
  const std::size_t n = problem.nameCount(), m = problem.vertexCount();
  const int lowest = params.dummy ? -1 : 0;

  Assignment assignment = problem.confirmed_name;
  std::vector<std::size_t> digits;
  for (std::size_t v = 0; v < m; ++v) {
    if (problem.confirmed_name[v] >= 0) continue;
    digits.push_back(v);
    assignment[v] = lowest;
  }
  merging::Solutions solutions(params);
  std::uint64_t visited = 0;
  if (n > 0 || params.dummy || digits.empty()) {
    Ledger ledger(terms);
    std::vector<char> changed(n, 1);
    for (bool going = true; going;) {
      ++visited;
      bool good = true;
      if (problem.heading || problem.sides.empty()) {
        ledger.assign(assignment, changed);
        good = 1.0 - ledger.loss() >= solutions.needed() - 1e-9;
      }
      for (std::size_t k = 0; good && k < digits.size(); ++k) {
        const int i = assignment[digits[k]];
        good = i < 0 || problem.allowed[static_cast<std::size_t>(i)].contains(digits[k]);
      }
      if (good) {
        MatchSolution s;
        const std::vector<VertexSet> names = merging::verticesOf(problem, assignment);
        for (const VertexSet& v : names) {
          good = good && (!params.connected || merging::isConnected(problem, v.members));
          s.vertices += static_cast<std::size_t>(v.count);
        }
        if (good) {
          s.assignment = assignment;
          s.fitness = merging::evaluate(terms, names, &s.heading);
          solutions.offer(std::move(s));
        }
      }
      // The next number.
      std::fill(changed.begin(), changed.end(), 0);
      going = false;
      for (const std::size_t v : digits) {
        int& digit = assignment[v];
        if (digit >= 0) changed[static_cast<std::size_t>(digit)] = 1;
        going = ++digit < static_cast<int>(n);
        if (!going) digit = lowest;
        if (digit >= 0) changed[static_cast<std::size_t>(digit)] = 1;
        if (going) break;
      }
    }
  }
  PlaceAssignment match = solutions.finish();
  match.optimal = true;
  match.scale = terms.scale();
  match.nodes = visited;
  match.microseconds = watch.seconds() * 1e6;
  return match;
}

}  // namespace hyselam_topo
