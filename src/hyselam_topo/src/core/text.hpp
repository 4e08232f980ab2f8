// Text that may stand in a map: what XML can carry and a person can read.
#pragma once

#include <string>

namespace hyselam_topo {

/// Whether the bytes are UTF-8 without overlong forms, surrogates and values beyond U+10FFFF.
bool isUtf8(const std::string& bytes);

/// "" for a word that may stand in a map, else the reason: "is empty", "is not UTF-8", ...
std::string whatIsWrongWithWord(const std::string& word);

}  // namespace hyselam_topo
