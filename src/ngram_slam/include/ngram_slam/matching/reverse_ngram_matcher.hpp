// Place recognition the other way round: n-grams of old words that, read backwards and with every
// turn turned round, match the words up to the newest one. The thesis names their absence as its
// drawback (5.5, 7).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "ngram_slam/matching/gram_index.hpp"
#include "ngram_slam/matching/ngram_matcher.hpp"
#include "ngram_slam/matching/position_set.hpp"

namespace ngram_slam {

/// Follows a text like NgramMatcher and tells, for every new real word, which grams of old words
/// the text ends with when they are read backwards.
///
/// A pair of words belongs to a match if the newer one matches the reversed older one by the
/// tolerances, the older one ends before the newer one begins, and some pair of a predecessor of
/// the newer with a successor of the older belongs to it too, or it is the first pair. Passes,
/// least lengths and the bound on grams followed are those of NgramMatcher. An index of grams finds
/// where one begins; then its pairs are carried on word by word.
class ReverseNgramMatcher {
 public:
  /// `text` must outlive the matcher. @throws hyselam::ParameterError
  explicit ReverseNgramMatcher(const WordLattice& text, const NgramMatcherParams& params = {});

  /// Takes in the words that the text has gained. Returns their matches (direction kReverse), in
  /// the order of the newer words. The list is overwritten by the next call.
  const std::vector<NgramMatch>& update();
  /// Takes words in without looking for matches among them; see NgramMatcher::skip().
  void skip();

  const NgramMatcherCounters& counters() const { return counters_; }
  std::size_t bytes() const;

 private:
  static constexpr std::size_t kMaxPasses = WordLattice::kMaxLevels;
  using Lengths = std::array<std::uint16_t, kMaxPasses>;
  /// How long the grams are whose newer words end at a position and whose older words begin at
  /// `begin`, for each pass.
  struct Grams {
    Position begin = 0;
    Lengths lengths{};
  };
  struct Row {
    std::vector<Grams> grams;  // ordered by `begin`
    PositionSet has;           // these
  };

  Row& row(Position p) { return rows_[p % rows_.size()]; }
  void take(Position p, bool searching);
  void search(WordIndex newer, Row& target, bool report);
  void follow(WordIndex newer, bool report);
  void start(WordIndex newer, bool report);
  void complete(Position newer_end, Row& target);
  void enter(WordIndex newer, WordIndex older, const Lengths& lengths, bool report);
  void merge(Row& target);
  Lengths lengthsFromScratch(WordIndex newer, WordIndex older, int depth, int levels);

  const WordLattice& text_;
  NgramMatcherParams params_;
  std::size_t passes_;
  int gram_;
  GramIndex index_;
  std::vector<Row> rows_;  // a ring over positions
  std::vector<Grams> found_, merged_;
  std::vector<Position> found_ends_;  // where the older words end that were followed
  std::size_t started_from_ = 0;      // in found_
  Position next_ = 0;
  std::vector<GramIndex::Entry> part_;
  std::vector<WordIndex> candidates_;
  std::vector<NgramMatch> matches_;
  NgramMatcherCounters counters_;
};

}  // namespace ngram_slam
