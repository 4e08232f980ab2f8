// TopoMerg (dos Santos, section 5.3): finds the places of the robot's map that the names of a
// description mean. Each place has one name or none, a name may mean several places.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "hyselam_topo/topomerg/topomerg_problem.hpp"

namespace hyselam_topo {

struct MatchParams {
  FitnessParams fitness;
  /// k_s of Eq. 5.5: places of the map may stay without a name.
  bool dummy = true;
  /// Only answers where the places of one name hang together in the map, as Alg. 3 builds them.
  /// False: any places, as TopoMergExplorer (Alg. 2) tries them. Places that are confirmed need not
  /// hang together with each other.
  bool connected = true;
  /// The exact solver stops after this and tells its best answer with the gap; the tree search
  /// tries nothing again after it [s].
  double time_limit = std::numeric_limits<double>::infinity();
  /// As many equally good answers are kept, >= 1.
  std::size_t max_solutions = 1000;
  /// Answers that are worse by up to this are kept too, 0 .. 1.
  double keep_within = 0.0;
};

/// Answers whose fitness differs by less are equally good.
constexpr double kEqualFitness = 1e-9;

struct MatchSolution {
  Assignment assignment;
  double fitness = 0.0;
  double heading = 0.0;      ///< of the robot, as known or as it fits best
  std::size_t vertices = 0;  ///< with a name
};

/// An answer to a MatchProblem.
struct Match {
  /// The best ones first; of equally good ones those that name fewer places, then in the order of
  /// the assignments. Empty if the constraints allow no answer, or if none was found in time.
  std::vector<MatchSolution> solutions;
  std::size_t equal = 0;    ///< as good as the first
  bool more = false;        ///< more than `max_solutions` fit; the first is nevertheless a best
  bool optimal = false;     ///< nothing is better than the first
  double gap = 0.0;         ///< nothing is better than its fitness plus this
  std::uint64_t nodes = 0;  ///< partial answers looked at; explorer: answers
  double microseconds = 0.0;

  bool found() const { return !solutions.empty(); }
  const MatchSolution& best() const { return solutions.front(); }
};

/// TopoMergExplorer (Alg. 2): all answers. For tests and small maps; throws hyselam::InputError if
/// there are more than `max_answers`.
Match exploreAll(const MatchProblem& problem, const MatchParams& params,
                 std::uint64_t max_answers = std::uint64_t{1} << 33);

/// The number of answers that exploreAll() visits (Eq. 5.5); infinite if it does not fit a double.
double countAnswers(const MatchProblem& problem, const MatchParams& params);

/// The thesis' tree search (Alg. 3): name by name, the place that fits best, then the neighbours
/// that the number of edges asks for; equally good choices are tried again later, up to
/// `max_revisits` of them. Fast, but not always best: `optimal` is false.
Match treeSearch(const MatchProblem& problem, const MatchParams& params,
                 std::size_t max_revisits = 1000);

/// Branch and bound: the best answers, the same as exploreAll() finds. Without a time limit equal
/// input gives equal output.
Match solveExact(const MatchProblem& problem, const MatchParams& params);

/// Throws hyselam::ParameterError for a parameter out of range.
void checkMatchParams(const MatchParams& params);

}  // namespace hyselam_topo
