// Place recognition: all n-grams of earlier words that match the latest words (Maffei 2017, 4.2.3,
// 5.2.3, Alg. 5.3; differences from the thesis: docs/algorithms/words.md). The word sequence is
// processed incrementally, one new word at a time.
//
// Terms:
// - Word: a segment of the path with one class of free-space density (share of the cells around the
//   robot that are free and connected with it), <d, s, a> (Syllables): class d, size s in
//   observations (by default one per 0.1 m of path), angle a by which the path turns within it.
// - Run: one uninterrupted drive; words of different runs are not neighbors.
// - Text (WordLattice): the words of all runs, in the order of the path. Real words have level 0;
//   an alternative word of level l >= 1 replaces l + 2 successive real words by one, as if the
//   interruption of a region had not been there (Alg. 5.2).
// - Position: number of a real word; an alternative word covers several positions.
//   WordIndex: number of any word, real or alternative.
// - n-gram ("gram" for short): n successive words of a run. The newer n-gram of a match ends at the
//   latest words, the older one is an earlier n-gram that it matches word by word.
// - Index (GramIndex): finds older n-grams of index_gram_ words; from there on they are extended
//   word by word.
// - Pass: a search with the words of levels below k; k = 1: real words only.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "ngram_slam/matching/ngram_search.hpp"
#include "ngram_slam/matching/position_set.hpp"
#include "ngram_slam/words/block_vector.hpp"

namespace ngram_slam {

/// For every new real word, returns the earlier n-grams whose ending matches the latest words; the
/// interface is that of NgramSearch: update() after each word that `text` got.
///
/// A pair of words belongs to a match if they match by the tolerances, the older one ends before
/// the newer one begins, and some pair of their predecessors belongs to it too, or it is the first
/// pair. A match is maximal when no pair of predecessors matches. Pass k uses words of the levels
/// below k and needs min_n[k - 1] words; a pair that more than one pass accepts is returned with
/// the lowest.
///
/// Only n-grams of at least `index_gram` words are extended: each costs a few comparisons per word.
/// An n-gram that reaches this length is found in an index. Hence the cost of a word depends on the
/// number of n-grams that are extended, not on the length of the text, and `max_followed` bounds
/// it: where the same few words recur more often than that, only the most recent occurrences are
/// kept. Below this bound the search is exact.
class NgramMatcher : public NgramSearch {
 public:
  /// `text` must outlive the matcher. @throws hyselam::ParameterError
  explicit NgramMatcher(const WordLattice& text, const NgramMatcherParams& params = {});

  /// Memory in use, without the text [bytes].
  std::size_t bytes() const;

 private:
  /// Packed word data needed to extend an n-gram: 16 contiguous bytes, because each new word is
  /// compared with up to thousands of them.
  struct PackedWord {
    float angle;               // Syllables::angle [rad]
    std::uint32_t attributes;  // bits 31..24: density class; 23..4: size [observations];
                               // 3..0: flags below (real word) or level (alternative word)
    WordIndex word;
    // Linked list of the alternative words that begin at the same position: index of the next one
    // in alternatives_, 0: end of the list. The list starts at the real word of the position.
    std::uint32_t next_alternative;
    static constexpr std::uint32_t kStartsRun = 1;        // flag: first word of its run
    static constexpr std::uint32_t kAlternativesEnd = 2;  // flag: alternative words end here too
  };
  /// Which words match a given word, by wordsMatch().
  struct MatchBounds {
    std::uint32_t density_class;
    std::uint32_t min_size, size_span;  // sizes min_size .. min_size + size_span [observations]
    float angle;                        // of the given word [rad]; tolerance: params_.tolerance
  };
  /// Part of a dynamic-programming row: for one end position of the newer n-gram and each end
  /// position of an older one, the length of the longest matching n-gram per pass [words]. Two
  /// vectors, because `ends` is read far more often.
  struct GramList {
    std::vector<Position> ends;          // last positions of the older n-grams, ascending
    std::vector<std::uint16_t> lengths;  // passes_ values for each entry of `ends`
    void clear() {
      ends.clear();
      lengths.clear();
    }
    void add(Position end, const std::uint16_t* first, std::size_t passes) {
      ends.push_back(end);
      for (std::size_t k = 0; k < passes; ++k) lengths.push_back(first[k]);
    }
    void reverse(std::size_t passes);
  };
  /// Dynamic-programming row: the matching n-grams whose newer words end at one position. Only
  /// n-grams of at least index_gram_ words in the last pass (all levels in use).
  struct GramRow {
    GramList grams;
    PositionSet ends;  // the positions in grams.ends, as a set
  };
  /// Candidate for extending an n-gram of an earlier row by one older word.
  struct Continuation {
    std::uint32_t gram;  // index in the earlier row
    std::uint32_t word;  // real word: its WordIndex; alternative: index in alternatives_
  };

