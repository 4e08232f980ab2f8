#include "asides.hpp"

#include <algorithm>

namespace hyselam_topo {
namespace language {
namespace {

/// Whether the token may carry what people mean to tell.
bool mayTell(const std::vector<Token>& tokens, std::size_t at, const CompiledGrammar& grammar) {
  const Token& token = tokens[at];
  const bool is_first = at == 0;
  if (isReflexive(tokens, at, grammar)) return false;
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

/// Whether a phrase of several stands at a token, word by word.
bool standsAt(const Phrase& phrase, const std::vector<Token>& tokens, std::size_t at,
              const CompiledGrammar& grammar) {
  if (at + phrase.size() > tokens.size()) return false;
  for (std::size_t i = 0; i < phrase.size(); ++i) {
    if (tokens[at + i].lower != grammar.vocabulary.text(phrase[i])) return false;
  }
  return true;
}

/// Behind "and", "but".
std::size_t behindSeparator(const std::vector<Token>& tokens, std::size_t begin, std::size_t end,
                            const CompiledGrammar& grammar) {
  const bool separated =
      std::any_of(grammar.clause_separators.begin(), grammar.clause_separators.end(),
                  [&](const Phrase& phrase) {
                    return phrase.size() == 1 && standsAt(phrase, tokens, begin, grammar);
                  });
  return separated && begin + 1 < end ? begin + 1 : begin;
}

/// Whether tokens [begin, end) are words of correction and nothing else.
bool corrects(const std::vector<Token>& tokens, std::size_t begin, std::size_t end,
              const CompiledGrammar& grammar) {
  return std::any_of(grammar.corrections.begin(), grammar.corrections.end(),
                     [&](const Phrase& phrase) {
                       const std::size_t next = begin + phrase.size();
                       return next <= end && standsAt(phrase, tokens, begin, grammar) &&
                              (next == end || corrects(tokens, next, end, grammar));
                     });
}

/// Whether a part behind "no" may be the reason of the correction.
bool mayBeReason(const Aside& part, const std::vector<Token>& tokens,
                 const CompiledGrammar& grammar) {
  const NameType* places = grammar.nameType("place");
  for (std::size_t at = part.begin; at < part.end; ++at) {
    const Token& token = tokens[at];
    if (token.kind != TokenKind::kWord || grammar.isNounOrTitle(token.folded)) return false;
    const auto code = grammar.refusing_words.find(token.folded);
    const bool told = code == grammar.refusing_words.end() || code->second == "denial" ||
                      code->second == "not_now" || code->second == "past";
    if (!told) return false;
    const bool elliptic = places != nullptr && places->elliptic_nouns.count(token.folded) != 0;
    const bool article = places != nullptr && places->isArticle(token.folded);
    if (grammar.number_words.count(token.folded) != 0 && !elliptic && !article) return false;
    if (!token.starts_upper || token.text.size() == 1 || at == part.begin) continue;
    if (places == nullptr) return false;
    const auto known = places->forbidden.find(token.folded);
    const bool day = known != places->forbidden.end() && known->second == "not_a_place";
    if (!day) return false;
  }
  return true;
}

}  // namespace

bool denies(const std::vector<Token>& tokens, std::size_t begin, std::size_t end,
            const CompiledGrammar& grammar) {
  return std::any_of(tokens.begin() + static_cast<std::ptrdiff_t>(begin),
                     tokens.begin() + static_cast<std::ptrdiff_t>(end), [&](const Token& token) {
                       const auto code = grammar.refusing_words.find(token.folded);
                       return code != grammar.refusing_words.end() && code->second == "denial";
                     });
}

bool doubts(const std::vector<Token>& tokens, std::size_t begin, std::size_t end,
            const CompiledGrammar& grammar) {
  if (!denies(tokens, begin, end, grammar)) return false;
  for (std::size_t at = begin; at < end; ++at) {
    const bool asks = at + 1 < end && grammar.asking_words.count(tokens[at + 1].folded) != 0;
    if (!asks && grammar.doubt_words.count(tokens[at].folded) != 0) return true;
  }
  return false;
}

bool saysNothingOfNow(const std::vector<Token>& tokens, std::size_t part, std::size_t end,
                      const CompiledGrammar& grammar, bool with_nouns) {
  const std::size_t begin = behindSeparator(tokens, part, end, grammar);
  const bool past = grammar.past_asides.standAt(tokens, begin, end);
  const bool idle = !past && grammar.idle_asides.standAt(tokens, begin, end);
  if ((!past && !idle) || doubts(tokens, begin, end, grammar)) return false;
  return std::none_of(tokens.begin() + static_cast<std::ptrdiff_t>(begin),
                      tokens.begin() + static_cast<std::ptrdiff_t>(end), [&](const Token& token) {
                        const auto at = static_cast<std::size_t>(&token - tokens.data());
                        if (isReflexive(tokens, at, grammar)) return false;
                        if (idle && !with_nouns && grammar.isNounOrTitle(token.folded)) return true;
                        const auto code = grammar.refusing_words.find(token.folded);
                        if (code == grammar.refusing_words.end()) return false;
                        return code->second != "not_now" && code->second != "past" &&
                               !(idle && code->second == "denial");
                      });
}

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
      tells = tells || mayTell(tokens, end, grammar);
    }
    ++parts;
    if (tells) {
      tells = !saysNothingOfNow(tokens, begin, end, grammar, false) &&
              fillerEnd(tokens, begin, grammar) != end;
    }
    if (!tells) asides.push_back({begin, end});
    begin = end;
  }
  if (asides.size() == parts && !all) asides.clear();
  return asides;
}

