// How far a word is from another: for "did you mean ...?".
#pragma once

#include <cstddef>
#include <string_view>

namespace hyselam {

/// Levenshtein's: least number of letters to be changed, added or left out.
std::size_t editDistance(std::string_view a, std::string_view b);

/// Whether one letter more, less, another, or two neighbours exchanged make `b` of `a`
/// (Damerau-Levenshtein distance 1). Bytes, so for text without accents (utf8Fold()).
bool isOneEditApart(std::string_view a, std::string_view b);

}  // namespace hyselam
