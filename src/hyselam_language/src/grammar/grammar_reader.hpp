// Grammar files (YAML) into what the matcher uses.
#pragma once

#include <memory>
#include <vector>

#include "compiled_grammar.hpp"
#include "hyselam_language/grammar/grammar.hpp"

namespace hyselam_topo {
namespace language {

/// See Grammar::fromYaml().
std::shared_ptr<const CompiledGrammar> readGrammar(const std::vector<GrammarSource>& sources);

}  // namespace language
}  // namespace hyselam_topo
