// The classes of the reader's classifiers: a relation with its arguments, "*" for those that are
// mentions: "next/*/*", "end/*/HERE", "ask_what/next/*".
#pragma once

#include <string>
#include <vector>

#include "hyselam_language/reader/fact_reader.hpp"
#include "linear_classifier.hpp"

namespace hyselam_topo {
namespace language {

/// The parts of a label: relation and arguments.
std::vector<std::string> labelParts(const std::string& label);

/// What a classifier says of a candidate that states nothing.
inline const std::string kNoFact = "none";

/// Refuses a classifier whose classes are not kNoFact and labels with so many names. Throws
/// hyselam::InputError with the source.
void checkLabels(const std::string& source, const LinearClassifier& classifier, int names);

/// Whether the arguments of a relation are in no order: "A next to B" is "B next to A".
bool isSymmetric(const std::string& relation);

/// The fact of a label with the mentions put in, in their order.
ReadFact factOf(const std::string& label, const std::vector<FactArgument>& mentions);

}  // namespace language
}  // namespace hyselam_topo
