// What the searches for n-grams in both directions have in common: parameters, matches, and the
// index of grams from which a search begins.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "hyselam_common/parameters.hpp"
#include "ngram_slam/matching/gram_index.hpp"
#include "ngram_slam/words/word_lattice.hpp"

namespace ngram_slam {

struct NgramMatcherParams {
  WordTolerance tolerance;
  /// epsilon_g: smallest number of words of a match, with 1, 2, ... levels of words in use (5.3.2).
  /// As many entries as the text has levels; each 1 .. 65535.
  std::vector<int> min_n = {7, 10, 13};
  /// Words of the grams that the index knows, 1 .. 4; min(index_gram, smallest min_n) is used.
  /// Fewer: less memory, more candidates that are rejected.
  int index_gram = 3;
  int index_bits = 20;  ///< 2^index_bits lists of the index, 4 bytes each; 4 .. 28
  /// Old places where grams are followed at a time, >= 1: the bound of what a word can cost. Of
  /// more, the newest are followed. One that drops out and comes back counts its words anew.
  int max_followed = 8192;

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError
  void validate() const;
};

/// n words that end with `newer` match n words that end with `older`, or, travelled in the reverse
/// direction, n words that begin with `older`.
struct NgramMatch {
  WordIndex newer = 0;  ///< a real word
  WordIndex older = 0;  ///< of any level below `levels`
  int levels = 1;       ///< levels of words in use when the match was accepted, as few as possible
  int n = 0;  ///< words of the longest match of these two with that many levels in use; longer
              ///< ones than 65535 count as 65535
  Direction direction = Direction::kSame;
  /// Expected number of old n-grams that match by chance, by the statistics of the text; negative
  /// where it was not computed (NgramRecognizerParams::max_chance, with_probability).
  double chance = -1.0;
  /// That the match is right, 0..1; negative where it was not computed.
  double probability = -1.0;
};

/// What the search had to do.
struct NgramMatcherCounters {
  std::uint64_t positions = 0;    ///< words added
  std::uint64_t comparisons = 0;  ///< pairs of words compared
  std::uint64_t live = 0;         ///< pairs that continued a gram
  std::uint64_t started = 0;      ///< grams of the index' length that began
};

/// Reads a text word by word as it grows. Derived: NgramMatcher, ReverseNgramMatcher.
class NgramSearch {
 public:
  virtual ~NgramSearch() = default;
  NgramSearch(const NgramSearch&) = delete;
  NgramSearch& operator=(const NgramSearch&) = delete;

  /// Adds the words that the text has gained. Returns their matches, in the order of the newer
  /// words, for each in no particular order. The list is overwritten by the next call.
  const std::vector<NgramMatch>& update();
  /// Adds words without looking for matches among them, for the runs of a loaded text. Later
  /// matches are as they should be if the next word starts a run; else those that reach back across
  /// this point come out too short.
  void skip();

  const NgramMatcherParams& params() const { return params_; }
  const NgramMatcherCounters& counters() const { return counters_; }

 protected:
  static constexpr std::size_t kMaxPasses = WordLattice::kMaxLevels;
  /// Old words lie far apart in memory: each is fetched into the cache this many words ahead.
  static constexpr std::size_t kPrefetchDistance = 16;
  /// Lengths of the longest grams of a pair of words, for each pass; 0: none.
  using Lengths = std::array<std::uint16_t, kMaxPasses>;

  /// `text` must outlive the search. @throws hyselam::ParameterError
  NgramSearch(const WordLattice& text, const NgramMatcherParams& params, Direction direction);

  /// Adds the word at position `p`, the next one; with `searching`, finds its matches.
  virtual void addPosition(Position p, bool searching) = 0;

