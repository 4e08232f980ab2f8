// Places that are told by number and side in a text of any kind, also one that no pattern fits to:
// "the umbrella is in the third room on the right".
#pragma once

#include <string>
#include <vector>

#include "hyselam_language/grammar/grammar.hpp"
#include "hyselam_language/grammar/utterance.hpp"

namespace hyselam_topo {

/// Those behind words that tell where something is ("in"), with a kind of place or a door in them:
/// "the second drawer on the left" is none, nor is "beside the second door on the left". Their
/// reference is kNumbered, their ranges have no article.
std::vector<SaidName> numberedNamesIn(const std::string& text, const Grammar& grammar);

/// The text with a name in the place of the words in `range`; an article before them stays if the
/// name goes with one, or where it is one with a preposition ("à").
std::string withNameFor(const std::string& text, TextRange range, const std::string& name,
                        bool with_article, const Grammar& grammar);

}  // namespace hyselam_topo
