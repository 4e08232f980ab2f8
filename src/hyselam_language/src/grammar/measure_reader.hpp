// Numbers and units of grammar files.
#pragma once

#include <string>

#include "compiled_grammar.hpp"
#include "grammar_node.hpp"

namespace hyselam_topo {
namespace language {

/// "twenty", "and", "and a half".
void readNumbers(const GrammarNode& node, CompiledGrammar* grammar);

/// What a quantity is measured in: factors to SI units with the words for them.
void readQuantity(const std::string& name, const GrammarNode& node, CompiledGrammar* grammar);

}  // namespace language
}  // namespace hyselam_topo
