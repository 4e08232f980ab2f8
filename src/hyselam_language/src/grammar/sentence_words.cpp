#include "sentence_words.hpp"

#include <algorithm>
#include <utility>

#include "matching_costs.hpp"

namespace hyselam_topo {
namespace language {

SentenceWords::SentenceWords(const CompiledGrammar& grammar_of, const std::string& text_of,
                             const Sentence& sentence_of)
    : SentenceWords(grammar_of, text_of, sentence_of,
                    tokenize(text_of, sentence_of.range, grammar_of.tokenRules())) {}

SentenceWords::SentenceWords(const CompiledGrammar& grammar_of, const std::string& text_of,
                             const Sentence& sentence_of, std::vector<Token> tokens_of)
    : grammar(grammar_of),
      text(text_of),
      sentence(sentence_of),
      tokens(std::move(tokens_of)),
      names(grammar, text, tokens) {
  if (isTooLong()) return;
  const bool accents = std::any_of(tokens.begin(), tokens.end(),
                                   [](const Token& token) { return token.has_accents; });
  for (const Token& token : tokens) {
    const bool known = grammar.known_words.count(token.folded) != 0;
    const bool letters = std::all_of(token.folded.begin(), token.folded.end(),
                                     [](char c) { return (c >= 'a' && c <= 'z') || c == '\''; });
    matches.push_back(grammar.vocabulary.matches(token, !known && letters));
    if (!accents || token.has_accents) continue;
    // Who writes accents means "e", not "é".
    auto& found = matches.back();
    const bool separates = std::any_of(found.begin(), found.end(), [&](const auto& match) {
      const auto& all = grammar.clause_separators;
      return match.cost == 0 && std::find(all.begin(), all.end(), Phrase{match.word}) != all.end();
    });
    if (!separates) continue;
    found.erase(std::remove_if(found.begin(), found.end(),
                               [](const auto& match) { return match.cost > 0; }),
                found.end());
  }
}

bool SentenceWords::isTooLong() const {
  return tokens.size() > kMaxTokens;
}

std::string SentenceWords::textOf(TextRange range) const {
  return text.substr(range.begin, range.end - range.begin);
}

std::vector<FoundNumber> SentenceWords::numbersAt(std::size_t at) const {
  return language::numbersAt(at, grammar, tokens);
}

std::vector<FoundMeasure> SentenceWords::measuresAt(std::size_t at, int quantity) const {
  return language::measuresAt(at, grammar.quantities[static_cast<std::size_t>(quantity)], grammar,
                              tokens, matches);
}

}  // namespace language
}  // namespace hyselam_topo
