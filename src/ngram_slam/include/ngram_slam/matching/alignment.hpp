// From matched words to matched observations: the raw densities of both are aligned (5.2.4,
// Eq. 5.3).
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "ngram_slam/matching/ngram.hpp"
#include "ngram_slam/words/density_observation.hpp"
#include "ngram_slam/words/word_lattice.hpp"

namespace ngram_slam {

struct AlignmentParams {
  int max_shift = 20;        ///< delta_max: shifts of less than this are tried [observations], >= 1
  double min_overlap = 0.5;  ///< share of the n terms that must exist for a shift, (0, 1]
  WordDensity density = WordDensity::kFull;  ///< which are compared; soft where full is missing

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError
  void validate() const;
};

struct Alignment {
  int shift = 0;  ///< delta: observation s2 + i lies where s1 + i + delta does; in reverse, s2 - i
  double rms = 0.0;         ///< root of the mean squared difference of the densities there
  std::uint32_t terms = 0;  ///< observations compared
};

/// Eq. 5.3 for `n` observations from `s1` and from `s2` on. Terms outside the runs of s1 and s2 do
/// not exist; so that shifts with few terms are not preferred, the mean of the squares counts,
/// which is the sum of Eq. 5.3 where all exist. Of equal shifts the smallest wins. Nothing if every
/// shift misses too many terms. In reverse s2 is the last one of the older observations, which run
/// backwards.
std::optional<Alignment> align(const ObservationStore& observations, std::uint32_t s1,
                               std::uint32_t s2, std::uint32_t n,
                               const AlignmentParams& params = {},
                               Direction direction = Direction::kSame);

/// Two observations of the same place.
struct ObservationPair {
  std::uint32_t newer = 0;
  std::uint32_t older = 0;
  double rms = 0.0;  ///< of the alignment that they come from
};

/// The observations of an n-gram: each pair of words is aligned (n: the size of the smaller one),
/// and every `step`-th pair of observations is returned, in the order of the words and, within
/// them, of the newer ones.
/// @throws hyselam::ParameterError unless step >= 1.
std::vector<ObservationPair> alignedObservations(const WordLattice& text,
                                                 const ObservationStore& observations,
                                                 const std::vector<WordPair>& ngram, int step = 1,
                                                 const AlignmentParams& params = {},
                                                 Direction direction = Direction::kSame);

}  // namespace ngram_slam
