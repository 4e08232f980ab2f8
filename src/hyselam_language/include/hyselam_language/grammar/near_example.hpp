// Whether an example in a refusal has to do with what was said.
#pragma once

#include <string>

#include "hyselam_language/grammar/grammar.hpp"

namespace hyselam_topo {

/// Whether all words by which the example places its names ("next", "left") were said, and one of
/// them that is more than "in" or "on". Who is shown anything else is told of what was never said.
bool isNearExample(const std::string& said, const std::string& example, const Grammar& grammar);

}  // namespace hyselam_topo
