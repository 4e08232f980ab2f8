// Words that may stand in a dictionary or map.
#pragma once

#include <string>

#include "hyselam_common/utf8.hpp"

namespace hyselam_objects {

/// What the topological map takes for a word, and not beyond all measure.
inline bool isWord(const std::string& text) {
  constexpr std::size_t kLongest = 256;  // bytes
  return text.size() <= kLongest && hyselam::wordError(text).empty();
}

}  // namespace hyselam_objects
