// "Here on your left", "this door on your left": what is pointed at from where somebody stands.
#pragma once

#include "clause.hpp"
#include "sentence_words.hpp"

namespace hyselam_topo {
namespace language {

/// Whether the side that a clause tells is told of what is right here. `from`: where the clause
/// before it ended.
bool isToldHere(const Clause& clause, std::size_t from, const SentenceWords& words);

}  // namespace language
}  // namespace hyselam_topo
