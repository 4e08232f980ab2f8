// The n-grams of a match (Eq. 5.2), computed on demand: the matcher returns only their last words
// and their length.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "ngram_slam/words/word_lattice.hpp"

namespace ngram_slam {

struct WordPair {
  WordIndex newer = 0;
  WordIndex older = 0;
};

inline bool operator==(const WordPair& a, const WordPair& b) {
  return a.newer == b.newer && a.older == b.older;
}

/// Whether two words may belong to a match when `levels` levels are in use: they match by the
/// tolerances, the older one reversed if the direction is, and the older one ends before the newer
/// one begins.
bool mayPair(const WordLattice& text, const WordTolerance& tolerance, const WordPair& pair,
             int levels, Direction direction = Direction::kSame);

/// The longest n-gram that ends with a pair: its pairs, oldest first; empty if the pair itself is
/// none. At most the last `max_words` words. Of several, the one with the lowest levels near the
/// end. Cost grows with the number of pairs of words in reach. In reverse the older words of the
/// pairs run backwards through the text.
std::vector<WordPair> longestNgram(const WordLattice& text, const WordTolerance& tolerance,
                                   const WordPair& last, int levels, std::size_t max_words = 1000,
                                   Direction direction = Direction::kSame);

/// Calls `use` with every maximal n-gram that ends with a pair (oldest first), until it returns
/// false. Their number may grow exponentially with their length: a step may have several
/// predecessors. Longer ones than `max_words` are cut there.
void forEachMaximalNgram(const WordLattice& text, const WordTolerance& tolerance,
                         const WordPair& last, int levels,
                         const std::function<bool(const std::vector<WordPair>&)>& use,
                         std::size_t max_words = 1000, Direction direction = Direction::kSame);

}  // namespace ngram_slam
