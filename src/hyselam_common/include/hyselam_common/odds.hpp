// Probabilities and their log odds.
#pragma once

#include <algorithm>
#include <cmath>

namespace hyselam {

/// Of log odds [nats]: 0 .. 1.
inline double probabilityOf(double log_odds) {
  return 1.0 / (1.0 + std::exp(-log_odds));
}

/// [nats], of a probability that is taken to be `least` to 1 - `least`.
inline double logOdds(double probability, double least = 1e-6) {
  const double p = std::clamp(probability, least, 1.0 - least);
  return std::log(p / (1.0 - p));
}

}  // namespace hyselam
