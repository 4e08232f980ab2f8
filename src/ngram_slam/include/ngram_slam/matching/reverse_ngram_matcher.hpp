// Place recognition in the reverse direction: n-grams of old words that, read backwards and with
// every turn reversed, match the words up to the newest one. The thesis names their absence as its
// drawback (5.5, 7).
#pragma once

#include <cstdint>
#include <vector>

#include "ngram_slam/matching/ngram_search.hpp"
#include "ngram_slam/matching/position_set.hpp"

namespace ngram_slam {

/// Reads a text like NgramMatcher and returns, for every new real word, which grams of old words
/// the text ends with when they are read backwards.
///
/// A pair of words belongs to a match if the newer one matches the reversed older one by the
/// tolerances, the older one ends before the newer one begins, and some pair of a predecessor of
/// the newer with a successor of the older belongs to it too, or it is the first pair. Passes,
/// smallest lengths and the bound on grams followed are those of NgramMatcher. An index of grams
/// finds where one begins; then its pairs are continued word by word. Matches have direction
/// kReverse.
class ReverseNgramMatcher : public NgramSearch {
 public:
  /// `text` must outlive the matcher. @throws hyselam::ParameterError
  explicit ReverseNgramMatcher(const WordLattice& text, const NgramMatcherParams& params = {});

  std::size_t bytes() const;

 private:
  /// How long the grams are whose newer words end at a position and whose older words begin at
  /// `begin`, for each pass.
  struct Gram {
    Position begin = 0;
    Lengths lengths{};
  };
  struct GramRow {
    std::vector<Gram> grams;  // ordered by `begin`
    PositionSet begins;       // of these
  };

  GramRow& rowOf(Position p) { return rows_[p % rows_.size()]; }
  void addPosition(Position p, bool searching) override;
  void findGrams(WordIndex newer, GramRow& row, bool report);
  void continueGrams(WordIndex newer, bool report);
  void startNewGrams(WordIndex newer, bool report);
  void completeLengths(Position newer_end, GramRow& row);
  void addGram(WordIndex newer, WordIndex older, const Lengths& lengths, bool report);
  void sortFound();
  void mergeFound(GramRow& row);
  void dropOldestGrams(GramRow& row);

  std::vector<GramRow> rows_;  // a ring over positions
  std::vector<Gram> found_, merged_;
  std::vector<Position> found_ends_;  // where the older words end that were continued
  std::size_t started_from_ = 0;      // in found_
};

}  // namespace ngram_slam
