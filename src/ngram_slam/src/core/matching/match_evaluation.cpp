#include "ngram_slam/matching/match_evaluation.hpp"

#include <utility>

#include "ngram_slam/matching/ngram.hpp"

namespace ngram_slam {
namespace {

constexpr std::size_t kMaxWords = 64;  // older ones were the end of a match before

}  // namespace

MatchEvaluation::MatchEvaluation(const NgramRecognizer& recognizer,
                                 std::shared_ptr<const RecognitionTruth> truth)
    : recognizer_(recognizer), score_(std::move(truth)) {
  alignment_.density = recognizer.params().word_density;
}

void MatchEvaluation::add(const NgramMatch& match) {
  const WordLattice& text = recognizer_.text();
  int right = 0, wrong = 0;
  for (const WordPair& words :
       longestNgram(text, recognizer_.params().matcher.tolerance, {match.newer, match.older},
                    match.levels, kMaxWords, match.direction)) {
    const bool last = words.newer == match.newer;
    if (!done_.insert({words.newer, words.older, match.direction}).second && !last) continue;
    for (const ObservationPair& pair : alignedObservations(
             text, recognizer_.observations(), {words}, 1, alignment_, match.direction)) {
      const std::optional<bool> verdict = score_.add(pair.newer, pair.older, match.direction);
      if (last && verdict) ++(*verdict ? right : wrong);
    }
  }
  if (right + wrong == 0) return;
  ++matches_;
  true_matches_ += right > wrong;
}

}  // namespace ngram_slam
