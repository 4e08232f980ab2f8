// The words of a place of the map, guessed by a match or told by people.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "hyselam_topological_map/topological_map.hpp"

namespace hyselam_topo {

/// In the place of all that nobody has confirmed.
inline void giveWords(const std::vector<std::string>& names, bool confirmed, Place* place) {
  std::vector<PlaceTerm>& words = place->words;
  words.erase(std::remove_if(words.begin(), words.end(),
                             [](const PlaceTerm& word) { return !word.confirmed; }),
              words.end());
  for (const std::string& text : names) {
    const bool has = std::any_of(words.begin(), words.end(),
                                 [&](const PlaceTerm& word) { return word.text == text; });
    if (!has) words.push_back({text, confirmed});
  }
}

}  // namespace hyselam_topo
