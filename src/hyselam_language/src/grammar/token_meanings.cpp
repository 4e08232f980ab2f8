#include "token_meanings.hpp"

#include <algorithm>
#include <set>
#include <utility>

namespace hyselam_topo {
namespace language {
namespace {

bool hasSmallLetter(const Token& token) {
  return token.kind == TokenKind::kWord && std::any_of(token.text.begin(), token.text.end(),
                                                       [](char c) { return c >= 'a' && c <= 'z'; });
}

void markAcronyms(const CompiledGrammar& grammar, std::vector<Token>* tokens) {
  // In a sentence of capitals, they tell nothing.
  if (std::none_of(tokens->begin(), tokens->end(), hasSmallLetter)) return;
  for (Token& token : *tokens) {
    if (token.kind != TokenKind::kWord || grammar.acronyms.count(token.text) == 0) continue;
    token.lower += ".";
    token.folded += ".";
  }
}

/// Whether what stands before "'s" may be what something is said of: "the library's", "the last
/// one's", "on the left's".
bool mayBeSubject(const Token& noun, const CompiledGrammar& grammar) {
  if (grammar.isNoun(noun.folded)) return true;
  const NameType* type = grammar.nameType("place");
  return type != nullptr &&
         (type->generic.count(noun.folded) != 0 || type->stop.count(noun.lower) != 0);
}

/// Whether a name of a place may go on with this token.
bool mayGoOn(const std::vector<Token>& tokens, std::size_t at, const CompiledGrammar& grammar) {
  if (at >= tokens.size() || tokens[at].kind == TokenKind::kComma) return true;
  const Token& token = tokens[at];
  if (token.kind != TokenKind::kWord) return token.kind == TokenKind::kQuoted;
  const NameType* type = grammar.nameType("place");
  if (type == nullptr) return true;
  const auto stops = [&](const Token& each) {
    return type->stop.count(each.lower) != 0 || type->isArticle(each.folded);
  };
  if (stops(token) || grammar.number_words.count(token.folded) != 0) return false;
  // "The library's huge", but "the library's main entrance".
  const bool last =
      at + 1 == tokens.size() || tokens[at + 1].kind == TokenKind::kComma || stops(tokens[at + 1]);
  return type->generic.count(token.folded) == 0 || grammar.isNoun(token.folded) || !last;
}

/// "The gizmo's on the shelf": any word is a noun there, where no owner's name stands for a place
/// ("the dentist's").
bool isBehindArticle(const std::vector<Token>& tokens, std::size_t at,
                     const CompiledGrammar& grammar) {
  const NameType* type = grammar.nameType("place");
  if (type == nullptr || !type->elliptic_suffix.empty()) return false;
  for (std::size_t k = at; k-- > 0 && tokens[k].kind == TokenKind::kWord;) {
    if (type->isArticle(tokens[k].folded) || type->speaker.count(tokens[k].folded) != 0) {
      return true;
    }
    if (type->stop.count(tokens[k].lower) != 0) return false;
  }
  return false;
}

/// "The dungeon's next to the lift": where no verb follows, it is in "'s". Not in "the women's on
/// the right", of several, nor behind a proper name ("Maureen's next to the lift").
bool isOnlyVerb(const std::vector<Token>& tokens, std::size_t at, const CompiledGrammar& grammar) {
  static const std::set<std::string> kSeveral{"men", "women", "children", "people"};
  static const std::set<std::string> kVerbs{"is", "are", "has", "have", "was", "were", "belongs"};
  const NameType* type = grammar.nameType("place");
  const std::string& word = tokens[at].text;
  if (type == nullptr || type->elliptic_suffix.empty() || at + 1 == tokens.size()) return false;
  const bool small = std::all_of(word.begin(), word.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || c == '\'' || static_cast<unsigned char>(c) >= 0x80;
  });
  if (!small || kSeveral.count(word.substr(0, word.find_first_of("'\xe2"))) != 0) return false;
  const auto endsClause = [&](const Token& token) {
    return token.kind == TokenKind::kComma || token.lower == "and" || token.lower == "but";
  };
  for (std::size_t k = at + 1; k < tokens.size() && !endsClause(tokens[k]); ++k) {
    if (kVerbs.count(tokens[k].lower) != 0) return false;
  }
  for (std::size_t k = at; k-- > 0 && !endsClause(tokens[k]);) {
    if (kVerbs.count(tokens[k].lower) != 0 || type->stop.count(tokens[k].lower) != 0) return false;
  }
  return tokens[at + 1].kind == TokenKind::kWord;
}

/// "Its the kitchen": "it is", where its next word is never what somebody owns.
std::vector<Token> withApostrophes(const std::vector<Token>& tokens,
                                   const CompiledGrammar& grammar) {
  std::vector<Token> all;
  for (std::size_t at = 0; at < tokens.size(); ++at) {
    const auto loose = grammar.loose_contractions.find(tokens[at].lower);
    const bool is_verb = loose != grammar.loose_contractions.end() && at + 1 < tokens.size() &&
                         tokens[at].kind == TokenKind::kWord &&
                         grammar.loose_before.standAt(tokens, at + 1, tokens.size());
    if (!is_verb) {
      all.push_back(tokens[at]);
      continue;
    }
    for (const std::string& word : loose->second) {
      all.push_back(wordToken(word, tokens[at].range));
    }
  }
  return all;
}

/// "The last but one": "penultimate".
std::vector<Token> withSameWords(const std::vector<Token>& tokens, const CompiledGrammar& grammar) {
  std::vector<Token> all;
  for (std::size_t at = 0; at < tokens.size();) {
    const auto found =
        std::find_if(grammar.same_words.begin(), grammar.same_words.end(),
                     [&](const auto& each) { return standsAt(each.first, tokens, at); });
    if (found == grammar.same_words.end()) {
      all.push_back(tokens[at++]);
      continue;
    }
    const std::size_t last = at + found->first.size() - 1;
    for (const std::string& word : found->second) {
      all.push_back(wordToken(word, {tokens[at].range.begin, tokens[last].range.end}));
    }
    at = last + 1;
  }
  return all;
}

}  // namespace

std::vector<Token> withMeanings(std::vector<Token> tokens, const CompiledGrammar& grammar) {
  markAcronyms(grammar, &tokens);
  if (!grammar.loose_contractions.empty()) tokens = withApostrophes(tokens, grammar);
  if (!grammar.same_words.empty()) tokens = withSameWords(tokens, grammar);
  std::vector<Token> all;
  for (std::size_t at = 0; at < tokens.size(); ++at) {
    const Token& token = tokens[at];
    all.push_back(token);
    if (token.kind != TokenKind::kWord || at + 1 == tokens.size()) continue;
    for (const auto& [end, verb] : grammar.contracted_verbs) {
      if (token.lower.size() <= end.size() || token.lower.size() != token.text.size()) continue;
      const std::size_t length = token.lower.size() - end.size();
      if (token.lower.compare(length, end.size(), end) != 0) continue;
      Token noun =
          wordToken(token.text.substr(0, length), {token.range.begin, token.range.begin + length});
      const bool is_subject = mayBeSubject(noun, grammar) || isBehindArticle(tokens, at, grammar) ||
                              isOnlyVerb(tokens, at, grammar);
      // "The kitchen's got two doors."
      const bool has_got = tokens[at + 1].lower == "got" && grammar.isNoun(noun.folded);
      if (!has_got && (!is_subject || mayGoOn(tokens, at + 1, grammar))) continue;
      all.back() = std::move(noun);
      all.push_back(wordToken(verb, {token.range.begin + length, token.range.end}));
      break;
    }
  }
  return all;
}

}  // namespace language
}  // namespace hyselam_topo
