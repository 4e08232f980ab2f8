// Probability distributions over places.
#pragma once

#include <algorithm>
#include <vector>

namespace selovis {

/// Scales to sum 1; the uniform distribution if all values are 0.
inline void normalizeDistribution(std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) sum += v;
  if (!(sum > 0.0)) {
    std::fill(values.begin(), values.end(), 1.0 / static_cast<double>(values.size()));
    return;
  }
  for (double& v : values) v /= sum;
}

}  // namespace selovis
