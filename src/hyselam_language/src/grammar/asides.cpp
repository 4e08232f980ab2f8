#include "asides.hpp"

#include <algorithm>

namespace hyselam_topo {
namespace language {
namespace {

/// Whether the token may carry what people mean to tell.
bool mayTell(const Token& token, bool is_first, const CompiledGrammar& grammar) {
  if (token.kind != TokenKind::kWord) return true;
  if (token.starts_upper && !is_first && token.text.size() > 1) return true;
  if (grammar.telling_words.count(token.folded) != 0) return true;
  if (grammar.refusing_words.count(token.folded) != 0) return true;
  // "um" is a number and an article.
  const bool article = std::any_of(grammar.name_types.begin(), grammar.name_types.end(),
                                   [&](const auto& type) { return type.isArticle(token.folded); });
  if (!article && grammar.number_words.count(token.folded) != 0) return true;
  return grammar.isNounOrTitle(token.folded) ||
         std::any_of(grammar.name_types.begin(), grammar.name_types.end(),
                     [&](const auto& type) { return type.plurals.count(token.folded) != 0; });
}

/// "Which used to be a bedroom", without doubt or denial.
bool isOfThePast(const std::vector<Token>& tokens, std::size_t begin, std::size_t end,
                 const CompiledGrammar& grammar) {
  const bool past =
      std::any_of(grammar.past_asides.begin(), grammar.past_asides.end(), [&](const Words& phrase) {
        return begin + phrase.size() <= end && standsAt(phrase, tokens, begin);
      });
  return past &&
         std::none_of(tokens.begin() + static_cast<std::ptrdiff_t>(begin),
                      tokens.begin() + static_cast<std::ptrdiff_t>(end), [&](const Token& token) {
                        const auto code = grammar.refusing_words.find(token.folded);
                        return code != grammar.refusing_words.end() && code->second != "not_now";
                      });
}

/// "If you do not mind": nothing but a phrase that the grammar leaves out beside a statement.
bool isFiller(const std::vector<Token>& tokens, std::size_t begin, std::size_t end,
              const CompiledGrammar& grammar) {
  const auto is = [&](const Phrase& phrase) {
    if (phrase.size() != end - begin) return false;
    for (std::size_t i = 0; i < phrase.size(); ++i) {
      if (tokens[begin + i].lower != grammar.vocabulary.text(phrase[i])) return false;
    }
    return true;
  };
  // A single word may stand for a name.
  return end > begin + 1 &&
         (std::any_of(grammar.fillers_before.begin(), grammar.fillers_before.end(), is) ||
          std::any_of(grammar.fillers_after.begin(), grammar.fillers_after.end(), is));
}

}  // namespace

std::vector<Aside> asidesOf(const std::vector<Token>& tokens, const CompiledGrammar& grammar,
                            bool all) {
  std::vector<Aside> asides;
  std::size_t parts = 0;
  for (std::size_t begin = 0; begin < tokens.size();) {
    if (isComma(tokens[begin])) {
      ++begin;
      continue;
    }
    std::size_t end = begin;
    bool tells = false;
    for (; end < tokens.size() && !isComma(tokens[end]); ++end) {
      tells = tells || mayTell(tokens[end], end == 0, grammar);
    }
    ++parts;
    if (tells) {
      tells = !isOfThePast(tokens, begin, end, grammar) && !isFiller(tokens, begin, end, grammar);
    }
    if (!tells) asides.push_back({begin, end});
    begin = end;
  }
  if (asides.size() == parts && !all) asides.clear();
  return asides;
}

std::vector<Token> without(const std::vector<Token>& tokens, const std::vector<Aside>& asides) {
  std::vector<Token> left;
  for (std::size_t i = 0; i < tokens.size(); ++i) {
    const bool dropped = std::any_of(asides.begin(), asides.end(), [i](const Aside& aside) {
      return aside.begin <= i && i < aside.end;
    });
    if (dropped) continue;
    // No comma at the borders, and one is enough.
    if (isComma(tokens[i]) && (left.empty() || isComma(left.back()))) continue;
    left.push_back(tokens[i]);
  }
  while (!left.empty() && isComma(left.back())) left.pop_back();
  return left;
}

}  // namespace language
}  // namespace hyselam_topo
