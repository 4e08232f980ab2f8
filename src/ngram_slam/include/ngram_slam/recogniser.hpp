// Everything together: observations in, words and matches out, while the classes are being learnt.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "ngram_slam/corpus.hpp"
#include "ngram_slam/match_judge.hpp"
#include "ngram_slam/matcher.hpp"
#include "ngram_slam/regions.hpp"
#include "ngram_slam/reverse_matcher.hpp"

namespace ngram_slam {

struct RecogniserParams {
  int levels = 3;           ///< levels of words, 1..16
  int min_region = 5;       ///< t_o of Alg. 4.2 [observations], >= 1
  int uniform_classes = 8;  ///< with `learn_classes` false: classes of equal width (5.3.1), 1..256
  bool learn_classes = false;  ///< classes by mean shift instead
  MeanShiftParams mean_shift;
  MatcherParams matcher;  ///< as many min_n as levels

  // Beyond the thesis.
  WordDensity word_density = WordDensity::kSoft;  ///< (a), (b): words of which density
  bool reverse = false;  ///< (a): also look for places that were travelled the other way
  /// (b): a density keeps the class of the one before while it lies within this of its bounds; 0:
  /// classes as they are. [0, 0.5)
  double class_hysteresis = 0.0;
  /// (c): a match is told if fewer than this many of its kind are expected by chance, whatever its
  /// length (matcher.min_n should then be small); 0: matcher.min_n alone decides.
  double max_chance = 0.0;
  bool with_probability = false;  ///< (d): tell Match::probability
  double min_probability = 0.0;   ///< (d): tell only matches at least this probable, [0, 1]
  JudgeParams judge;              ///< (c), (d)

  /// Matches get a chance and a probability.
  bool judges() const { return max_chance > 0.0 || with_probability || min_probability > 0.0; }

  /// The same with (a), (b) and (d) on and matches of 3 words and more told by their probability:
  /// what is best in all buildings tried. Observations need a look back (see
  /// ObservationSensorParams) of half a metre more than the kernel's radius.
  static RecogniserParams improved();

  /// @throws hyselam::ParameterError
  void validate() const;
};

/// What one observation brought about.
struct RecogniserUpdate {
  bool word = false;           ///< a word was completed: the last position of the text
  bool requantised = false;    ///< the classes changed: all words and matches before are void
  std::vector<Match> matches;  ///< of the new word; after a requantisation of all words
};

/// Keeps the observations of all runs, their words and the index.
class Recogniser {
 public:
  explicit Recogniser(const RecogniserParams& params = {});
  /// Goes on with a corpus: its runs are old ones, the next observation starts a new one. Words are
  /// built with the corpus' classes if classes are learnt, else with the uniform ones of `params`.
  /// @throws hyselam::ParameterError
  Recogniser(const RecogniserParams& params, Corpus corpus);
  Recogniser(const Recogniser&) = delete;
  Recogniser& operator=(const Recogniser&) = delete;

  /// Takes an observation in. @throws hyselam::InputError for one that cannot be used; nothing is
  /// changed then.
  RecogniserUpdate add(const Observation& observation);
  /// Ends the run: its last region becomes a word (4.3.2: an incomplete one). What comes next
  /// starts at an unknown place.
  RecogniserUpdate endRun();

  const RecogniserParams& params() const { return params_; }
  const ObservationStore& observations() const { return observations_; }
  const DensityClasses& classes() const {
    return params_.learn_classes ? quantizer_.classes() : fixed_classes_;
  }
  /// Of the densities, from which the classes are learnt; empty for fixed classes.
  Histogram histogram() const {
    return params_.learn_classes ? quantizer_.histogram() : Histogram{};
  }
  const Text& text() const { return *text_; }
  const MatcherCounters& counters() const { return matcher_->counters(); }
  /// How often the classes changed.
  int requantisations() const { return requantisations_; }
  std::size_t bytes() const;
  /// What to save.
  Corpus corpus() const;

 private:
  void startAnew();
  void startRun(std::uint32_t first_observation);
  std::vector<Match> rebuild(bool match_old_runs);
  std::vector<Match> newMatches();
  std::vector<Match> judge(std::vector<Match> matches);
  double densityOf(std::uint32_t i) const { return observations_.density(i, params_.word_density); }
  int classOf(std::uint32_t i);
  void write(const Region& region);

  RecogniserParams params_;
  ObservationStore observations_;
  DensityClasses fixed_classes_;
  MeanShiftQuantizer quantizer_;
  RegionBuilder regions_;
  std::unique_ptr<Text> text_;
  std::unique_ptr<Matcher> matcher_;
  std::unique_ptr<ReverseMatcher> reverse_matcher_;
  std::unique_ptr<MatchJudge> judge_;
  Position judged_ = 0;            // words before it are known to judge_
  std::optional<int> last_class_;  // of the observation before, in this run
  bool run_open_ = false;
  int requantisations_ = 0;
};

}  // namespace ngram_slam
