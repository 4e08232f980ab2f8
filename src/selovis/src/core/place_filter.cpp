#include "selovis/place_filter.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "hyselam_common/errors.hpp"

namespace selovis {
namespace {

void normalise(std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) sum += v;
  if (!(sum > 0.0)) {
    std::fill(values.begin(), values.end(), 1.0 / static_cast<double>(values.size()));
    return;
  }
  for (double& v : values) v /= sum;
}

void check(const char* name, double value, double low, double high, const char* allowed) {
  if (!(value >= low && value <= high)) throw hyselam::ParameterError(name, value, allowed);
}

}  // namespace

FilterKind filterKind(const std::string& name) {
  if (name == "none") return FilterKind::kNone;
  if (name == "lowpass") return FilterKind::kLowPass;
  if (name == "markov") return FilterKind::kMarkov;
  if (name == "bayes") return FilterKind::kBayes;
  if (name == "poses") return FilterKind::kPoses;
  throw std::invalid_argument("no filter is called '" + name +
                              "': there are none, lowpass, markov, bayes, poses");
}

void validate(const PlaceFilterParams& p) {
  check("alpha", p.alpha, 0.0, 1e6, "0 to 1e6");
  check("rho1", p.rho1, 1e-6, 1e6, "1e-6 to 1e6");
  check("rho2", p.rho2, 0.0, 100.0, "0 to 100");
  check("stay_min", p.stay_min, 0.0, 1.0, "0 to 1");
  check("stay", p.stay, 0.0, 1.0, "0 to 1");
  check("trust", p.trust, 1e-3, 10.0, "0.001 to 10");
  check("leak", p.leak, 0.0, 1.0, "0 to 1");
  check("unknown_below", p.unknown_below, 0.0, 1.0, "0 to 1");
  check("transition_min", p.transition_min, 0.0, 1.0, "0 to 1");
}

PlaceFilter::PlaceFilter(const PlaceGraph& graph, const PlaceFilterParams& params)
    : graph_(graph), params_(params), paths_(shortestPaths(graph)) {
  validate(params);
  const std::size_t n = graph.places.size();
  if (n == 0) throw std::invalid_argument("a place filter needs at least one place");
  influence_.assign(n * n, 0.0);
  transition_.assign(n * n, 0.0);
  for (std::size_t k = 0; k < n * n; ++k) {
    // Places that no path joins have no influence on each other.
    if (paths_.distance[k] > 0) {
      influence_[k] = std::pow(params.rho1 / paths_.distance[k], params.rho2);
    }
  }
  next_.resize(n);
  reset();
}

void PlaceFilter::reset() {
  state_.assign(graph_.places.size(), 1.0 / static_cast<double>(graph_.places.size()));
  fresh_ = true;
}

void PlaceFilter::update(const std::vector<double>& probabilities) {
  if (probabilities.size() != state_.size()) {
    throw std::invalid_argument("there are " + std::to_string(state_.size()) + " places, but " +
                                std::to_string(probabilities.size()) + " probabilities");
  }
  update(probabilities.data());
}

void PlaceFilter::update(const double* observed) {
  const std::size_t n = state_.size();
  double sum = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    if (!(observed[i] >= 0.0) || !std::isfinite(observed[i])) {
      throw std::invalid_argument("a probability is negative or no number");
    }
    sum += observed[i];
  }
  if (!(sum > 0.0)) return;  // tells nothing
  switch (params_.kind) {
    case FilterKind::kNone:
      std::copy(observed, observed + n, state_.begin());
      normalise(state_);
      break;
    case FilterKind::kLowPass:  // Eq. 6.15; there is no past at the first frame
      for (std::size_t i = 0; i < n; ++i) {
        state_[i] = observed[i] / sum + (fresh_ ? 0.0 : params_.alpha * state_[i]);
      }
      normalise(state_);
      break;
    case FilterKind::kMarkov:
      markov(observed);
      break;
    case FilterKind::kBayes:
    case FilterKind::kPoses:
      bayes(observed);
      break;
  }
  fresh_ = false;
}

void PlaceFilter::markov(const double* observed) {
  const std::size_t n = state_.size();
  double sum = 0.0;
  for (std::size_t i = 0; i < n; ++i) sum += observed[i];
  const double largest = *std::max_element(observed, observed + n) / sum;
  std::fill(transition_.begin(), transition_.end(), 0.0);
  // Eq. 6.23: what the classifier says of place i draws from place j to its neighbour on the way to
  // i.
  for (std::size_t j = 0; j < n; ++j) {
    double leaving = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      if (i == j || influence_[i * n + j] == 0.0) continue;
      const double p = influence_[i * n + j] * observed[i] / sum * largest;
      transition_[static_cast<std::size_t>(paths_.first_step[i * n + j]) * n + j] += p;
      leaving += p;
    }
    const double most = 1.0 - params_.stay_min;
    if (leaving > most) {  // Eq. 6.20
      const double scale = most / leaving;
      for (std::size_t to = 0; to < n; ++to) transition_[to * n + j] *= scale;
      leaving = most;
    }
    transition_[j * n + j] = 1.0 - leaving;  // Eq. 6.24
  }
  for (std::size_t to = 0; to < n; ++to) {  // Eq. 6.25
    next_[to] = 0.0;
    for (std::size_t from = 0; from < n; ++from)
      next_[to] += transition_[to * n + from] * state_[from];
  }
  state_.swap(next_);
  normalise(state_);
}

void PlaceFilter::bayes(const double* observed) {
  const std::size_t n = state_.size();
  std::fill(next_.begin(), next_.end(), 0.0);
  for (std::size_t from = 0; from < n; ++from) {
    std::size_t neighbours = 0;
    for (std::size_t to = 0; to < n; ++to) neighbours += paths_.distance[to * n + from] == 1;
    const double leave =
        neighbours > 0 ? (1.0 - params_.stay) / static_cast<double>(neighbours) : 0.0;
    for (std::size_t to = 0; to < n; ++to) {
      const double p = to == from                            ? (neighbours > 0 ? params_.stay : 1.0)
                       : paths_.distance[to * n + from] == 1 ? leave
                                                             : 0.0;
      next_[to] += p * state_[from];
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    const double predicted =
        (1.0 - params_.leak) * next_[i] + params_.leak / static_cast<double>(n);
    state_[i] = predicted * std::pow(std::max(observed[i], 1e-6), params_.trust);
  }
  normalise(state_);
}

PlaceEstimate estimateOf(const std::vector<double>& state, const PlaceGraph& graph,
                         const PlaceFilterParams& params) {
  PlaceEstimate result;
  const auto best = std::max_element(state.begin(), state.end());
  result.probability = *best;
  const int place = static_cast<int>(best - state.begin());
  if (*best < params.unknown_below) return result;
  result.place = place;
  int second = -1;
  for (int i = 0; i < static_cast<int>(state.size()); ++i) {
    if (i != place && (second < 0 || state[i] > state[second])) second = i;
  }
  if (second >= 0 && *best > params.transition_min && state[second] > params.transition_min &&
      graph.connected(place, second)) {
    result.second = second;
  }
  return result;
}

}  // namespace selovis
