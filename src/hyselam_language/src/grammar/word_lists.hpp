// Lists of words and phrases in grammar files.
#pragma once

#include <string>
#include <vector>

#include "compiled_grammar.hpp"
#include "grammar_node.hpp"

namespace hyselam_topo {
namespace language {

Words splitWords(const std::string& text);

/// "go (on|off) [now]" is "go on", "go off", "go on now" and "go off now". Nothing for brackets
/// that are not closed, and for more than 10,000 phrases.
std::vector<std::string> expanded(const std::string& text);
/// The same for the text of a node, which fails where there is nothing.
std::vector<std::string> expanded(const GrammarNode& node, const std::string& text);

Phrase phraseOf(const std::string& text, Vocabulary* vocabulary);

/// Adds the phrases of a list, expanded, of which none may be empty.
void addPhrases(const GrammarNode& node, Vocabulary* vocabulary, std::vector<Phrase>* phrases);

/// Adds the words of a list without their accents.
void addFolded(const GrammarNode& node, WordSet* words);

/// Of lists of words by their meaning: folded word -> meaning.
void addMeanings(const GrammarNode& node, WordMeanings* meanings);

}  // namespace language
}  // namespace hyselam_topo
