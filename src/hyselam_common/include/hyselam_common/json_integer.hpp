// Whole numbers of JSON files: the library's own conversion takes 1e300 and 2.5 as well.
#pragma once

#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <type_traits>

#include "hyselam_common/errors.hpp"

namespace hyselam {

/// The value, if it is a whole number that a T can hold. @throws Error, without the file's name.
template <typename T>
T integerOf(const nlohmann::json& j) {
  static_assert(std::is_integral<T>::value && !std::is_same<T, bool>::value, "whole numbers only");
  // Unsigned in JSON is what has no sign: within these, no comparison goes wrong.
  if (j.is_number_unsigned()) {
    const auto value = j.get<std::uint64_t>();
    if (value <= static_cast<std::uint64_t>(std::numeric_limits<T>::max())) {
      return static_cast<T>(value);
    }
  } else if (j.is_number_integer() && std::is_signed<T>::value) {
    const auto value = j.get<std::int64_t>();
    if (value >= static_cast<std::int64_t>(std::numeric_limits<T>::min())) {
      return static_cast<T>(value);
    }
  }
  throw Error("'" + j.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace).substr(0, 40) +
              "' is no whole number that fits");
}

}  // namespace hyselam
