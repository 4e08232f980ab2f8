// How well an assignment of names to places fits (dos Santos, Eq. 5.2 to 5.8): f is the weighted
// mean of named vertices V (5.3), areas A (5.4), edges C (5.6) and orientations D (5.7, 5.8), and
// of terms that the thesis does not have, each active only if the description mentions it.
#pragma once

#include <vector>

#include "hyselam_common/parameters.hpp"
#include "hyselam_topo/topomerg/topomerg_problem.hpp"

namespace hyselam_topo {

/// What the side of a place is in the map.
enum class SideRule {
  /// The direction through its door, as people who pass it see it; of several doors the one that
  /// fits best. The described order counts on its own. A map without any doors goes by centers.
  kDoors,
  kCenters  ///< Eq. 5.7: the bearing of its center, spread in the described order
};

/// Weights of the fitness. Each is shared equally by what the description has of its kind; what it
/// does not mention at all drops out and the others are scaled to a sum of 1. So the weight of
/// relations has no effect where no relation is described.
struct FitnessParams {
  double vertices = 0.25;      ///< gamma_v: every name has a place
  double areas = 0.25;         ///< gamma_a: of the right size
  double edges = 0.25;         ///< gamma_e: connected as described
  double orientations = 0.25;  ///< gamma_d: on the described side
  SideRule sides = SideRule::kDoors;
  double orders = 0.25;     ///< "A, then B", only with doors
  double relations = 0.25;  ///< next to, opposite, between, at the end of, inside
  double parts = 0.25;      ///< "divided into six rooms"
  double kinds = 0.0;       ///< corridor or room; also guessed from names, so 0 unless wanted
  double evidence = 0.25;   ///< of objects and pictures
  /// C of two places that are connected in the map but not in the description, 0 .. 1: 0 counts it
  /// as an error of the description, 1 as something that people leave out.
  double undescribed_edge_credit = 0.0;
  /// Share of C and D, 0 .. 1, that remains where two places are described as connected and are not
  /// in the map, but share a wall: a door may have been closed when the robot passed. Only with
  /// doors (SideRule).
  double closed_door_credit = 0.3;

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError for a value out of range, and if the first four are all 0.
  void validate() const;
};

/// Name of each vertex, -1: none.
using Assignment = std::vector<int>;

/// f of Eq. 5.2, 0 .. 1. `heading`, if given, receives the robot's heading that it holds for [rad].
/// `assignment` has a value for each vertex; constraints are not checked.
double fitness(const MatchProblem& problem, const FitnessParams& params,
               const Assignment& assignment, double* heading = nullptr);

}  // namespace hyselam_topo
