// Text into sentences, sentences into words, numbers, quotations and punctuation.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "hyselam_language/grammar/utterance.hpp"

namespace hyselam_topo {
namespace language {

enum class TokenKind {
  kWord,
  kNumber,
  kQuoted,  ///< what stands between quotation marks
  kComma,   ///< , : ( ) and dashes between spaces
  kMark     ///< any other sign
};

struct Token {
  TokenKind kind = TokenKind::kWord;
  TextRange range;     ///< in the whole text; of quotations with the marks
  std::string text;    ///< as written, of quotations without the marks
  std::string lower;   ///< in lower case
  std::string folded;  ///< and without accents
  double number = 0.0;
  bool starts_upper = false;
  bool has_accents = false;         ///< letters are not all a .. z
  bool only_lower_letters = false;  ///< plain small letters: may be a misspelt keyword
};

inline bool isComma(const Token& token) {
  return token.kind == TokenKind::kComma;
}

/// What the splitting must know of a language.
struct TokenRules {
  /// Whether a word may stand right behind a number: "6m".
  std::function<bool(const std::string& folded)> is_unit;
  /// Whether a full stop behind this word (lower case) does not end the sentence.
  std::function<bool(const std::string& lower)> is_abbreviation;
  /// Whether a sentence may begin with this word, though no space stands before it.
  std::function<bool(const std::string& folded)> may_begin;
  /// What a word stands for: "you're" gives "you are"; nothing for most.
  std::function<const std::vector<std::string>*(const std::string& lower)> expansion;
};

struct Sentence {
  TextRange range;           ///< without spaces around, with the full stop
  bool is_question = false;  ///< ends with a question mark
};

/// Sentences end at . ! ? ; and at empty lines, but not within quotations, numbers and names such
/// as "1.5", "B.12".
std::vector<Sentence> splitSentences(const std::string& text, const TokenRules& rules);

std::vector<Token> tokenize(const std::string& text, TextRange range, const TokenRules& rules);

/// A token of a word on its own, e.g. of one that a contraction stands for.
Token wordToken(const std::string& text, TextRange range);

}  // namespace language
}  // namespace hyselam_topo
