// How far a word is from another: for "did you mean ...?".
#pragma once

#include <cstddef>
#include <string_view>

namespace hyselam {

/// Levenshtein's: least number of letters to be changed, added or left out.
std::size_t editDistance(std::string_view a, std::string_view b);

}  // namespace hyselam
