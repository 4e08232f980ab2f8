// A sentence as the matcher sees it: its tokens, and what each of them may stand for.
#pragma once

#include <string>
#include <vector>

#include "compiled_grammar.hpp"
#include "measures.hpp"
#include "name_finder.hpp"

namespace hyselam_topo {
namespace language {

/// All that is given must outlive this.
class SentenceWords {
 public:
  SentenceWords(const CompiledGrammar& grammar, const std::string& text, const Sentence& sentence);
  /// Of some of the sentence's tokens.
  SentenceWords(const CompiledGrammar& grammar, const std::string& text, const Sentence& sentence,
                std::vector<Token> tokens);
  SentenceWords(const SentenceWords&) = delete;  // `names` refers to the tokens
  SentenceWords& operator=(const SentenceWords&) = delete;

  /// Such a sentence is not read: `matches` is empty.
  bool isTooLong() const;
  bool isComma(std::size_t at) const { return tokens[at].kind == TokenKind::kComma; }
  std::string textOf(TextRange range) const;

  /// Names of a type that begin at token `at`, the shortest first; keeps why others are none.
  const std::vector<FoundName>& namesAt(std::size_t at, int type) {
    return names.namesAt(at, static_cast<std::size_t>(type));
  }
  std::vector<FoundNumber> numbersAt(std::size_t at) const;
  std::vector<FoundMeasure> measuresAt(std::size_t at, int quantity) const;

  const CompiledGrammar& grammar;
  const std::string& text;
  const Sentence& sentence;
  const std::vector<Token> tokens;
  TokenMatches matches;
  NameFinder names;
};

}  // namespace language
}  // namespace hyselam_topo
