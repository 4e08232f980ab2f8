// What the second reader makes of the parts of a text that the grammar has refused: sentences that
// the grammar understands, as suggestions to ask for, and talk beside the matter.
#pragma once

#include <string>
#include <vector>

#include "hyselam_language/grammar/grammar.hpp"
#include "hyselam_language/grammar/utterance.hpp"
#include "hyselam_language/reader/fact_reader.hpp"

namespace hyselam_topo {

/// Fills `suggestion` of refused utterances in which facts are found, and `alternatives`, unless
/// what was said is doubted, a choice or under a condition: to ask for where they are likely
/// enough, else as an example of how it is said. Refused parts that state nothing and name nothing,
/// beside statements that were understood, become words left out of these.
void readAgain(const FactReader& reader, const Grammar& grammar, const std::string& text,
               std::vector<Utterance>* utterances);

}  // namespace hyselam_topo
