// Base class of the searches for matching n-grams in both directions of travel: parameters,
// matches, and the index in which the beginnings of matches are found. Terms: ngram_matcher.hpp.
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
  /// Number of words of the n-grams in the index, 1 .. 4; min(index_gram, smallest min_n) is used.
  /// Fewer: less memory, more candidates that are rejected.
  int index_gram = 3;
  int index_bits = 20;  ///< 2^index_bits lists of the index, 4 bytes each; 4 .. 28
  /// Maximum number of older n-grams extended per new word, >= 1; bounds the cost of a word. If
  /// there are more, the most recent are kept. The length of one that is dropped and found again
  /// restarts.
  int max_followed = 8192;

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError
  void validate() const;
};

/// The n words that end with `newer` match the n words that end with `older`, or, for direction
/// kReverse, the n words that begin with `older`.
struct NgramMatch {
  WordIndex newer = 0;  ///< a real word
  WordIndex older = 0;  ///< a word of any level below `levels`
  int levels = 1;       ///< smallest number of word levels with which the match is long enough
  int n = 0;  ///< words of the longest match of these two with `levels` levels, at most 65535
  Direction direction = Direction::kSame;
  /// Expected number of old n-grams that match by chance, by the statistics of the text; negative
  /// where it was not computed (NgramRecognizerParams::max_chance, with_probability).
  double chance = -1.0;
  /// That the match is right, 0..1; negative where it was not computed.
  double probability = -1.0;
};

/// Work done since construction, for benchmarks.
struct NgramMatcherCounters {
  std::uint64_t positions = 0;    ///< words added
  std::uint64_t comparisons = 0;  ///< pairs of words compared
  std::uint64_t live = 0;         ///< pairs of words that extended an n-gram
  std::uint64_t started = 0;      ///< n-grams found in the index
};

/// Processes the words of a text incrementally. Derived: NgramMatcher, ReverseNgramMatcher.
class NgramSearch {
 public:
  virtual ~NgramSearch() = default;
  NgramSearch(const NgramSearch&) = delete;
  NgramSearch& operator=(const NgramSearch&) = delete;

  /// Processes the words added to the text since the last call. Returns their matches in the order
  /// of the newer words; matches of one word in no particular order. Overwritten by the next call.
  const std::vector<NgramMatch>& update();
  /// Indexes the words added since the last call without searching for their matches, as for the
  /// runs of a loaded text. Unless the next word starts a run, later matches that extend back
  /// across this point come out too short.
  void skip();

  const NgramMatcherParams& params() const { return params_; }
  const NgramMatcherCounters& counters() const { return counters_; }

 protected:
  static constexpr std::size_t kMaxPasses = WordLattice::kMaxLevels;
  /// Older words are scattered in memory: each is prefetched this many iterations ahead.
  static constexpr std::size_t kPrefetchDistance = 16;
  /// Length of the longest matching n-gram of a pair of words [words], for each pass; 0: none.
  using Lengths = std::array<std::uint16_t, kMaxPasses>;

  /// `text` must outlive the search. @throws hyselam::ParameterError
  NgramSearch(const WordLattice& text, const NgramMatcherParams& params, Direction direction);

  /// Adds the word at position `p`, the next one; with `searching`, finds its matches.
  virtual void addPosition(Position p, bool searching) = 0;

  static std::uint16_t oneMore(std::uint16_t n) {
    return static_cast<std::uint16_t>(n == 65535 ? n : n + 1);
  }
  /// Recomputes the lengths of the longest matching n-grams that end with this pair of words, up to
  /// `depth` words, with words of the levels below `levels`.
  Lengths lengthsFromScratch(WordIndex newer, WordIndex older, int depth, int levels);
  /// Number of leading passes whose length is below index_gram_ and hence may be too small, because
  /// n-grams that short are not tracked. Later passes use more levels and have longer n-grams.
  int incompletePasses(const std::uint16_t* lengths) const {
    int passes = 0;
    while (static_cast<std::size_t>(passes) < passes_ && lengths[passes] < index_gram_) ++passes;
    return passes;
  }
  /// Appends a match if one of the passes accepts the pair.
  void reportMatch(WordIndex newer, WordIndex older, const std::uint16_t* lengths);

  /// Finds in the index the older n-grams that match the latest index_gram_ words and are not yet
  /// tracked, most recent first, until max_followed are.
  ///
  /// `is_followed(entry)`: the n-gram is already tracked, as the extension of one in an earlier
  /// row. `count_newer(end)`: number of tracked n-grams whose older words end after `end`, without
  /// those counted by earlier calls; `end` decreases from call to call. `add_gram(older, lengths)`:
  /// called with each n-gram found.
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
        const Lengths lengths = lengthsFromScratch(newer, older, index_gram_, text_.levels());
        if (lengths[passes_ - 1] < index_gram_) continue;
        ++counters_.started;
        ++followed;
        add_gram(older, lengths);
      }
    }
  }

  const WordLattice& text_;
  NgramMatcherParams params_;
  Direction direction_;
  std::size_t passes_;  // number of passes; pass k = 1 .. passes_ uses words of levels below k
  int index_gram_;      // number of words of the n-grams in the index
  GramIndex index_;
  std::vector<NgramMatch> matches_;
  NgramMatcherCounters counters_;

 private:
  static constexpr std::size_t kMaxTriedPerFollowed = 4;  // index candidates per max_followed

  /// Collects in candidates_ the last words of the index entries in part_ that end before position
  /// `first` and are not tracked: each once, most recent first.
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

  Position next_ = 0;                   // first position that has not been added
  std::vector<GramIndex::Entry> part_;  // part of the answer of the index
  std::vector<WordIndex> candidates_;   // see findCandidates()
};

}  // namespace ngram_slam
