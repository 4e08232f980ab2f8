// From what the grammar captured to statements on objects.
#pragma once

#include <string>
#include <vector>

#include "object_words.hpp"

namespace hyselam_objects {

/// One statement for each relation of the utterance, the landmarks of landmarks first. `grammar`
/// tells the reasons of refusals.
std::vector<ObjectStatement> statementsOf(const ObjectWords& words,
                                          const hyselam_topo::Grammar& grammar,
                                          const hyselam_topo::Utterance& utterance,
                                          const std::string& text);

}  // namespace hyselam_objects
