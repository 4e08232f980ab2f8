// Reasons of issues in the language of the person.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "hyselam_language/grammar/grammar.hpp"

namespace hyselam_topo {

/// The text of a reason with its values: `say` of the grammar under "issue_" + key, otherwise the
/// English one of this library. Throws std::out_of_range for a key that is not there.
std::string issueText(const Grammar& grammar, const std::string& key,
                      const std::vector<std::pair<std::string, std::string>>& values = {});

/// All keys, for tests of grammars.
std::vector<std::string> issueKeys();

}  // namespace hyselam_topo
