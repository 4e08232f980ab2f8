// Place recognition when the robot drives along an earlier path in the opposite direction: n-grams
// of earlier words that, in reverse order and with every turn negated, match the latest words. The
// thesis lists this as missing (Maffei 2017, 5.5, 7). Terms: ngram_matcher.hpp.
#pragma once

#include <cstdint>
#include <vector>

#include "ngram_slam/matching/ngram_search.hpp"
#include "ngram_slam/matching/position_set.hpp"

namespace ngram_slam {

/// For every new real word, returns the earlier n-grams that match the latest words in reverse
/// order.
///
/// A pair of words belongs to a match if the newer one matches the reversed older one by the
/// tolerances, the older one ends before the newer one begins, and some pair of a predecessor of
/// the newer with a successor of the older belongs to it too, or it is the first pair. Passes,
/// smallest lengths and the bound max_followed are those of NgramMatcher. The first words of a
/// match are found in an index; then it is extended word by word. Matches have direction kReverse.
class ReverseNgramMatcher : public NgramSearch {
 public:
  /// `text` must outlive the matcher. @throws hyselam::ParameterError
  explicit ReverseNgramMatcher(const WordLattice& text, const NgramMatcherParams& params = {});

  std::size_t bytes() const;

 private:
  /// Entry of a dynamic-programming row: length of the longest matching n-gram per pass, for one
  /// end position of the newer n-gram and one begin position of the older one.
  struct Gram {
    Position begin = 0;  // first position of the older n-gram
    Lengths lengths{};   // [words]
  };
  /// Dynamic-programming row: the matching n-grams whose newer words end at one position.
  struct GramRow {
    std::vector<Gram> grams;  // ascending by `begin`
    PositionSet begins;       // the positions Gram::begin in `grams`, as a set
  };

  GramRow& rowOf(Position p) { return rows_[p % rows_.size()]; }
  void addPosition(Position p, bool searching) override;
  /// Finds the older n-grams for the newer word `newer` and merges them into `row`. With `report`,
  /// those that are long enough are appended to matches_.
  void findGrams(WordIndex newer, GramRow& row, bool report);
  void continueGrams(WordIndex newer, bool report);
  void startNewGrams(WordIndex newer, bool report);
  /// Corrects lengths in `row` of passes whose n-grams are shorter than index_gram_ (see
  /// NgramSearch::incompletePasses()), by recomputing them word by word.
  void completeLengths(Position newer_end, GramRow& row);
  void addGram(WordIndex newer, WordIndex older, const Lengths& lengths, bool report);
  void sortFound();
  void mergeFound(GramRow& row);
  void dropOldestGrams(GramRow& row);

  std::vector<GramRow> rows_;  // ring buffer: rows of the latest positions
  std::vector<Gram> found_;    // n-grams found for the word being added: first the extended ones
  std::vector<Gram> merged_;   // buffer of mergeFound()
  std::vector<Position> found_ends_;  // last positions of the words that extended n-grams
  std::size_t started_from_ = 0;      // index in found_ of the first n-gram new from the index
};

}  // namespace ngram_slam
