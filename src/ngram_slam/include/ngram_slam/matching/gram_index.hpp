// Index of all n-grams of n words in a text: a hash table that returns the earlier n-grams whose
// words may match the latest n words, without visiting the others. Terms: ngram_matcher.hpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "ngram_slam/words/word_lattice.hpp"

namespace ngram_slam {

/// Words are quantized into buckets of class, logarithm of the size, and angle, about twice as wide
/// as the tolerance; the buckets of its words determine the list in which an n-gram is stored. A
/// query reads the lists of all combinations of buckets that can hold matching words: every n-gram
/// that matches is among the answers; answers that do not match are possible.
class GramIndex {
 public:
  /// Index of n-grams of `n` words with 2^bits lists. `backwards`: queries find n-grams passed in
  /// the reverse direction (words in reverse order, each as by reversed()).
  GramIndex(const WordLattice& text, const WordTolerance& tolerance, int n, int bits,
            bool backwards = false);

  /// Adds all n-grams that end with this word, one for each chain of its predecessors.
  void insert(WordIndex last);
  /// Identifies an n-gram by that word of it which matches the newest word (its last one;
  /// backwards: its first): first position of the word << 4 | level of the word.
  using Entry = std::uint32_t;
  static Position firstOf(Entry e) { return e >> 4; }
  static int levelOf(Entry e) { return static_cast<int>(e & 15u); }
  static Position endOf(Entry e) { return firstOf(e) + ((e & 15u) == 0 ? 0 : (e & 15u) + 1); }
  /// Starts a query for all stored n-grams that may match one that ends with `last`.
  void startQuery(WordIndex last);
  /// Writes the next part of the answer, most recent first: all n-grams of a part end later than
  /// all of the next part (backwards: nearly so). Within a part they are unordered and may be
  /// repeated. False if there are no more.
  bool nextPart(std::vector<Entry>& part);

  std::size_t bytes() const { return heads_.capacity() * sizeof(std::uint32_t) + pool_.bytes(); }

 private:
  // A list is a chain of chunks in pool_, newest first, each twice as large as the previous one (up
  // to kLargest). Layout of a chunk: index of the previous chunk (0: none), number of entries,
  // capacity, then the entries.
  static constexpr int kBlockBits = 16;
  static constexpr std::uint32_t kHeader = 3;  // size of a chunk's header [pool_ elements]
  static constexpr std::uint32_t kSmallest = 8, kLargest = 1024;  // chunk sizes with the header

  /// Reading position in a list, which is read backwards.
  struct Cursor {
    std::uint32_t chunk, left;  // index of the chunk in pool_; entries of it yet to be read
  };

  std::uint32_t sizeBucket(double size) const;
  std::uint32_t bucket(const Syllables& s) const;
  std::uint32_t listOf(std::uint64_t key) const {
    return static_cast<std::uint32_t>(key >> shift_);
  }
  void insertPaths(WordIndex word, int depth, std::uint64_t key);
  void collect(WordIndex word, int depth, std::uint64_t key);
  /// Contribution of the word number `place` of an n-gram to the n-gram's hash key, a sum.
  static std::uint64_t keyOf(int place, std::uint32_t bucket);
  void sortLists();
  void add(std::uint32_t list, std::uint32_t entry);
  std::uint32_t newChunk(std::uint32_t before, std::uint32_t size);

  const WordLattice& text_;
  WordTolerance tolerance_;
  int n_;
  int shift_;
  bool backwards_;
  double log_width_;                             // width of a size bucket, in log(size)
  std::uint32_t angle_buckets_;                  // number of angle buckets in a full turn
  std::vector<std::uint32_t> heads_;             // newest chunk of each list, 0: empty
  BlockVector<std::uint32_t, kBlockBits> pool_;  // all chunks
  std::vector<std::uint32_t> lists_;             // lists read by the query
  /// Where an n-gram is to be stored.
  struct Target {
    std::uint32_t list;
    Entry entry;
  };
  std::vector<Target> targets_;  // buffer of insert()
  std::vector<Cursor> cursors_;  // of the lists that the query has not exhausted
  Position until_ = 0;  // n-grams that end here or later have been returned in earlier parts
  Position reach_ = 0;  // number of positions that the next part spans
};

}  // namespace ngram_slam
