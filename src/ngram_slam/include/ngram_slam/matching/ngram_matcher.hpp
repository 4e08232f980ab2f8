// Place recognition: all n-grams of old words that match the words up to the newest one (4.2.3,
// 5.2.3, Alg. 5.3 with its errata), found while the text grows.
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

/// Reads a text as it grows and returns, for every new real word, which grams of old words end like
/// the text.
///
/// A pair of words belongs to a match if they match by the tolerances, the older one ends before
/// the newer one begins, and some pair of their predecessors belongs to it too, or it is the first
/// pair. A match is maximal when no pair of predecessors matches. Pass k uses words of the levels
/// below k and needs min_n[k - 1] words; a pair that more than one pass accepts is returned with
/// the lowest.
///
/// Only grams of at least `index_gram` words are followed: each costs a few comparisons per word.
/// A gram that reaches this length is found in an index. Hence the cost of a word depends on the
/// number of grams followed, not on the length of the text, and `max_followed` bounds it: where the
/// same few words come back a hundred thousand times, the newest places stand for the rest. Below
/// this bound the search is exact.
class NgramMatcher : public NgramSearch {
 public:
  /// `text` must outlive the matcher. @throws hyselam::ParameterError
  explicit NgramMatcher(const WordLattice& text, const NgramMatcherParams& params = {});

  std::size_t bytes() const;

 private:
  /// What following a gram has to know about a word, found by the position where the word begins:
  /// 16 bytes that lie together, for the many thousands that a word may be compared with.
  struct PackedWord {
    float angle;
    std::uint32_t tags;  // class, 8 bits; size, 20; level or flags, 4
    WordIndex word;
    std::uint32_t next_alternative;  // that begins here too, in alternatives_; 0: none
    static constexpr std::uint32_t kStartsRun = 1;
    static constexpr std::uint32_t kAlternativesEnd = 2;
  };
  /// The words that match a word: their class, their sizes, their angle within the tolerance.
  struct MatchBounds {
    std::uint32_t density_class, min_size, size_span;
    float angle;
  };
  /// How long the grams are that end at a position of the newer words and at an older one, for each
  /// pass. Ordered by the older position. Two lists, because the ends are read far more often.
  struct GramList {
    std::vector<Position> ends;          // of the older words
    std::vector<std::uint16_t> lengths;  // passes_ for each
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
  /// The grams that end at a position of the newer words, and at which older positions. Only what
  /// has at least `gram_` words in the last pass.
  struct GramRow {
    GramList grams;
    PositionSet ends;
  };
  /// A gram of the row before, by its place there, and the word that may continue it.
  struct Continuation {
    std::uint32_t gram, word;
  };

  GramRow& rowOf(Position p) { return rows_[p % rows_.size()]; }
  void addPosition(Position p, bool searching) override;
  void addAlternatives(Position end, bool searching);
  void findGrams(WordIndex newer, GramRow& row, bool report);
  void continueGrams(WordIndex newer, bool report);
  void continueWithRealWords(WordIndex newer, const GramList& before, std::size_t count,
                             bool report);
  void continueWithAlternatives(WordIndex newer, const MatchBounds& bounds, const GramList& before,
                                std::size_t count, bool report);
  void startNewGrams(WordIndex newer, bool report);
  void completeLengths(Position newer_end, GramRow& row);
  void mergeGrams(GramRow& row, GramList& more);
  void dropOldestGrams(GramRow& row);
  PackedWord packWord(WordIndex word, std::uint32_t flags) const;
  MatchBounds boundsOf(const Syllables& s) const;
  bool isWithin(const MatchBounds& bounds, const PackedWord& word) const {
    // All three are evaluated and joined without branches: none of them alone is decided often
    // enough for the branch to be predictable, and a mispredicted one costs more than the other
    // two comparisons.
    const bool same_class = word.tags >> 24 == bounds.density_class;
    // Unsigned: a smaller size wraps to a large number.
    const bool same_size =
        (word.tags >> 4 & WordLattice::kMaxSize) - bounds.min_size <= bounds.size_span;
    const double difference =
        std::abs(static_cast<double>(bounds.angle) - static_cast<double>(word.angle));
    const bool same_angle = (difference < params_.tolerance.angle) |
                            (difference > 2.0 * hyselam::kPi - params_.tolerance.angle);
    return same_class & same_size & same_angle;
  }

  BlockVector<PackedWord> real_words_;    // by position
  BlockVector<PackedWord> alternatives_;  // the first stands for none
  PositionSet run_starts_;
  std::vector<GramRow> rows_;    // a ring over positions
  std::vector<GramList> found_;  // of one word, by the level of the older words; last: started
  GramList merged_;
  std::vector<Continuation> continued_, with_alternatives_;
};

}  // namespace ngram_slam
