#include "selovis/filters/place_filter.hpp"

#include <algorithm>
#include <cmath>

#include "distribution.hpp"
#include "hyselam_common/errors.hpp"

namespace selovis {
namespace {

constexpr double kMinLikelihood = 1e-6;  // of the Bayes filter: no frame rules a place out

constexpr PlaceFilterKind kKinds[] = {PlaceFilterKind::kNone,   PlaceFilterKind::kLowPass,
                                      PlaceFilterKind::kMarkov, PlaceFilterKind::kBayes,
                                      PlaceFilterKind::kPoses,  PlaceFilterKind::kAuto};

}  // namespace

const char* toString(PlaceFilterKind kind) {
  switch (kind) {
    case PlaceFilterKind::kNone:
      return "none";
    case PlaceFilterKind::kLowPass:
      return "lowpass";
    case PlaceFilterKind::kMarkov:
      return "markov";
    case PlaceFilterKind::kBayes:
      return "bayes";
    case PlaceFilterKind::kPoses:
      return "poses";
    case PlaceFilterKind::kAuto:
      break;
  }
  return "auto";
}

PlaceFilterKind placeFilterKindFromString(const std::string& name) {
  for (const PlaceFilterKind kind : kKinds) {
    if (name == toString(kind)) return kind;
  }
  throw hyselam::InputError("filter '" + name + "'", "",
                            "is not known: there are auto, none, lowpass, markov, bayes, poses");
}

void BayesFilterParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("stay_probability", stay_probability, Range::between(0.0, 1.0), "",
        "of staying in a place from one frame to the next");
  visit("likelihood_exponent", likelihood_exponent, Range::between(1e-3, 10.0), "",
        "of a frame's likelihoods: consecutive frames are not independent");
  visit("teleport_probability", teleport_probability, Range::between(0.0, 1.0), "",
        "per frame, of being carried to any place");
}

void PlaceFilterParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("filter", kind,
        {{"auto", PlaceFilterKind::kAuto},
         {"none", PlaceFilterKind::kNone},
         {"lowpass", PlaceFilterKind::kLowPass},
         {"markov", PlaceFilterKind::kMarkov},
         {"bayes", PlaceFilterKind::kBayes},
         {"poses", PlaceFilterKind::kPoses}},
        "filter of the place over time; auto: poses for a frame with odometry, bayes for one "
        "without");
  visit("low_pass_alpha", low_pass_alpha, Range::between(0.0, 1e6), "",
        "weight of the past in the low-pass filter (Eq. 6.15)");
  visit.group("markov_", markov);
  visit.group("bayes_", bayes);
  visit("min_place_probability", min_place_probability, Range::between(0.0, 1.0), "",
        "of the most likely place, below which the place is unknown; 0: never");
  visit("min_transition_probability", min_transition_probability, Range::between(0.0, 1.0), "",
        "of both of two connected places, above which they are reported as a transition");
}

void PlaceFilterParams::validate() const {
  hyselam::checkParameters(*this);
}

PlaceFilter::PlaceFilter(const PlaceTransitions& transitions, const PlaceFilterParams& params)
    : transitions_(transitions),
      params_(params),
      paths_(shortestPaths(transitions)),
      markov_(transitions, params.markov),
      next_(transitions.places.size()) {
  params.validate();
  if (transitions.places.empty()) {
    throw hyselam::InputError("place filter", "", "needs at least one place");
  }
  reset();
}

void PlaceFilter::reset() {
  const std::size_t n = transitions_.places.size();
  state_.assign(n, 1.0 / static_cast<double>(n));
  first_ = true;
}

void PlaceFilter::update(const std::vector<double>& probabilities) {
  if (probabilities.size() != state_.size()) {
    throw hyselam::InputError("frame", "",
                              "has " + std::to_string(probabilities.size()) +
                                  " probabilities, but there are " + std::to_string(state_.size()) +
                                  " places");
  }
  update(probabilities.data());
}

void PlaceFilter::update(const double* observed) {
  const std::size_t n = state_.size();
  double sum = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    if (!(observed[i] >= 0.0) || !std::isfinite(observed[i])) {
      throw hyselam::InputError("frame", "", "has a probability that is negative or not finite");
    }
    sum += observed[i];
  }
  if (!(sum > 0.0)) return;
  switch (params_.kind) {
    case PlaceFilterKind::kNone:
      std::copy(observed, observed + n, state_.begin());
      normalizeDistribution(state_);
      break;
    case PlaceFilterKind::kLowPass:  // Eq. 6.15; there is no past at the first frame
      for (std::size_t i = 0; i < n; ++i) {
        state_[i] = observed[i] / sum + (first_ ? 0.0 : params_.low_pass_alpha * state_[i]);
      }
      normalizeDistribution(state_);
      break;
    case PlaceFilterKind::kMarkov:
      markov_.step(observed, state_);
      break;
    case PlaceFilterKind::kBayes:
    case PlaceFilterKind::kAuto:
    case PlaceFilterKind::kPoses:
      updateBayes(observed);
      break;
  }
  first_ = false;
}

void PlaceFilter::updateBayes(const double* observed) {
  const std::size_t n = state_.size();
  // Prediction: the robot stays, or walks to one of the neighbors, all equally likely.
  std::fill(next_.begin(), next_.end(), 0.0);
  for (std::size_t from = 0; from < n; ++from) {
    std::size_t neighbors = 0;
    for (std::size_t to = 0; to < n; ++to) neighbors += paths_.distanceBetween(to, from) == 1;
    const double leave =
        neighbors > 0 ? (1.0 - params_.bayes.stay_probability) / static_cast<double>(neighbors)
                      : 0.0;
    for (std::size_t to = 0; to < n; ++to) {
      const double p = to == from ? (neighbors > 0 ? params_.bayes.stay_probability : 1.0)
                       : paths_.distanceBetween(to, from) == 1 ? leave
                                                               : 0.0;
      next_[to] += p * state_[from];
    }
  }
  // Correction by the frame, flattened because consecutive frames are not independent.
  for (std::size_t i = 0; i < n; ++i) {
    const double predicted = (1.0 - params_.bayes.teleport_probability) * next_[i] +
                             params_.bayes.teleport_probability / static_cast<double>(n);
    state_[i] = predicted *
                std::pow(std::max(observed[i], kMinLikelihood), params_.bayes.likelihood_exponent);
  }
  normalizeDistribution(state_);
}

PlaceEstimate mostLikelyPlace(const std::vector<double>& state, const PlaceTransitions& transitions,
                              const PlaceFilterParams& params) {
  PlaceEstimate result;
  const auto best = std::max_element(state.begin(), state.end());
  result.probability = *best;
  const int place = static_cast<int>(best - state.begin());
  if (*best < params.min_place_probability) return result;
  result.place = place;
  int second = -1;
  for (int i = 0; i < static_cast<int>(state.size()); ++i) {
    if (i != place && (second < 0 || state[i] > state[second])) second = i;
  }
  const double least = params.min_transition_probability;
  if (second >= 0 && *best > least && state[second] > least &&
      transitions.connected(place, second)) {
    result.second = second;
  }
  return result;
}

}  // namespace selovis