  static std::uint16_t oneMore(std::uint16_t n) {
    return static_cast<std::uint16_t>(n == 65535 ? n : n + 1);
  }
  /// Lengths of the longest grams that end with this pair, counted up to `depth` words of the
  /// levels below `levels`, without regard to what is being followed.
  Lengths lengthsFromScratch(WordIndex newer, WordIndex older, int depth, int levels);
  /// How many of the first passes have lengths that may be too short: what is too short for the
  /// index was not followed. The passes behind them have longer grams.
  int incompletePasses(const std::uint16_t* lengths) const {
    int passes = 0;
    while (static_cast<std::size_t>(passes) < passes_ && lengths[passes] < gram_) ++passes;
    return passes;
  }
  /// Appends a match if one of the passes accepts the pair.
  void reportMatch(WordIndex newer, WordIndex older, const std::uint16_t* lengths);

  /// Finds the grams that have just become `gram_` words long, the newest first, until as many are
  /// followed as may be.
  ///
  /// `is_followed(entry)`: a gram one word shorter was followed there, so this one is known.
  /// `count_newer(end)`: how many pairs found before end after `end`, without those that an earlier
  /// call has counted; `end` falls. `add_gram(older, lengths)` takes a gram that was found.
  template <typename IsFollowed, typename CountNewer, typename AddGram>
  void startGrams(WordIndex newer, IsFollowed&& is_followed, CountNewer&& count_newer,
                  AddGram&& add_gram) {
    const Position first = text_.first(newer);
    const auto max_followed = static_cast<std::size_t>(params_.max_followed);
    std::size_t followed = 0, tried = 0;  // pairs newer than the candidate; candidates
    index_.startQuery(newer);
    while (followed < max_followed && tried < kMaxTriedPerFollowed * max_followed &&
           index_.nextPart(part_)) {
      findCandidates(first, is_followed);
      tried += candidates_.size();
      for (const WordIndex older : candidates_) {
        followed += count_newer(text_.last(older));
        if (followed >= max_followed) break;
        const Lengths lengths = lengthsFromScratch(newer, older, gram_, text_.levels());
        if (lengths[passes_ - 1] < gram_) continue;
        ++counters_.started;
        ++followed;
        add_gram(older, lengths);
      }
    }
  }

  const WordLattice& text_;
  NgramMatcherParams params_;
  Direction direction_;
  std::size_t passes_;  // pass k uses words of the levels below k
  int gram_;            // words of the grams of the index
  GramIndex index_;
  std::vector<NgramMatch> matches_;
  NgramMatcherCounters counters_;

 private:
  static constexpr std::size_t kMaxTriedPerFollowed = 4;  // candidates of the index

  /// Writes the words of the index' answer that end before `first` into candidates_, each once, the
  /// newest first.
  template <typename IsFollowed>
  void findCandidates(Position first, IsFollowed&& is_followed) {
    candidates_.clear();
    for (std::size_t i = 0; i < part_.size(); ++i) {
      // findEndingAt reads two places: where the words of a position are, then they.
      if (i + 2 * kPrefetchDistance < part_.size()) {
        text_.prefetchPosition(GramIndex::endOf(part_[i + 2 * kPrefetchDistance]));
      }
      if (i + kPrefetchDistance < part_.size()) {
        text_.prefetchWords(GramIndex::endOf(part_[i + kPrefetchDistance]));
      }
      const GramIndex::Entry entry = part_[i];
      const Position end = GramIndex::endOf(entry);
      if (end >= first || is_followed(entry)) continue;
      WordIndex older;
      if (text_.findEndingAt(end, GramIndex::levelOf(entry), &older)) candidates_.push_back(older);
    }
    std::sort(candidates_.begin(), candidates_.end(), std::greater<>());
    candidates_.erase(std::unique(candidates_.begin(), candidates_.end()), candidates_.end());
  }
  bool wordsOfPairMatch(WordIndex newer, WordIndex older);

  Position next_ = 0;
  std::vector<GramIndex::Entry> part_;
  std::vector<WordIndex> candidates_;
};

}  // namespace ngram_slam
