// The check of a parameter's range, one line each.
#pragma once

#include "hyselam_common/errors.hpp"

namespace hyselam {

/// @throws ParameterError unless `good`; `allowed` is the range in words.
template <typename T>
void require(const char* name, const T& value, bool good, const char* allowed) {
  if (!good) throw ParameterError(name, value, allowed);
}

}  // namespace hyselam
