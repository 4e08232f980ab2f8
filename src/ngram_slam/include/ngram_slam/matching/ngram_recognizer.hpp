// The whole recognition: observations in, words and matches out, while classes are being learned.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "ngram_slam/matching/match_confidence.hpp"
#include "ngram_slam/matching/ngram_matcher.hpp"
#include "ngram_slam/matching/reverse_ngram_matcher.hpp"
#include "ngram_slam/words/corpus.hpp"
#include "ngram_slam/words/density_regions.hpp"

namespace ngram_slam {

struct NgramRecognizerParams {
  int levels = 3;           ///< levels of words, 1..16
  int min_region = 5;       ///< t_o of Alg. 4.2 [observations], >= 1
  int uniform_classes = 8;  ///< with `learn_classes` false: classes of equal width (5.3.1), 1..256
  bool learn_classes = false;  ///< classes by mean shift instead
  MeanShiftParams mean_shift;
  NgramMatcherParams matcher;  ///< as many min_n as levels

  // Beyond the thesis.
  WordDensity word_density = WordDensity::kSoft;  ///< (a), (b): words of which density
  bool reverse = false;  ///< (a): also places travelled in the reverse direction
  /// (b): a density keeps the class of the one before while it lies within this of its bounds; 0:
  /// classes as they are. [0, 0.5)
  double class_hysteresis = 0.0;
  /// (c): a match is accepted if fewer than this many like it are expected by chance, whatever its
  /// length (matcher.min_n should then be small); 0: matcher.min_n alone decides.
  double max_chance = 0.0;
  bool with_probability = false;     ///< (d): set NgramMatch::probability
  double min_probability = 0.0;      ///< (d): of a match that is accepted, [0, 1]
  MatchConfidenceParams confidence;  ///< (c), (d)

  /// Whether matches get a chance and a probability.
  bool needsConfidence() const {
    return max_chance > 0.0 || with_probability || min_probability > 0.0;
  }

  /// The same with (a), (b) and (d) on and matches of 3 words and more accepted by their
  /// probability: the best in all buildings tried. Observations need a look_back (see
  /// ObservationSensorParams) of half a metre more than the kernel's radius.
  static NgramRecognizerParams improved();

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError
  void validate() const;

 private:
  static constexpr int kMinNStep = 3;  // words more of each further level
  void fitMinN();
};

/// The result of one observation.
struct NgramRecognizerUpdate {
  bool word = false;                ///< a word is complete: the last position of the text
  bool requantised = false;         ///< the classes changed: all words and matches before are void
  std::vector<NgramMatch> matches;  ///< of the new word; after a requantisation of all words
};

/// Keeps the observations of all runs, their words and the index.
class NgramRecognizer {
 public:
  explicit NgramRecognizer(const NgramRecognizerParams& params = {});
  /// Continues a corpus: the next observation starts a new run. Words are
  /// built with the corpus' classes if classes are learned, else with the uniform ones of `params`.
  /// @throws hyselam::ParameterError
  NgramRecognizer(const NgramRecognizerParams& params, Corpus corpus);
  NgramRecognizer(const NgramRecognizer&) = delete;
  NgramRecognizer& operator=(const NgramRecognizer&) = delete;

  /// Adds an observation. @throws hyselam::InputError for one that cannot be used; nothing is
  /// changed then.
  NgramRecognizerUpdate add(const DensityObservation& observation);
  /// Ends the run: its last region becomes a word (4.3.2: an incomplete one). The next
  /// observation starts a new run.
  NgramRecognizerUpdate endRun();

  const NgramRecognizerParams& params() const { return params_; }
  const ObservationStore& observations() const { return observations_; }
  const DensityClasses& classes() const {
    return params_.learn_classes ? quantizer_.classes() : fixed_classes_;
  }
  /// Histogram of the densities from which the classes are learned; empty for fixed classes.
  DensityHistogram histogram() const {
    return params_.learn_classes ? quantizer_.histogram() : DensityHistogram{};
  }
  const WordLattice& text() const { return *text_; }
  const NgramMatcherCounters& counters() const { return matcher_->counters(); }
  /// Number of changes of the classes; each rebuilds all words.
  int requantisations() const { return requantisations_; }
  std::size_t bytes() const;
  /// The data to be saved.
  Corpus corpus() const;

 private:
  void reset();
  void startRun(std::uint32_t first_observation);
  std::vector<NgramMatch> rebuild(bool match_old_runs);
  std::vector<NgramMatch> newMatches();
  std::vector<NgramMatch> withConfidence(std::vector<NgramMatch> matches);
  double densityOf(std::uint32_t i) const { return observations_.density(i, params_.word_density); }
  int classOf(std::uint32_t i);
  void write(const DensityRegion& region);

  NgramRecognizerParams params_;
  ObservationStore observations_;
  DensityClasses fixed_classes_;
  MeanShiftQuantizer quantizer_;
  DensityRegionBuilder regions_;
  std::unique_ptr<WordLattice> text_;
  std::unique_ptr<NgramMatcher> matcher_;
  std::unique_ptr<ReverseNgramMatcher> reverse_matcher_;
  std::unique_ptr<MatchConfidence> confidence_;
  Position learnt_ = 0;            // first position not yet added to confidence_
  std::optional<int> last_class_;  // of the observation before, in this run
  bool run_open_ = false;
  int requantisations_ = 0;
};

}  // namespace ngram_slam
