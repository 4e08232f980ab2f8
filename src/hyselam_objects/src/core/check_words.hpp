// Words that may stand in a dictionary or map.
#pragma once

#include <algorithm>
#include <string>

namespace hyselam_objects {

/// Not empty, not beyond all measure, without control characters.
inline bool isWord(const std::string& text) {
  constexpr std::size_t kLongest = 256;  // bytes
  return !text.empty() && text.size() <= kLongest &&
         std::none_of(text.begin(), text.end(), [](char c) {
           const auto byte = static_cast<unsigned char>(c);
           return byte < 0x20 || byte == 0x7f;
         });
}

}  // namespace hyselam_objects
