// A whole text as the reader sees it: the words of all its sentences in a row.
#pragma once

#include <string>
#include <vector>

#include "grammar/compiled_grammar.hpp"
#include "grammar/tokens.hpp"
#include "reader_lexicon.hpp"

namespace hyselam_topo {
namespace language {

/// Tokens [begin, end) of a text: something that is named ("the red mug", "room 5"), a person, or
/// a value ("twenty metres", "second").
struct Mention {
  enum class Kind { kThing, kPerson, kValue };
  std::size_t begin = 0;
  std::size_t end = 0;
  Kind kind = Kind::kThing;
  double probability = 1.0;
};

class HeardText {
 public:
  /// The grammar splits the text into words.
  HeardText(const CompiledGrammar& grammar, const ReaderLexicon& lexicon, const std::string& text);

  const std::string& text() const { return text_; }
  /// Of all sentences; each sentence ends with a mark of its own: "." or "?".
  const std::vector<Token>& tokens() const { return tokens_; }
  /// The folded word, or what stands for a number, for quotations, for the outside of the text.
  const std::string& word(std::ptrdiff_t at) const;
  bool isNoun(std::ptrdiff_t at) const;
  bool isKeyword(std::ptrdiff_t at) const;
  bool endsSentence(std::size_t at) const { return ends_[at]; }
  TextRange rangeOf(const Mention& mention) const;
  std::string textOf(const Mention& mention) const;
  /// As it stands within a sentence: "kitchen" where one begins with "Kitchen".
  std::string nameOf(const Mention& mention) const;

 private:
  void add(const ReaderLexicon& lexicon, Token token, std::string word, bool ends);

  std::string text_;
  std::vector<Token> tokens_;
  std::vector<std::string> words_;
  std::vector<bool> nouns_, keywords_, ends_;
};

}  // namespace language
}  // namespace hyselam_topo
