// The classes of the reader's classifiers: a relation with its arguments, "*" for those that are
// mentions: "next/*/*", "end/*/HERE", "ask_what/next/*".
#pragma once

#include <string>
#include <vector>

#include "hyselam_language/reader/fact_reader.hpp"

namespace hyselam_topo {
namespace language {

/// The parts of a label: relation and arguments.
std::vector<std::string> labelParts(const std::string& label);

/// The fact of a label with the mentions put in, in their order.
ReadFact factOf(const std::string& label, const std::vector<FactArgument>& mentions);

}  // namespace language
}  // namespace hyselam_topo
