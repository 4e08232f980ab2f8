// What is said about a sentence that was not understood: what the person might have meant, or how
// such things are said.
#pragma once

#include <vector>

#include "hyselam_language/grammar/utterance.hpp"
#include "sentence_reader.hpp"
#include "sentence_words.hpp"

namespace hyselam_topo {
namespace language {

/// Gives the refused sentence a suggestion. `beginnings`: of its tokens, the longest first.
void propose(const SentenceWords& words, const std::vector<Beginning>& beginnings,
             Utterance* refused);

}  // namespace language
}  // namespace hyselam_topo
