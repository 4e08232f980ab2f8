// Place recognition: all n-grams of old words that match the words up to the newest one (4.2.3,
// 5.2.3, Alg. 5.3 with its errata), found while the text grows.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "ngram_slam/matching/gram_index.hpp"
#include "ngram_slam/matching/position_set.hpp"
#include "ngram_slam/words/word_lattice.hpp"

namespace ngram_slam {

struct NgramMatcherParams {
  WordTolerance tolerance;
  /// epsilon_g: least number of words of a match, with 1, 2, ... levels of words in use (5.3.2).
  /// As many entries as the text has levels; each 1 .. 65535.
  std::vector<int> min_n = {7, 10, 13};
  /// Words of the grams that the index knows, 1 .. 4; min(index_gram, smallest min_n) is used.
  /// Fewer: less memory, more candidates that come to nothing.
  int index_gram = 3;
  int index_bits = 20;  ///< 2^index_bits lists of the index, 4 bytes each; 4 .. 28
  /// Old places where grams are followed at a time, >= 1: the bound of what a word can cost. Of
  /// more, the newest are followed. One that falls out and comes back counts its words anew.
  int max_followed = 8192;

  /// @throws hyselam::ParameterError
  void validate() const;
};

/// n words that end with `newer` match n words that end with `older`, or, travelled the other way,
/// n words that begin with `older`.
struct NgramMatch {
  WordIndex newer = 0;  ///< a real word
  WordIndex older = 0;  ///< of any level below `levels`
  int levels = 1;       ///< levels of words in use when the match was accepted, as few as possible
  int n = 0;  ///< words of the longest match of these two with that many levels in use; longer
              ///< ones than 65535 count as 65535
  Direction direction = Direction::kSame;
  /// Expected number of old n-grams that match by chance, by the text's own statistics; negative
  /// where nobody asked for it (NgramRecognizerParams::max_chance, with_probability).
  double chance = -1.0;
  /// That the match is right, 0..1; negative where nobody asked for it.
  double probability = -1.0;
};

/// What the search had to do.
struct NgramMatcherCounters {
  std::uint64_t positions = 0;    ///< words taken in
  std::uint64_t comparisons = 0;  ///< pairs of words compared
  std::uint64_t live = 0;         ///< pairs that continued a gram
  std::uint64_t started = 0;      ///< grams of the index' length that began
};

/// Follows a text and tells, for every new real word, which grams of old words end like the text.
///
/// A pair of words belongs to a match if they match by the tolerances, the older one ends before
/// the newer one begins, and some pair of their predecessors belongs to it too, or it is the first
/// pair. A match is maximal when no pair of predecessors matches. Pass k uses words of the levels
/// below k and needs min_n[k - 1] words; a pair that more than one pass accepts is told with the
/// lowest.
///
/// Only grams of at least `index_gram` words are followed: each costs a few comparisons per word.
/// A gram that reaches this length is found in an index. Hence the cost of a word depends on the
/// number of grams alive, not on the length of the text, and `max_followed` bounds it: where the
/// same few words come back a hundred thousand times, the newest places stand for the rest. Below
/// this bound the search is exact.
class NgramMatcher {
 public:
  /// `text` must outlive the matcher. @throws hyselam::ParameterError
  explicit NgramMatcher(const WordLattice& text, const NgramMatcherParams& params = {});

  /// Takes in the words that the text has gained. Returns their matches, in the order of the newer
  /// words, for each in no particular order. The list is overwritten by the next call.
  const std::vector<NgramMatch>& update();
  /// Takes words in without looking for matches among them, for the runs of a loaded text. Later
  /// matches are as they should be if the next word starts a run; else those that reach back across
  /// this point are told too short.
  void skip();

  const NgramMatcherParams& params() const { return params_; }
  const NgramMatcherCounters& counters() const { return counters_; }
  std::size_t bytes() const;

