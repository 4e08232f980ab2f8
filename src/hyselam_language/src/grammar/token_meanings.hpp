// What single words of a sentence stand for, as far as the words around them tell.
#pragma once

#include <vector>

#include "compiled_grammar.hpp"

namespace hyselam_topo {
namespace language {

/// The tokens of a sentence with acronyms told from words ("IT" from "it": their lower and folded
/// forms end with a full stop) and with contracted verbs apart ("the library's on the left" is "the
/// library is on the left", "the library's door" stays).
std::vector<Token> withMeanings(std::vector<Token> tokens, const CompiledGrammar& grammar);

}  // namespace language
}  // namespace hyselam_topo
