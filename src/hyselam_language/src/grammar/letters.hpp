// Letters of several scripts: lower case, and without accents.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace hyselam_topo {
namespace language {

/// The number of the character at `i`, 0 behind the end; broken bytes count as signs.
std::uint32_t codeAt(const std::string& text, std::size_t i, std::size_t end,
                     std::size_t* length = nullptr);

bool isSpace(std::uint32_t code);
bool isDigit(std::uint32_t code);
/// Letters, digits, marks that belong to letters.
bool isLetterOrDigit(std::uint32_t code);
bool isUpper(std::uint32_t code);

/// Latin, Greek and Cyrillic letters in lower case, curly apostrophes and long dashes as the plain
/// ones; everything else as it is. Bytes that are no UTF-8 are left out.
std::string lowered(const std::string& text);

/// lowered(), and without accents: "ß" becomes "ss", "²" becomes "2".
std::string folded(const std::string& text);

/// One space for each gap between words, none around them.
std::string singleSpaced(const std::string& text);

/// Whether one letter more, less, another, or two neighbours exchanged make `b` of `a`
/// (Damerau-Levenshtein distance 1). Bytes, so for folded() text.
bool isOneSlipApart(const std::string& a, const std::string& b);

}  // namespace language
}  // namespace hyselam_topo