  GramRow& rowOf(Position p) { return rows_[p % rows_.size()]; }
  void addPosition(Position p, bool searching) override;
  /// Adds the alternative words that end at `end`. Without `searching` (NgramSearch::skip()) words
  /// are only stored and indexed.
  void addAlternatives(Position end, bool searching);
  /// Finds the older n-grams for the newer word `newer` and merges them into `row`. With `report`,
  /// those that are long enough are appended to matches_.
  void findGrams(WordIndex newer, GramRow& row, bool report);
  void continueGrams(WordIndex newer, bool report);
  /// Extend n-grams of the earlier row `before` by the first `count` entries of continued_ or of
  /// with_alternatives_.
  void continueWithRealWords(WordIndex newer, const GramList& before, std::size_t count,
                             bool report);
  void continueWithAlternatives(WordIndex newer, const MatchBounds& bounds, const GramList& before,
                                std::size_t count, bool report);
  void startNewGrams(WordIndex newer, bool report);
  /// Corrects lengths in `row` of passes whose n-grams are shorter than index_gram_ (see
  /// NgramSearch::incompletePasses()), by recomputing them word by word.
  void completeLengths(Position newer_end, GramRow& row);
  void mergeGrams(GramRow& row, GramList& more);
  void dropOldestGrams(GramRow& row);  // enforces max_followed
  PackedWord packWord(WordIndex word, std::uint32_t flags) const;
  MatchBounds boundsOf(const Syllables& s) const;
  bool isWithin(const MatchBounds& bounds, const PackedWord& word) const {
    // All three are evaluated and joined without branches: none of them alone is decided often
    // enough for the branch to be predictable, and a mispredicted one costs more than the other
    // two comparisons.
    const bool same_class = word.attributes >> 24 == bounds.density_class;
    // Unsigned: a smaller size wraps to a large number.
    const bool same_size =
        (word.attributes >> 4 & WordLattice::kMaxSize) - bounds.min_size <= bounds.size_span;
    const double difference =
        std::abs(static_cast<double>(bounds.angle) - static_cast<double>(word.angle));
    const bool same_angle = (difference < params_.tolerance.angle) |
                            (difference > 2.0 * hyselam::kPi - params_.tolerance.angle);
    return same_class & same_size & same_angle;
  }

  BlockVector<PackedWord> real_words_;    // by position
  BlockVector<PackedWord> alternatives_;  // alternative words; index 0: null
  PositionSet run_starts_;                // first position of each run
  std::vector<GramRow> rows_;             // ring buffer: rows of the latest positions
  // N-grams found for the word being added: [l] extended by an older word of level l, back():
  // n-grams new from the index.
  std::vector<GramList> found_;
  GramList merged_;                      // buffer of mergeGrams()
  std::vector<Continuation> continued_;  // buffers of continueGrams(): the real word matches, ...
  std::vector<Continuation> with_alternatives_;  // ... alternative words are yet to be compared
};

}  // namespace ngram_slam
