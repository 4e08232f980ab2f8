// Matches of words against the truth about observations.
#pragma once

#include <memory>
#include <set>
#include <tuple>
#include <vector>

#include "ngram_slam/matching/alignment.hpp"
#include "ngram_slam/matching/ngram_recognizer.hpp"
#include "ngram_slam/matching/recognition_score.hpp"

namespace ngram_slam {

/// Counts the observations that the matches of a text identify as the same place.
///
/// The words of a match's longest n-gram (its last 64) are aligned by density, and every pair of
/// observations of two words that are paired counts once (RecognitionScore). A match itself is true
/// if most pairs of its last words are.
class MatchEvaluation {
 public:
  /// `recognizer` must outlive the evaluation, and its text must not change meanwhile.
  MatchEvaluation(const NgramRecognizer& recognizer, std::shared_ptr<const RecognitionTruth> truth);

  /// Order does not matter.
  void add(const NgramMatch& match);
  void add(const std::vector<NgramMatch>& matches) {
    for (const NgramMatch& m : matches) add(m);
  }

  const RecognitionScore& score() const { return score_; }
  std::size_t matches() const { return matches_; }
  double matchPrecision() const { return RecognitionFigures::share(true_matches_, matches_, 1.0); }

 private:
  const NgramRecognizer& recognizer_;
  RecognitionScore score_;
  AlignmentParams alignment_;
  std::size_t matches_ = 0, true_matches_ = 0;
  std::set<std::tuple<WordIndex, WordIndex, Direction>> done_;
};

}  // namespace ngram_slam
