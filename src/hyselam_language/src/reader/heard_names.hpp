// What a person who is not understood can be told of the own words: the names that were heard, and
// the words beside them that were not understood.
#pragma once

#include <string>
#include <vector>

#include "grammar/compiled_grammar.hpp"
#include "hyselam_language/grammar/utterance.hpp"
#include "hyselam_language/reader/fact_reader.hpp"

namespace hyselam_topo {

/// Whether it has a noun that the grammar knows, or a word of its own with a capital.
bool isHeardName(const std::string& name, const language::CompiledGrammar& grammar);

/// The names of places and things in the part that was refused, in their order: runs of words that
/// the reader takes for parts of names and in which is a noun that the grammar knows, or a capital.
std::vector<FactArgument> heardNames(const Utterance& part, const Reading& reading,
                                     const language::CompiledGrammar& grammar);

/// The longest run of words of the part beside the names that means something, without commas in
/// it; "" without one.
std::string wordsBeside(const std::vector<FactArgument>& names, const Utterance& part,
                        const language::CompiledGrammar& grammar);

}  // namespace hyselam_topo
