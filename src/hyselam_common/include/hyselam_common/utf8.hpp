// UTF-8, and text that may be a name: what XML can carry and a person can read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace hyselam {

/// The length of the UTF-8 character that begins at byte `i` < bytes.size(), 0 if it is none;
/// `*code` is its number.
std::size_t utf8CharacterAt(const std::string& bytes, std::size_t i, std::uint32_t* code);

/// Whether the bytes are UTF-8 without overlong forms, surrogates and values beyond U+10FFFF.
bool isUtf8(const std::string& bytes);

/// Why `word` cannot be a name ("is empty", "is not UTF-8", ...), or "" if it can.
std::string wordError(const std::string& word);

}  // namespace hyselam
