#include "selovis/filters/markov_chain.hpp"

#include <algorithm>
#include <cmath>

#include "distribution.hpp"

namespace selovis {

void MarkovChainParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("rho1", rho1, Range::between(1e-6, 1e6), "", "rho_1 of Eq. 6.23");
  visit("rho2", rho2, Range::between(0.0, 100.0), "", "rho_2 of Eq. 6.23");
  visit("min_stay_probability", min_stay_probability, Range::between(0.0, 1.0), "",
        "of staying in a place, at least (Eq. 6.24)");
}

MarkovChain::MarkovChain(const PlaceTransitions& transitions, const MarkovChainParams& params)
    : params_(params), paths_(shortestPaths(transitions)), next_(transitions.places.size()) {
  hyselam::checkParameters(params);
  const std::size_t n = transitions.places.size();
  influence_.assign(n * n, 0.0);
  matrix_.assign(n * n, 0.0);
  for (std::size_t k = 0; k < n * n; ++k) {
    // Places without a path between them have no influence on each other.
    if (paths_.distance[k] > 0) {
      influence_[k] = std::pow(params.rho1 / paths_.distance[k], params.rho2);
    }
  }
}

void MarkovChain::updateMatrix(const double* observed) {
  const std::size_t n = next_.size();
  double sum = 0.0;
  for (std::size_t i = 0; i < n; ++i) sum += observed[i];
  const double largest = *std::max_element(observed, observed + n) / sum;
  std::fill(matrix_.begin(), matrix_.end(), 0.0);
  for (std::size_t j = 0; j < n; ++j) {
    // Eq. 6.23: the observed probability of place i moves probability from place j to the neighbor
    // of j on a shortest path to i.
    double leaving = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      if (i == j || influence_[i * n + j] == 0.0) continue;
      const double p = influence_[i * n + j] * observed[i] / sum * largest;
      matrix_[static_cast<std::size_t>(paths_.first_step[i * n + j]) * n + j] += p;
      leaving += p;
    }
    const double max_leaving = 1.0 - params_.min_stay_probability;
    if (leaving > max_leaving) {  // Eq. 6.20: each column sums to 1
      const double scale = max_leaving / leaving;
      for (std::size_t to = 0; to < n; ++to) matrix_[to * n + j] *= scale;
      leaving = max_leaving;
    }
    matrix_[j * n + j] = 1.0 - leaving;  // Eq. 6.24
  }
}

void MarkovChain::step(const double* observed, std::vector<double>& state) {
  updateMatrix(observed);
  const std::size_t n = next_.size();
  for (std::size_t to = 0; to < n; ++to) {  // Eq. 6.25
    next_[to] = 0.0;
    for (std::size_t from = 0; from < n; ++from) {
      next_[to] += matrix_[to * n + from] * state[from];
    }
  }
  state.swap(next_);
  normalizeDistribution(state);
}

}  // namespace selovis
