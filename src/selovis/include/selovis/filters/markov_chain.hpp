// The Markov chain over places (dos Santos 2014, 6.4.3 and 6.4.4, Eq. 6.16 to 6.25).
#pragma once

#include <vector>

#include "hyselam_common/parameters.hpp"
#include "selovis/places/place_transitions.hpp"

namespace selovis {

struct MarkovChainParams {
  /// Eq. 6.23: the influence of a place on the transitions of a place at distance d, in edges of
  /// the topological map (d >= 1), is (rho1 / d)^rho2. rho1: strength (the influence at d = 1 is
  /// rho1^rho2), 1e-6 to 1e6.
  double rho1 = 0.5;
  double rho2 = 1.0;  ///< decay with the distance, see rho1, 0 to 100; 0: no decay
  /// Lower bound of the probability of staying in a place (Eq. 6.24), 0 to 1.
  double min_stay_probability = 0.05;

  void describe(hyselam::ParameterVisitor& visit);
};

/// The states are the places, the transitions those of the topological map. The matrix changes with
/// each image: a place that is likely according to the classifier increases the transition
/// probabilities towards it, from every place to the next one on a shortest path.
class MarkovChain {
 public:
  /// @throws hyselam::ParameterError.
  MarkovChain(const PlaceTransitions& transitions, const MarkovChainParams& params);

  /// Prediction step (Eq. 6.23 to 6.25): updates the matrix with the classifier's result for an
  /// image and replaces the distribution `state` by the predicted one. `observed`: class
  /// probabilities of the image, one per place, >= 0, may be unnormalized (sum > 0).
  void step(const double* observed, std::vector<double>& state);

  /// Transition matrix of the last step: probability of `to` after `from` at [to * n + from], with
  /// n places.
  const std::vector<double>& matrix() const { return matrix_; }

 private:
  void updateMatrix(const double* observed);

  MarkovChainParams params_;
  PlaceDistances paths_;           // shortest paths in the topological map
  std::vector<double> influence_;  // (rho1 / d)^rho2 of Eq. 6.23; 0 where there is no path
  std::vector<double> matrix_;
  std::vector<double> next_;  // buffer of step()
};

}  // namespace selovis
