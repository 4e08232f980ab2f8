// A sentence of which only parts are understood: "the lab is on the left, you know how it is, and
// they moved the lift", "the lab is on the left dont ask me why". What is clear is taken down; the
// rest is told as not understood, or as left out where it says nothing of the building. Never where
// the rest may change what is clear: doubt, conditions, alternatives, corrections, and what
// somebody does not say ("nobody says that the lab is on the left").
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "compiled_grammar.hpp"
#include "sentence_reader.hpp"

namespace hyselam_topo {
namespace language {

/// Reads tokens as one sentence; gives those of its beginnings that are understood and end at one
/// of the tokens `ends`.
using ReadBeginnings =
    std::function<std::vector<Beginning>(std::vector<Token>, const std::vector<std::size_t>& ends)>;

/// The utterances of the sentence in their order, at least one of them understood; empty if it
/// cannot be taken apart.
std::vector<Utterance> readParts(const std::vector<Token>& tokens, const std::string& text,
                                 const CompiledGrammar& grammar, const ReadBeginnings& read);

}  // namespace language
}  // namespace hyselam_topo
