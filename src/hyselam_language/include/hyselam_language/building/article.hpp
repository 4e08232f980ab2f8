// The article of a place's name within a sentence.
#pragma once

#include <string>

#include "hyselam_language/grammar/grammar.hpp"

namespace hyselam_topo {

/// "the kitchen", "a cozinha", "os elevadores": where the head of the name is a common noun of
/// places in the language of the grammar. The name alone if it is a code, a proper name ("room
/// Mozart", "Ana's office"), or of another language. `plural`: whether it is one of several.
std::string withArticle(const std::string& name, const Grammar& grammar, bool* plural = nullptr);

/// Without the article of the grammar's language that stands before it: "kitchen" of "the kitchen".
/// A word alone is kept: "A".
std::string withoutArticle(const std::string& name, const Grammar& grammar);

}  // namespace hyselam_topo
