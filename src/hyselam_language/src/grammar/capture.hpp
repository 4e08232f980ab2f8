// What a fitting pattern has captured: its way through the sentence turned into slots with values.
#pragma once

#include <vector>

#include "clause.hpp"
#include "pattern_run.hpp"

namespace hyselam_topo {
namespace language {

/// Puts slots and misspelt keywords into the clause. False if a unit is needed and missing, or if a
/// slot gets two values ("on the left, on the right").
bool capture(const Automaton& pattern, const std::vector<PatternRun::Step>& path,
             SentenceWords* words, Clause* clause);

}  // namespace language
}  // namespace hyselam_topo
