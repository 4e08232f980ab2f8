// From the counts of LBP codes to the bins of a signature.
#pragma once

#include <cstdint>

#include "selovis/descriptors/lbp.hpp"

namespace selovis {

/// Adds the 256 counts of one color, times `scale`, to its bins: 59 if `uniform`, else 256.
inline void addCodeCounts(const std::uint32_t* counts, bool uniform, float scale, float* bins) {
  if (!uniform) {
    for (int code = 0; code < kLbpCodes; ++code) {
      bins[code] += scale * static_cast<float>(counts[code]);
    }
    return;
  }
  const auto& labels = uniformLabels();
  std::uint32_t sums[kUniformLabels] = {};
  for (int code = 0; code < kLbpCodes; ++code) sums[labels[code]] += counts[code];
  for (int k = 0; k < kUniformLabels; ++k) bins[k] += scale * static_cast<float>(sums[k]);
}

}  // namespace selovis
