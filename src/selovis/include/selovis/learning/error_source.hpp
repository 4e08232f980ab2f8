// Adds the source of an input to the errors of functions that do not know it.
#pragma once

#include <string>
#include <utility>

#include "hyselam_common/errors.hpp"

namespace selovis {

/// Returns f(). @throws hyselam::InputError that begins with `source` (a file) for each
/// hyselam::Error that `f` throws.
template <typename F>
decltype(auto) withSource(const std::string& source, F&& f) {
  try {
    return std::forward<F>(f)();
  } catch (const hyselam::Error& e) {
    throw hyselam::InputError(source, "", e.what());
  }
}

}  // namespace selovis
