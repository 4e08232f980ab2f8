// Places over time: the low-pass filter (6.4.1), the Markov chain (6.4.3), and a Bayes filter.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "selovis/place_graph.hpp"

namespace selovis {

enum class FilterKind {
  kNone,
  kLowPass,
  kMarkov,
  kBayes,
  kPoses  ///< PoseFilter: of a Recogniser, not of a PlaceFilter
};

/// "none", "lowpass", "markov", "bayes", "poses"; throws std::invalid_argument.
FilterKind filterKind(const std::string& name);

struct PlaceFilterParams {
  FilterKind kind = FilterKind::kMarkov;
  double alpha = 2.0;      ///< Eq. 6.15, 0 or more
  double rho1 = 0.5;       ///< Eq. 6.23, above 0
  double rho2 = 1.0;       ///< Eq. 6.23, 0 or more
  double stay_min = 0.05;  ///< least probability of staying, Eq. 6.24, 0 to 1
  double stay = 0.93;      ///< Bayes: probability of staying from one frame to the next, 0 to 1
  double trust = 0.5;  ///< Bayes: exponent of the classifier's probabilities: frames that follow
                       ///< each other are no independent witnesses; above 0
  double leak = 1e-4;  ///< Bayes: probability of being carried anywhere, 0 to 1
  double unknown_below = 0.0;  ///< the place is unknown if the likeliest has less; 0: never
  double transition_min =
      0.25;  ///< both of two joined places are named from this probability on (6.4.4)
};

/// Throws hyselam::ParameterError.
void validate(const PlaceFilterParams& params);

struct PlaceEstimate {
  int place = -1;   ///< class of the likeliest place; -1: unknown
  int second = -1;  ///< the other place of a transition; -1: no transition
  double probability = 0.0;
};

/// The likeliest place of a distribution, with a transition's other place.
PlaceEstimate estimateOf(const std::vector<double>& probabilities, const PlaceGraph& graph,
                         const PlaceFilterParams& params);

/// Keeps a probability per place, always a distribution.
class PlaceFilter {
 public:
  PlaceFilter(const PlaceGraph& graph, const PlaceFilterParams& params);

  /// Takes the classifier's probabilities of one frame (one per place, finite, not negative; throws
  /// std::invalid_argument).
  void update(const double* probabilities);
  void update(const std::vector<double>& probabilities);
  /// A frame that tells nothing (6.4.4): the low-pass filter and the chain stand still.
  void skip() {}
  /// Back to knowing nothing.
  void reset();

  const std::vector<double>& probabilities() const { return state_; }
  PlaceEstimate estimate() const { return estimateOf(state_, graph_, params_); }

  /// Transition probabilities p_k(to, from) of the last update of the chain, row `to`.
  const std::vector<double>& transition() const { return transition_; }

 private:
  void markov(const double* observed);
  void bayes(const double* observed);

  PlaceGraph graph_;
  PlaceFilterParams params_;
  PlaceDistances paths_;
  std::vector<double> influence_;  // (rho1 / d)^rho2
  std::vector<double> transition_, state_, next_;
  bool fresh_ = true;
};

}  // namespace selovis
