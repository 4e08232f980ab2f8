// The nearest sentence that is understood: what was said less words that no pattern has a place
// for. It is only ever proposed, never taken down: the words left out may have mattered.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "compiled_grammar.hpp"
#include "sentence_words.hpp"

namespace hyselam_topo {
namespace language {

struct ShorterSentence {
  std::string text;
  std::vector<std::string> names;  ///< in it, in their order
  TextRange left_out;              ///< the longest run of words left out
};

/// Nothing if too much would have to be left out.
std::optional<ShorterSentence> shorterSentence(const SentenceWords& words);

}  // namespace language
}  // namespace hyselam_topo
