// Text that may stand in a map: what XML can carry and a person can read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace hyselam_topo {

/// The length of the UTF-8 character that begins at byte `i` < bytes.size(), 0 if it is none;
/// `*code` gets its number.
std::size_t utf8CharacterAt(const std::string& bytes, std::size_t i, std::uint32_t* code);

/// Whether the bytes are UTF-8 without overlong forms, surrogates and values beyond U+10FFFF.
bool isUtf8(const std::string& bytes);

/// "" for a word that may stand in a map, else the reason: "is empty", "is not UTF-8", ...
std::string whatIsWrongWithWord(const std::string& word);

}  // namespace hyselam_topo
