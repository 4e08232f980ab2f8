// UTF-8: characters, letters of several scripts in lower case and without accents, and text that
// may be a name (what XML can carry and a person can read).
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

/// The number of the character at byte `i`, 0 from `end` on; bytes that are no UTF-8 count as '?'.
/// `*length`, if given, gets its number of bytes.
std::uint32_t utf8CodeAt(const std::string& text, std::size_t i, std::size_t end,
                         std::size_t* length = nullptr);

bool isUnicodeSpace(std::uint32_t code);
bool isUnicodeDigit(std::uint32_t code);
/// Letters, digits, marks that belong to letters.
bool isUnicodeLetterOrDigit(std::uint32_t code);
bool isUnicodeUpper(std::uint32_t code);

/// Latin, Greek and Cyrillic letters in lower case, curly apostrophes and long dashes as the plain
/// ones; everything else as it is. Bytes that are no UTF-8 are left out.
std::string utf8Lower(const std::string& text);

/// utf8Lower(), and without accents: "ß" becomes "ss", "²" becomes "2".
std::string utf8Fold(const std::string& text);

/// One space for each gap between words, none around them.
std::string singleSpaced(const std::string& text);

}  // namespace hyselam