bool isReflexive(const std::vector<Token>& tokens, std::size_t at, const CompiledGrammar& grammar) {
  if (at == 0 || at + 1 >= tokens.size() || grammar.reflexive.count(tokens[at].folded) == 0) {
    return false;
  }
  // "For", "fores", "virem" belong to conditions, "guarda", "vê", "encontram" do not.
  const std::string& verb = tokens[at + 1].folded;
  const auto endsWith = [&](const std::string& end) {
    return verb.size() > end.size() && verb.compare(verb.size() - end.size(), end.size(), end) == 0;
  };
  const bool told = endsWith("a") || endsWith("e") || endsWith("am") || endsWith("em");
  return grammar.reflexive_after.count(tokens[at - 1].folded) != 0 && told && !endsWith("rem");
}

std::size_t fillerEnd(const std::vector<Token>& tokens, std::size_t at,
                      const CompiledGrammar& grammar) {
  std::size_t end = at;
  const auto with = grammar.long_fillers.find(at < tokens.size() ? tokens[at].lower : "");
  if (with == grammar.long_fillers.end()) return end;
  for (const Phrase& phrase : with->second) {
    if (at + phrase.size() <= end) continue;
    if (standsAt(phrase, tokens, at, grammar)) end = at + phrase.size();
  }
  return end;
}

std::vector<std::vector<Aside>> asidesOfCorrections(const std::vector<Token>& tokens,
                                                    const CompiledGrammar& grammar) {
  std::vector<Aside> parts;
  for (std::size_t at = 0; at < tokens.size(); ++at) {
    if (isComma(tokens[at])) continue;
    if (at == 0 || isComma(tokens[at - 1])) parts.push_back({at, at});
    parts.back().end = at + 1;
  }
  std::vector<std::vector<Aside>> all;
  for (std::size_t i = 0; i + 2 < parts.size(); ++i) {
    if (!corrects(tokens, parts[i].begin, parts[i].end, grammar)) continue;
    std::vector<Aside> dropped;
    for (std::size_t k = i + 1; k + 1 < parts.size(); ++k) {
      const bool again = corrects(tokens, parts[k].begin, parts[k].end, grammar);
      if (!again && !mayBeReason(parts[k], tokens, grammar)) break;
      dropped.push_back(parts[k]);
      if (!again) all.push_back(dropped);
    }
    break;
  }
  return all;
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
