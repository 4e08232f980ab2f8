// A sentence of which only parts are understood: "the lab is on the left, you know how it is, and
// they moved the lift". What is clear is taken down; the rest is told as not understood, or as left
// out where it says nothing of the building. Never where the rest may change what is clear: doubt,
// conditions, alternatives, corrections.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "compiled_grammar.hpp"

namespace hyselam_topo {
namespace language {

/// Reads tokens as one sentence; not understood: one utterance.
using ReadTokens = std::function<std::vector<Utterance>(std::vector<Token>)>;

/// The utterances of the sentence in their order, at least one of them understood; empty if it
/// cannot be taken apart.
std::vector<Utterance> readParts(const std::vector<Token>& tokens, const std::string& text,
                                 const CompiledGrammar& grammar, const ReadTokens& read);

}  // namespace language
}  // namespace hyselam_topo
