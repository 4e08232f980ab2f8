#pragma once

#include <algorithm>
#include <string>
#include <vector>

namespace hyselam_topo {

/// Words of letters and digits, folded, without the s of possessives.
std::vector<std::string> wordsOfName(const std::string& name);

inline bool hasDigit(const std::string& word) {
  return std::any_of(word.begin(), word.end(), [](char c) { return c >= '0' && c <= '9'; });
}

}  // namespace hyselam_topo
