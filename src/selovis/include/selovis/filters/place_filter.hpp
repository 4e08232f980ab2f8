// Filters of the place over time: low-pass filter (dos Santos 2014, 6.4.1), Markov chain (6.4.3),
// and a Bayes filter.
#pragma once

#include <string>
#include <vector>

#include "selovis/filters/markov_chain.hpp"
#include "selovis/places/place_transitions.hpp"

namespace selovis {

enum class PlaceFilterKind {
  kNone,
  kLowPass,
  kMarkov,
  kBayes,
  kPoses,  ///< PoseFilter: for an ImageRecognizer, not for a PlaceFilter
  kAuto    ///< an ImageRecognizer's choice, frame by frame; a PlaceFilter takes kBayes
};

/// "none", "lowpass", "markov", "bayes", "poses", "auto".
const char* toString(PlaceFilterKind kind);
/// @throws hyselam::InputError for any other text.
PlaceFilterKind placeFilterKindFromString(const std::string& name);

struct BayesFilterParams {
  /// Of staying in a place from one frame to the next, 0 to 1.
  double stay_probability = 0.93;
  /// Exponent of a frame's likelihoods, below 1 because consecutive frames are not independent;
  /// 0.001 to 10.
  double likelihood_exponent = 0.75;
  /// Per frame, of being carried to any place, 0 to 1.
  double teleport_probability = 1e-4;

  void describe(hyselam::ParameterVisitor& visit);
};

struct PlaceFilterParams {
  PlaceFilterKind kind = PlaceFilterKind::kAuto;
  double low_pass_alpha = 2.0;  ///< weight of the past, alpha of Eq. 6.15, 0 to 1e6
  MarkovChainParams markov;
  BayesFilterParams bayes;
  /// The place is unknown if the most likely one has a lower probability; 0: never. 0 to 1.
  double min_place_probability = 0.0;
  /// Two connected places are reported as a transition if both have a higher probability (6.4.4), 0
  /// to 1.
  double min_transition_probability = 0.25;

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError.
  void validate() const;
};

struct PlaceEstimate {
  int place = -1;   ///< class of the most likely place; -1: unknown
  int second = -1;  ///< the other place of a transition; -1: no transition
  double probability = 0.0;
};

/// The most likely place of a distribution, with the other place of a transition.
PlaceEstimate mostLikelyPlace(const std::vector<double>& probabilities,
                              const PlaceTransitions& transitions, const PlaceFilterParams& params);

/// Keeps a probability distribution over the places.
class PlaceFilter {
 public:
  /// @throws hyselam::ParameterError; hyselam::InputError without places.
  PlaceFilter(const PlaceTransitions& transitions, const PlaceFilterParams& params);

  /// Adds the classifier's probabilities of one frame, one per place; all 0: the frame is ignored.
  /// @throws hyselam::InputError for values that are negative or not finite, or of another number.
  void update(const double* probabilities);
  void update(const std::vector<double>& probabilities);
  /// Resets to the uniform distribution.
  void reset();

  const std::vector<double>& probabilities() const { return state_; }
  PlaceEstimate estimate() const { return mostLikelyPlace(state_, transitions_, params_); }
  const MarkovChain& markovChain() const { return markov_; }

 private:
  void updateBayes(const double* observed);

  PlaceTransitions transitions_;
  PlaceFilterParams params_;
  PlaceDistances paths_;
  MarkovChain markov_;
  std::vector<double> state_, next_;
  bool first_ = true;
};

}  // namespace selovis
