// The word sequence ("text") of the robot's path as a lattice of words on several levels (Maffei
// 2017, Eq. 5.1, Alg. 5.1, Alg. 5.2; differences from the thesis: docs/algorithms/words.md). Level
// 0: the real words. Level l >= 1: alternative words; each replaces l + 2 successive real words, of
// which the first and the last have the same class, by one word, as if the interruption between had
// not been there. Terms: ngram_matcher.hpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "ngram_slam/words/block_vector.hpp"
#include "ngram_slam/words/density_word.hpp"

namespace ngram_slam {

/// Number of a word, in the order of creation: first the real word of a position, then, as soon as
/// the next real word is known, the alternative words that end there.
using WordIndex = std::uint32_t;
/// Number of a real word, counted over all runs.
using Position = std::uint32_t;

/// A real or alternative word.
struct DensityWord {
  Syllables syllables;
  int level = 0;       ///< 0: real word; l >= 1: alternative word for l + 2 real words
  Position first = 0;  ///< first and last of the real words that it covers
  Position last = 0;
};

/// A range of words with consecutive indices.
struct WordRange {
  WordIndex begin = 0;
  WordIndex end = 0;
  bool empty() const { return begin == end; }
  WordIndex size() const { return end - begin; }
};

/// Returns syllable a (change of direction [rad]) of the observations [begin, end).
using AngleOf = std::function<double(std::uint32_t begin, std::uint32_t end)>;

/// Lattice of the words of all runs. 12 bytes per word and 8 per position; grows without
/// reallocation.
///
/// All words that end at a position have consecutive indices, and the predecessors of a word are
/// the words that end just before its first position. So the predecessor lists of Alg. 5.2 need no
/// memory.
class WordLattice {
 public:
  static constexpr int kMaxLevels = 16;
  static constexpr std::size_t kMaxPositions = std::size_t{1} << 28;
  static constexpr int kMaxClasses = 256;
  static constexpr std::uint32_t kMaxSize = (1u << 20) - 1;  ///< longer words count as this long

  /// `levels`: how many levels of words there are, 1 (real words only) .. kMaxLevels.
  /// `angle_of` computes the angle of alternative words; without it (for texts without
  /// observations), their angle is the wrapped sum of the angles of the words they cover.
  /// @throws hyselam::ParameterError
  explicit WordLattice(int levels = 3, AngleOf angle_of = {});

  /// Starts a run (an uninterrupted drive): the next word has no predecessors, and no alternative
  /// word spans the gap. `first_observation`: index of the first observation of the run in the
  /// ObservationStore; by default, the observation after the last one.
  void startRun();
  void startRun(std::uint32_t first_observation);

  /// Appends the alternative words that end at the position before, then a real word. Its
  /// observations follow those of the word before. Returns its position.
  /// @throws hyselam::ParameterError for a class or size out of range (size >= 1), InputError
  /// when the text is full (2^28 positions, 2^31 words).
  Position push(const Syllables& word);

  int levels() const { return levels_; }
  std::size_t words() const { return words_.size(); }
  Position positions() const { return static_cast<Position>(blocks_.size()); }
  /// First positions of all runs that have words.
  const std::vector<Position>& runs() const { return runs_; }

  DensityWord word(WordIndex i) const;
  Syllables syllables(WordIndex i) const {
    const Packed& w = words_[i];
    return {static_cast<int>(w.attributes >> 24), w.attributes & kMaxSize, w.angle};
  }
  int level(WordIndex i) const { return static_cast<int>(words_[i].attributes >> 20 & 15u); }
  Position last(WordIndex i) const { return words_[i].last; }
  Position first(WordIndex i) const {
    const int l = level(i);
    return words_[i].last - static_cast<Position>(l == 0 ? 0 : l + 1);
  }

  WordIndex realWord(Position p) const { return blocks_[p].begin; }
  bool startsRun(Position p) const { return blocks_[p].starts_run; }
  /// The words that end at a position: the real one, then alternatives by level. At the newest
  /// position, and at the last one of each run, only the real one.
  WordRange endingAt(Position p) const {
    return {blocks_[p].begin, p + 1 < positions() ? static_cast<WordIndex>(blocks_[p + 1].begin)
                                                  : static_cast<WordIndex>(words())};
  }
  /// The list P of Eq. 5.1: the words that end just before this one begins. Empty at the start of a
  /// run.
  WordRange predecessors(WordIndex i) const {
    const Position p = first(i);
    return startsRun(p) ? WordRange{} : endingAt(p - 1);
  }
  /// Calls `use(word)` with the words of levels below `levels` that begin at a position: the real
  /// one, then alternatives by level.
  template <typename Use>
  void forEachBeginningAt(Position p, int levels, Use&& use) const {
    for (int level = 0; level < levels; ++level) {
      const Position end = p + static_cast<Position>(level == 0 ? 0 : level + 1);
      WordIndex w;
      if (end >= positions()) return;
      if (findEndingAt(end, level, &w)) use(w);
    }
  }
  /// Calls `use(word)` with the words of levels below `levels` that follow a word in its run.
  template <typename Use>
  void forEachSuccessor(WordIndex i, int levels, Use&& use) const {
    const Position next = last(i) + 1;
    if (next < positions() && !startsRun(next)) forEachBeginningAt(next, levels, use);
  }
  /// The word of a level that ends at a position, if there is one: true and its index.
  bool findEndingAt(Position p, int level, WordIndex* found) const;

  /// Fetches into the cache what findEndingAt() reads: first where the words are, then the words.
  void prefetchPosition(Position p) const { prefetch(blocks_[p]); }
  void prefetchWords(Position p) const { prefetch(words_[blocks_[p].begin]); }

  /// The observations that a word describes: [begin, end).
  std::uint32_t observationBegin(WordIndex i) const { return observations_[first(i)]; }
  std::uint32_t observationEnd(WordIndex i) const {
    const Position p = last(i);
    return observations_[p] + syllables(realWord(p)).size;
  }
  std::size_t bytes() const {
    return words_.bytes() + blocks_.bytes() + observations_.bytes() +
           runs_.capacity() * sizeof(Position);
  }

 private:
  struct Packed {
    float angle;
    std::uint32_t attributes;  // bits 31..24: class; 23..20: level; 19..0: size
    Position last;             // last position that the word covers
  };
  struct Block {
    std::uint32_t begin : 31;  // WordIndex of the real word of this position
    std::uint32_t starts_run : 1;
  };

  void writeAlternatives();
  void append(const Syllables& s, int level, Position last);

  int levels_;
  AngleOf angle_of_;
  BlockVector<Packed> words_;
  BlockVector<Block> blocks_;
  BlockVector<std::uint32_t> observations_;  // first observation of each real word
  std::vector<Position> runs_;               // first position of each run
  std::uint32_t next_observation_ = 0;       // first observation of the next real word
  bool starts_run_ = true;                   // the next real word starts a run
};

}  // namespace ngram_slam