 private:
  static constexpr std::size_t kMaxPasses = WordLattice::kMaxLevels;
  using Lengths = std::array<std::uint16_t, kMaxPasses>;

  /// What following a gram has to know about a word, found by the position where the word begins:
  /// 16 bytes that lie together, for the many thousands that a word may have to look at.
  struct Begin {
    float angle;
    std::uint32_t tags;  // class, 8 bits; size, 20; level or flags, 4
    WordIndex word;
    std::uint32_t alternative;  // another word that begins here, in alternatives_; 0: none
    static constexpr std::uint32_t kStartsRun = 1;
    static constexpr std::uint32_t kAlternativesEnd = 2;
  };
  /// A word to compare others with: its class, the sizes that match, its angle.
  struct Probe {
    std::uint32_t density_class, smallest, span;
    float angle;
  };
  /// How long the grams are that end at a position of the newer words and at an older one, for each
  /// pass. Ordered by the older position.
  struct Grams {
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
    void reverse(std::size_t passes) {
      std::reverse(ends.begin(), ends.end());
      for (std::size_t i = 0, j = ends.size(); i + 1 < j--; ++i)
        std::swap_ranges(lengths.begin() + static_cast<std::ptrdiff_t>(i * passes),
                         lengths.begin() + static_cast<std::ptrdiff_t>((i + 1) * passes),
                         lengths.begin() + static_cast<std::ptrdiff_t>(j * passes));
    }
  };
  /// The grams of a position, and which older positions they have. Only what has at least `gram_`
  /// words in the last pass.
  struct Row {
    Grams grams;
    PositionSet has;  // older positions
  };

  Row& row(Position p) { return rows_[p % rows_.size()]; }
  void take(Position p, bool searching);
  void search(WordIndex newer, Row& target, bool report);
  void follow(WordIndex newer, bool report);
  void start(WordIndex newer, bool report);
  void complete(Position newer_end, Row& target);
  void mergeInto(Row& target, Grams& more);
  void tell(WordIndex newer, WordIndex older, const std::uint16_t* lengths);
  void trim(Row& target);
  Lengths lengthsFromScratch(WordIndex newer, WordIndex older, int depth, int levels);
  Begin beginOf(WordIndex word, std::uint32_t flags) const;
  Probe probe(const Syllables& s) const;
  bool matches(const Probe& p, const Begin& begin) const {
    // All three are looked at: one of them alone would decide too often to be foretold.
    const bool same_class = begin.tags >> 24 == p.density_class;
    const bool same_size =
        (begin.tags >> 4 & WordLattice::kMaxSize) - p.smallest <= p.span;  // wraps below
    const double difference =
        std::abs(static_cast<double>(p.angle) - static_cast<double>(begin.angle));
    const bool same_angle = (difference < params_.tolerance.angle) |
                            (difference > 2.0 * hyselam::kPi - params_.tolerance.angle);
    return same_class & same_size & same_angle;
  }
  bool match(WordIndex newer, WordIndex older) {
    ++counters_.comparisons;
    return wordsMatch(text_.syllables(newer), text_.syllables(older), params_.tolerance);
  }

  const WordLattice& text_;
  NgramMatcherParams params_;
  std::size_t passes_;
  int gram_;
  GramIndex index_;
  BlockVector<Begin> begins_;        // the real words, by position
  BlockVector<Begin> alternatives_;  // the others
  PositionSet run_starts_;
  std::vector<Row> rows_;     // a ring over positions
  std::vector<Grams> found_;  // what one word adds, by the level of the older words; last: started
  Grams merged_;
  struct Hit {
    std::uint32_t gram, word;
  };
  std::vector<Hit> hits_, branches_;
  Position next_ = 0;
  std::vector<GramIndex::Entry> part_;
  std::vector<WordIndex> candidates_;
  std::vector<NgramMatch> matches_;
  NgramMatcherCounters counters_;
};

}  // namespace ngram_slam
