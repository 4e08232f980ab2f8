// TopoMerg (dos Santos, section 5.3): finds the places of the robot's map that the names of a
// description mean. Each place has one name or none, a name may mean several places.
//
// Solvers: exploreAll() (Alg. 2), treeSearch() (Alg. 3), solveExact() (branch and bound). All throw
// hyselam::ParameterError for parameters out of range.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "hyselam_common/parameters.hpp"
#include "hyselam_topo/topomerg/fitness.hpp"
#include "hyselam_topo/topomerg/topomerg_problem.hpp"

namespace hyselam_topo {

struct SolverParams {
  FitnessParams fitness;
  /// k_s of Eq. 5.5: places of the map may stay without a name.
  bool dummy = true;
  /// Only assignments where the places of one name are connected in the map, as Alg. 3 builds them.
  /// False: any places, as TopoMergExplorer (Alg. 2) tries them. Confirmed places need not be
  /// connected with each other.
  bool connected = true;
  /// The exact solver stops after this and returns its best assignment with the gap; the tree
  /// search makes no further attempt after it [s of processor time].
  double time_limit = std::numeric_limits<double>::infinity();
  /// Maximum number of assignments that are kept, >= 1.
  std::size_t max_solutions = 1000;
  /// Assignments whose fitness is lower by up to this are kept too, 0 .. 1.
  double keep_within = 0.0;

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError for a value out of range.
  void validate() const;
};

/// Assignments whose fitness differs by less are equally good.
constexpr double kEqualFitness = 1e-9;

struct MatchSolution {
  Assignment assignment;
  double fitness = 0.0;
  double heading = 0.0;      ///< of the robot, as known or as it fits best
  std::size_t vertices = 0;  ///< with a name
};

/// What a solver found: the best assignments of names to places.
struct PlaceAssignment {
  /// The best ones first; of equally good ones those that name fewer places, then in the order of
  /// the assignments. Empty if the constraints allow no assignment, or if none was found in time.
  std::vector<MatchSolution> solutions;
  std::size_t equal = 0;  ///< as good as the first
  bool more = false;      ///< more than `max_solutions` fit; the first is nevertheless a best
  bool optimal = false;   ///< nothing is better than the first
  double gap = 0.0;       ///< nothing is better than its fitness plus this
  /// Weighting::kOdds: an assignment whose fitness is lower by 1 / scale is e times less likely; 0:
  /// the weights say nothing of odds.
  double scale = 0.0;
  std::uint64_t nodes = 0;  ///< partial assignments visited; explorer: assignments
  double microseconds = 0.0;

  bool found() const { return !solutions.empty(); }
  const MatchSolution& best() const { return solutions.front(); }
};

/// TopoMergExplorer (Alg. 2): all assignments. For tests and small maps; all parameters are
/// validated.
/// @throws hyselam::InputError if there are more than `max_assignments`.
PlaceAssignment exploreAll(const MatchProblem& problem, const SolverParams& params,
                           std::uint64_t max_assignments = std::uint64_t{1} << 33);

/// The number of assignments that exploreAll() visits (Eq. 5.5); infinite if it does not fit a
/// double.
double countAssignments(const MatchProblem& problem, const SolverParams& params);

/// The thesis' tree search (Alg. 3): name by name, the place that fits best, then the neighbors
/// that the number of edges asks for; equally good choices are tried again later, up to
/// `max_revisits` of them. Fast, but not always best: `optimal` is false.
PlaceAssignment treeSearch(const MatchProblem& problem, const SolverParams& params,
                           std::size_t max_revisits = 1000);

/// Branch and bound: the best assignments, the same as exploreAll() finds. Without a time limit
/// equal input gives equal output.
PlaceAssignment solveExact(const MatchProblem& problem, const SolverParams& params);

}  // namespace hyselam_topo
