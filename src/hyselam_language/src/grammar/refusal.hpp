// Why a sentence was not understood, for the person who said it.
#pragma once

#include <cstddef>
#include <string>

#include "hyselam_language/grammar/utterance.hpp"
#include "sentence_words.hpp"

namespace hyselam_topo {
namespace language {

/// The sentence with the reason of a code, into which `word` is put.
Utterance refusal(const SentenceWords& words, const std::string& code, TextRange culprit,
                  const std::string& word);
Utterance refusal(const SentenceWords& words, const std::string& code, TextRange culprit);

/// The most telling reason that no reading of the sentence was found; `furthest`: the last token
/// that a pattern has come to.
Utterance whyNot(const SentenceWords& words, std::size_t furthest);

}  // namespace language
}  // namespace hyselam_topo
