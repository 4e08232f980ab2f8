// What the searches in both directions have in common.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>

#include "hyselam_common/errors.hpp"
#include "ngram_slam/matching/ngram_matcher.hpp"

namespace ngram_slam {

constexpr std::size_t kMostTried = 4;  // candidates, by what may be followed
constexpr std::size_t kAhead = 16;     // words that are being fetched

inline std::uint16_t oneMore(std::uint16_t n) {
  return static_cast<std::uint16_t>(n == 65535 ? n : n + 1);
}

/// Words of the grams that the index knows. @throws hyselam::ParameterError
inline int gramOf(const NgramMatcherParams& p) {
  p.validate();
  return std::min(p.index_gram, *std::min_element(p.min_n.begin(), p.min_n.end()));
}

/// @throws hyselam::ParameterError unless there are as many passes as the text has levels
inline void requirePassForEachLevel(std::size_t passes, const WordLattice& text) {
  if (passes != static_cast<std::size_t>(text.levels()))
    throw hyselam::ParameterError(
        "number of entries of min_n", passes,
        "the number of levels of the text, " + std::to_string(text.levels()));
}

}  // namespace ngram_slam
