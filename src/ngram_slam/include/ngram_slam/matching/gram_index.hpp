// Finds old grams whose words may match the words of a new gram, without visiting the others.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "ngram_slam/words/word_lattice.hpp"

namespace ngram_slam {

/// Words are sorted into buckets of class, logarithm of the size and angle, about twice as wide as
/// the tolerance; a gram into a list by the buckets of its words. A query reads the lists of all
/// combinations of buckets that can hold matching words: every gram that matches is among the
/// answers, others may be.
class GramIndex {
 public:
  /// Grams of `n` words, 2^bits lists. `backwards`: queries are grams of the text read
  /// backwards, as reversed words.
  GramIndex(const WordLattice& text, const WordTolerance& tolerance, int n, int bits,
            bool backwards = false);

  /// Adds all grams that end with this word, through all its predecessors.
  void insert(WordIndex last);
  /// An old gram by the word that matches the newest one, its last word, backwards its first:
  /// first position << 4 | level.
  using Entry = std::uint32_t;
  static Position firstOf(Entry e) { return e >> 4; }
  static int levelOf(Entry e) { return static_cast<int>(e & 15u); }
  static Position endOf(Entry e) { return firstOf(e) + ((e & 15u) == 0 ? 0 : (e & 15u) + 1); }
  /// Starts a query for every gram that may match one of those that end with `last`.
  void startQuery(WordIndex last);
  /// Writes the next part of the answer, newest grams first: all of a part end later than all of
  /// the next one (backwards: nearly so); within a part in no particular order, some perhaps
  /// several times. False: no more.
  bool nextPart(std::vector<Entry>& part);

  std::size_t bytes() const { return heads_.capacity() * sizeof(std::uint32_t) + pool_.bytes(); }

 private:
  // A list is a chain of chunks, newest first, each twice as large as the one before: chunk before
  // (0: none), entries, room for entries, then the entries (first position << 4 | level).
  static constexpr int kBlockBits = 16;
  static constexpr std::uint32_t kHeader = 3;
  static constexpr std::uint32_t kSmallest = 8, kLargest = 1024;  // chunks with their header

  /// Where reading of a list has come to: before this entry of this chunk.
  struct Cursor {
    std::uint32_t chunk, left;
  };

  std::uint32_t sizeBucket(double size) const;
  std::uint32_t bucket(const Syllables& s) const;
  std::uint32_t listOf(std::uint64_t key) const {
    return static_cast<std::uint32_t>(key >> shift_);
  }
  void insertPaths(WordIndex word, int depth, std::uint64_t key);
  void collect(WordIndex word, int depth, std::uint64_t key);
  /// What the word at `place` of a gram adds to the gram's key.
  static std::uint64_t keyOf(int place, std::uint32_t bucket);
  void sortLists();
  void add(std::uint32_t list, std::uint32_t entry);
  std::uint32_t newChunk(std::uint32_t before, std::uint32_t size);

  const WordLattice& text_;
  WordTolerance tolerance_;
  int n_;
  int shift_;
  bool backwards_;
  double log_width_;             // of a size bucket
  std::uint32_t angle_buckets_;  // around the circle
  std::vector<std::uint32_t> heads_;
  BlockVector<std::uint32_t, kBlockBits> pool_;
  std::vector<std::uint32_t> lists_;
  /// Where a gram is to be written.
  struct Target {
    std::uint32_t list;
    Entry entry;
  };
  std::vector<Target> targets_;
  std::vector<Cursor> cursors_;
  Position until_ = 0;  // all that ends here or later was in an earlier part
  Position reach_ = 0;  // positions of the next part
};

}  // namespace ngram_slam
