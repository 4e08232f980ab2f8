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

}  // namespace language
}  // namespace hyselam_topo
