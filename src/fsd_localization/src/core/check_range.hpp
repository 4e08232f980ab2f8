// One line to refuse a parameter.
#pragma once

#include <string>

#include "hyselam_common/errors.hpp"

namespace fsd_localization {

/// @throws hyselam::ParameterError unless low <= value <= high.
inline void check(const char* name, double value, double low, double high) {
  if (!(value >= low && value <= high))
    throw hyselam::ParameterError(name, value,
                                  "in [" + std::to_string(low) + ", " + std::to_string(high) + "]");
}

}  // namespace fsd_localization
