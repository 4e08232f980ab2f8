// Confidence of a match: the expected number of such matches by chance, and the probability that it
// is correct. The thesis leaves both open (4.4, 7) and has only a minimum number of words.
#pragma once

#include <cstdint>
#include <unordered_map>

#include "ngram_slam/matching/alignment.hpp"
#include "ngram_slam/matching/ngram_matcher.hpp"
#include "ngram_slam/words/language_model.hpp"

namespace ngram_slam {

/// Logistic regression: log odds = bias - by_chance * ln(chance) + by_misfit * ln(misfit +
/// misfit_floor). Fitted to the matches of 3 words and more on the simulated building B of 4.3.1,
/// kernels of 2.5 m and 4 m, where the true poses are known.
struct MatchConfidenceParams {
  double bias = -8.97;
  double by_chance = 0.209;
  double by_misfit = -1.79;
  double misfit_floor = 0.003;
  int max_words = 64;  ///< the newest words of a match that are used, >= 1

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError
  void validate() const;
};

/// Estimates chance and probability of the matches of a text, which is processed incrementally.
///
/// Chance: the expected number of old n-grams that match the newer words although they are others:
/// the words of the text times the product of the probabilities of each further match, by the
/// bigram model of the text so far. A corridor of a common length is weak evidence, a rare
/// sequence of rooms strong evidence. Misfit: root of the mean squared difference of the densities
/// of the matched words, aligned (Eq. 5.3).
class MatchConfidence {
 public:
  /// `text` and `observations` must outlive it; `density`: the one that words are made of.
  MatchConfidence(const WordLattice& text, const ObservationStore& observations,
                  const WordTolerance& tolerance, WordDensity density,
                  const MatchConfidenceParams& params = {});

  /// Updates the statistics with the word at this position; positions are added in order.
  void learn(Position p);
  /// Sets the chance of a match and, if asked for, its probability.
  void estimate(NgramMatch& match, bool with_probability);

  const LanguageModel& model() const { return model_; }
  std::size_t bytes() const;

 private:
  struct Misfit {
    float squares = 0.0f;  // sum
    float terms = 0.0f;
  };
  double chanceOf(const std::vector<WordPair>& chain, Direction direction);
  double misfitOf(const std::vector<WordPair>& chain, Direction direction);

  const WordLattice& text_;
  const ObservationStore& observations_;
  WordTolerance tolerance_;
  MatchConfidenceParams params_;
  AlignmentParams alignment_;
  LanguageModel model_;
  // Caches: successive matches share most of their words.
  std::unordered_map<std::uint64_t, double> chances_;  // of a newer word after another one
  std::unordered_map<std::uint64_t, Misfit> misfits_;  // of a pair of words
};

}  // namespace ngram_slam
