// Types of names in grammar files: which words places, objects, ... may be called by.
#pragma once

#include <string>

#include "compiled_grammar.hpp"
#include "grammar_node.hpp"
#include "pattern.hpp"

namespace hyselam_topo {
namespace language {

/// Adds to the type of that name, which is made if it is new. References go into the context.
void readNameType(const std::string& name, const GrammarNode& node, CompiledGrammar* grammar,
                  PatternContext* context);

}  // namespace language
}  // namespace hyselam_topo
