// A whole text as a grammar alone reads it.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "compiled_grammar.hpp"
#include "hyselam_language/grammar/utterance.hpp"

namespace hyselam_topo {
namespace language {

/// In the order said, but for who speaks, which comes first. `expected`: see ParseOptions.
std::vector<Utterance> readText(const CompiledGrammar& grammar, const std::string& text,
                                const std::set<std::string>& expected);

/// Where a part of a sentence was refused that may say more of a place, what its other parts state
/// is to be confirmed: nobody knows what the whole says. Not beside what is asked about itself, nor
/// beside what is of things, which others understand.
void confirmParts(const CompiledGrammar& grammar, const std::string& text,
                  std::vector<Utterance>* utterances);

}  // namespace language
}  // namespace hyselam_topo
