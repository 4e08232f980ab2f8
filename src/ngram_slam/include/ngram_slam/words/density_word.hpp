// Word: a region (segment of the path with one density class) described by three syllables <d, s,
// a> (Maffei 2017, Eq. 4.3), and when two words match (4.2.3).
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>

#include "hyselam_common/parameters.hpp"
#include "hyselam_common/pose2.hpp"
#include "ngram_slam/words/density_observation.hpp"

namespace ngram_slam {

/// The three values that describe a word.
struct Syllables {
  int density_class = 0;   ///< d: class of the free-space density (quantizer.hpp)
  std::uint32_t size = 0;  ///< s: length of the region [observations, one per 0.1 m by default]
  float angle = 0.0f;      ///< a: change of direction in the region [rad], (-pi, pi], left positive
};

/// Direction of travel relative to the earlier visit of the same place.
enum class Direction : std::uint8_t { kSame, kReverse };

/// The word of the same region travelled in the reverse direction: a turn to the left becomes one
/// to the right.
inline Syllables reversed(Syllables s) {
  // Half a turn is its own reverse: angles lie in (-pi, pi].
  if (s.angle < static_cast<float>(hyselam::kPi)) s.angle = -s.angle;
  return s;
}

/// Syllable a of Alg. 4.3 / 5.1: direction from the median to the last pose minus direction from
/// the first to the median one, wrapped. A displacement shorter than `min_displacement` [m] has no
/// direction; the heading of the first (or last) pose takes its place.
double angleVariation(const hyselam::Pose2& first, const hyselam::Pose2& median,
                      const hyselam::Pose2& last, double min_displacement = 0.05);
/// The same for the observations [begin, end), at least one.
double angleVariation(const ObservationStore& observations, std::uint32_t begin, std::uint32_t end);

struct WordTolerance {
  double size = 0.25;  ///< epsilon_s: bound of rho_s (Eq. 4.4), in (0, 1); usually 0.1 .. 0.3
  double angle =
      hyselam::radians(30);  ///< epsilon_a: bound of the angles' difference, (0, pi) [rad]

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError
  void validate() const;
};

/// Whether two words match (4.2.3): same class, relative difference of the sizes rho_s (Eq. 4.4)
/// below epsilon_s, difference of the angles below epsilon_a. Reflexive and symmetric, not
/// transitive.
inline bool wordsMatch(const Syllables& a, const Syllables& b, const WordTolerance& t) {
  if (a.density_class != b.density_class) return false;
  const double large = a.size > b.size ? a.size : b.size, small = a.size > b.size ? b.size : a.size;
  if (large - small >= t.size * large) return false;
  // Both angles lie in (-pi, pi]: the difference needs one turn at most.
  const double difference = std::abs(static_cast<double>(a.angle) - static_cast<double>(b.angle));
  return difference < t.angle || difference > 2.0 * hyselam::kPi - t.angle;
}

}  // namespace ngram_slam
