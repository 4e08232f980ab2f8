// What a proposal ("Did you mean: ...?") does without, to be told with it: who says yes must know.
#pragma once

#include <string>
#include <vector>

#include "hyselam_language/grammar/grammar.hpp"

namespace hyselam_topo {

/// The runs of words of what was said that have no counterpart in the proposal (longest common
/// sequence of words, without case and accents), in their order, as they were said. Runs without a
/// word that tells something (articles, "so", "you know") are none.
std::vector<std::string> wordsLeftOut(const std::string& said, const std::string& proposed,
                                      const Grammar& grammar);

/// Each once, in order, as stands between the quotation marks of a phrase: "a', 'b".
std::string quotedInARow(const std::vector<std::string>& runs);

}  // namespace hyselam_topo
