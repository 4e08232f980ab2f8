// Intents of grammar files: what a sentence may mean, and the patterns by which it is recognised.
#pragma once

#include <string>

#include "compiled_grammar.hpp"
#include "grammar_node.hpp"
#include "pattern.hpp"

namespace hyselam_topo {
namespace language {

/// Adds to the intent of that name, which is made if it is new.
void readIntent(const std::string& name, const GrammarNode& node, const PatternContext& context,
                CompiledGrammar* grammar);

}  // namespace language
}  // namespace hyselam_topo
