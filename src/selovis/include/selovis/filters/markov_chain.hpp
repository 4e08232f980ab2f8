// The Markov chain over places (dos Santos 2014, 6.4.3 and 6.4.4, Eq. 6.16 to 6.25).
#pragma once

#include <vector>

#include "hyselam_common/parameters.hpp"
#include "selovis/places/place_transitions.hpp"

namespace selovis {

struct MarkovChainParams {
  double rho1 = 0.5;  ///< rho_1 of Eq. 6.23, 1e-6 to 1e6
  double rho2 = 1.0;  ///< rho_2 of Eq. 6.23, 0 to 100
  /// Lower bound of the probability of staying in a place (Eq. 6.24), 0 to 1.
  double min_stay_probability = 0.05;

  void describe(hyselam::ParameterVisitor& visit);
};

/// The states are the places, the transitions those of the topological map. The matrix changes with
/// each frame: a place that the classifier finds likely attracts probability from all others, along
/// the shortest paths.
class MarkovChain {
 public:
  /// @throws hyselam::ParameterError.
  MarkovChain(const PlaceTransitions& transitions, const MarkovChainParams& params);

  /// One step with the classifier's probabilities of a frame (Eq. 6.23 to 6.25): `state` becomes
  /// the distribution after it. `observed`: one value per place, not negative, of any positive sum.
  void step(const double* observed, std::vector<double>& state);

  /// p_k(to, from) of the last step, [to * n + from].
  const std::vector<double>& matrix() const { return matrix_; }

 private:
  void updateMatrix(const double* observed);

  MarkovChainParams params_;
  PlaceDistances paths_;
  std::vector<double> influence_;  // (rho1 / d)^rho2 of Eq. 6.23; 0 where there is no path
  std::vector<double> matrix_, next_;
};

}  // namespace selovis
