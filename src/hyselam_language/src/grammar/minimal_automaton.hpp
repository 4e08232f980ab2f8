// The smallest deterministic automaton that reads the same: what two alternatives have in common at
// their beginnings and ends is read once.
#pragma once

#include "automaton.hpp"

namespace hyselam_topo {
namespace language {

/// Of each state at most one edge has the same kind and values; edges for words come first, sorted
/// by word. The only edges that say nothing lead to the accepting state. An automaton that would
/// grow beyond `max_states` is returned as it is, with its edges sorted.
Automaton minimal(const Automaton& automaton, std::size_t max_states);

}  // namespace language
}  // namespace hyselam_topo
