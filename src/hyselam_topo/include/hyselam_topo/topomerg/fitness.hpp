// Fitness function of TopoMerg, which merges the topological map of the robot with a person's
// description of the building (dos Santos 2014, 5.3, Eq. 5.2 to 5.8): how well an assignment of
// described names to places of the map fits. f is the weighted mean of named vertices V (5.3),
// areas A (5.4), edges C (5.6) and orientations D (5.7, 5.8), and of terms that the thesis does not
// have, each active only if the description mentions it. A name may stay without a place (a room
// that the robot has not seen yet) at a cost.
#pragma once

#include <vector>

#include "hyselam_common/parameters.hpp"
#include "hyselam_topo/topomerg/topomerg_problem.hpp"

namespace hyselam_topo {

/// How the side (left, right, front, back) on which a place lies is computed from the map.
enum class SideRule {
  /// The direction through the door to the place, as somebody passing the door sees it; of several
  /// doors the one that fits best. The described order of places on a side is a term of its own
  /// (FitnessParams::orders). A map without any doors is treated as kCenters.
  kDoors,
  /// Eq. 5.7: the bearing from the center of one place to that of the other. It is compared with an
  /// angle that depends on the described order: n places on one side are assumed pi / (2 n) apart,
  /// symmetric to the direction of the side (DescribedSide::angle).
  kCenters
};

/// What the weights of the terms mean.
enum class Weighting {
  /// Odds: the natural logarithm of how many times less likely an answer is for one statement that
  /// does not hold in it. f = 1 - sum of losses / sum of all that could be lost, so that a loss of
  /// 1 / PlaceAssignment::scale makes an answer e times less likely.
  kOdds,
  /// Eq. 5.2: each weight is divided equally among the statements of that type in the description.
  /// Types without a statement are left out and the other weights are scaled to a sum of 1: the
  /// only statement of its type weighs as much as all statements of another.
  kShares
};

/// Weights of the fitness terms, >= 0, with Weighting::kOdds of one statement [nat].
struct FitnessParams {
  Weighting weighting = Weighting::kOdds;
  /// gamma_v: a name stays without a place. With kOdds the logarithm of the odds that a described
  /// place is on the map at one place that fits as well as an unknown place would.
  double vertices = 0.3;
  double areas = 4.5;         ///< gamma_a: places have the described area
  double edges = 2.4;         ///< gamma_e: places are connected as described
  double orientations = 4.8;  ///< gamma_d: places are on the described side
  SideRule sides = SideRule::kDoors;
  double orders = 2.4;      ///< described order "A, then B" on a side; only with SideRule::kDoors
  double numbers = 2.0;     ///< "the second door on the left", "in ten metres"
  double relations = 2.0;   ///< next to, opposite, between, behind, larger, ..., and denied ones
  double parts = 1.5;       ///< described number of parts: "divided into six rooms"
  double doors = 1.5;       ///< described number of doors
  double size_words = 1.5;  ///< "a small room"
  double kinds = 0.0;  ///< corridor or room; off by default, since it may be guessed from the name
  /// Evidence that a place of the map has a name, from objects seen there and from image
  /// classification (MatchEvidence).
  double evidence = 3.0;
  /// Each further place of a name whose number of parts is not described; only with kOdds.
  double pieces = 1.0;
  /// Share of a statement's weight that is lost if one of its names stays without a place: nobody
  /// can tell whether it holds. 1: as if it did not hold (Eq. 5.2), 0: as if it did.
  double absent_share = 0.4;
  /// Value of C (Eq. 5.6) for two places that are connected in the map but not in the description,
  /// 0 .. 1. 0: counts as an error, 1: people are expected to leave connections out.
  double undescribed_edge_credit = 0.8;
  /// Factor of C and D, 0 .. 1, for two places that are described as connected and in the map only
  /// share a wall: its door may have been closed when the robot passed. Only with SideRule::kDoors.
  double closed_door_credit = 0.6;

  /// Eq. 5.2: all weights 0.25, Weighting::kShares, a name without a place loses all that was told
  /// of it, connections that nobody told of count as errors.
  static FitnessParams equation52();

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError for a value out of range, and if the first four are all 0.
  void validate() const;
};

/// For each vertex (place of the map): number of its name in the description, -1: none.
using Assignment = std::vector<int>;

/// f of Eq. 5.2, 0 .. 1. `heading`, if not null, receives the robot heading used for the
/// orientation term [rad, map frame]: the known one, else the one with the best score. `assignment`
/// has a value for each vertex; it is not checked against MatchConstraints, nor
/// whether the places of one name are connected in the map (SolverParams::connected).
double fitness(const MatchProblem& problem, const FitnessParams& params,
               const Assignment& assignment, double* heading = nullptr);

}  // namespace hyselam_topo
