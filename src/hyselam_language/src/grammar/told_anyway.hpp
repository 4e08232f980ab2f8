// Statements that are said as questions: "Can you note that the lab is on the left?", "The lab is
// on the left, ok?". Tags that ask ("isn't it?") are none of these.
#pragma once

#include <vector>

#include "compiled_grammar.hpp"

namespace hyselam_topo {
namespace language {

/// Removes such words at the beginning and the end; whether there were any and something is left.
bool dropToldAnyway(const CompiledGrammar& grammar, std::vector<Token>* tokens);

}  // namespace language
}  // namespace hyselam_topo
