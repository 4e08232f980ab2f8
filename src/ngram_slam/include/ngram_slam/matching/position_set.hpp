// A set of positions of a text that is asked often.
#pragma once

#include <cstdint>

#include "ngram_slam/words/block_vector.hpp"

namespace ngram_slam {

/// One bit for each position up to the largest one ever set.
class PositionSet {
 public:
  bool has(std::uint32_t p) const {
    return p / 64 < words_.size() && (words_[p / 64] >> p % 64 & 1u) != 0;
  }
  void set(std::uint32_t p) {
    words_.grow(p / 64 + 1);
    words_[p / 64] |= std::uint64_t{1} << p % 64;
  }
  /// For a position that has been set.
  void clear(std::uint32_t p) { words_[p / 64] &= ~(std::uint64_t{1} << p % 64); }
  std::size_t bytes() const { return words_.bytes(); }

 private:
  BlockVector<std::uint64_t> words_;
};

}  // namespace ngram_slam
