// The engine: finds the cheapest way to read a sentence as clauses, each of them a pattern of the
// grammar.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "compiled_grammar.hpp"

namespace hyselam_topo {
namespace language {

/// What a sentence says: its clauses, or one utterance that was not understood.
std::vector<Utterance> readSentence(const CompiledGrammar& grammar, const std::string& text,
                                    const Sentence& sentence,
                                    const std::set<std::string>& expected);

/// What a text says that is one sentence and fits one pattern, with nothing left out; nothing for
/// others, whose reasons are not looked for.
std::optional<Utterance> readPlainly(const CompiledGrammar& grammar, const std::string& text);

/// A sentence that says just what an utterance does, in its own words; "" if they do not alone.
std::string asSentenceOf(const CompiledGrammar& grammar, const Utterance& utterance);

/// See Grammar::isPlainName().
bool isPlainName(const CompiledGrammar& grammar, const std::string& name, const std::string& type);

}  // namespace language
}  // namespace hyselam_topo
