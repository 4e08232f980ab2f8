// The place of a match: one pair of observations for each match.
#pragma once

#include <optional>

#include "ngram_slam/matching/alignment.hpp"
#include "ngram_slam/matching/ngram_recognizer.hpp"

namespace ngram_slam {

/// The pair in the middle of the match's own two words, aligned by density. Nothing where too
/// little of them overlaps.
inline std::optional<ObservationPair> placeOf(const NgramRecognizer& recognizer,
                                              const NgramMatch& match) {
  const auto pairs = alignedObservations(recognizer.text(), recognizer.observations(),
                                         {{match.newer, match.older}}, 1, {}, match.direction);
  if (pairs.empty()) return std::nullopt;
  return pairs[pairs.size() / 2];
}

}  // namespace ngram_slam
